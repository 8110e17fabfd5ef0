// SPDX-License-Identifier: Apache-2.0
#include "output/checkpoint.hpp"

#include "output/file.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

namespace noli {
namespace {

constexpr std::uint64_t kScene = 0x1234567890abcdefull;

Checkpoint make_checkpoint(int step, size_t size = 1000) {
    Checkpoint c;
    c.fingerprint = kScene;
    c.state_hash = 77u + static_cast<unsigned>(step);
    c.step = step;
    c.time = 0.01 * step;
    std::mt19937 random(static_cast<unsigned>(step));
    for (size_t i = 0; i < size; ++i)
        c.payload.push_back(static_cast<std::byte>(random() & 0xff));
    return c;
}

void expect_equal(const Checkpoint& a, const Checkpoint& b) {
    EXPECT_EQ(a.fingerprint, b.fingerprint);
    EXPECT_EQ(a.state_hash, b.state_hash);
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.payload, b.payload);
}

std::string path_of(const ScratchFolder& scratch, int step) {
    return scratch / checkpoint_file_name(step);
}

TEST(Checkpoint, ReadsBackWhatWasWritten) {
    for (const size_t size : {size_t{0}, size_t{1}, size_t{100000}}) {
        const Checkpoint original = make_checkpoint(12, size);
        const Result<Checkpoint> read =
            decode_checkpoint(encode_checkpoint(original), "here");
        ASSERT_TRUE(read);
        expect_equal(read.value(), original);
    }
}

TEST(Checkpoint, RefusesEveryTruncation) {
    const std::string whole = encode_checkpoint(make_checkpoint(3, 100));
    for (size_t size = 0; size < whole.size(); ++size) {
        const Result<Checkpoint> read = decode_checkpoint(whole.substr(0, size), "here");
        ASSERT_FALSE(read) << size;
        EXPECT_EQ(read.error().code, Error::Code::BadCheckpoint);
    }
    EXPECT_FALSE(decode_checkpoint(whole + "x", "here"));
}

TEST(Checkpoint, RefusesEveryFlippedBit) {
    const std::string whole = encode_checkpoint(make_checkpoint(3, 40));
    for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        EXPECT_FALSE(decode_checkpoint(damaged, "here")) << "bit " << bit;
    }
}

TEST(Checkpoint, KeepsTheNewestThree) {
    const ScratchFolder scratch;
    for (const int step : {5, 10, 15, 20, 1000000000})
        ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(step)));
    const std::vector<std::string> expected{
        "step_000000015.ckpt", "step_000000020.ckpt", "step_1000000000.ckpt"};
    EXPECT_EQ(list_folder(scratch.path()), expected);
}

TEST(Checkpoint, LoadsTheNewest) {
    const ScratchFolder scratch;
    for (const int step : {5, 10, 15})
        ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(step)));
    const FoundCheckpoint found = load_newest_checkpoint(scratch.path(), kScene);
    ASSERT_TRUE(found.found);
    expect_equal(found.checkpoint, make_checkpoint(15));
    EXPECT_EQ(found.path, path_of(scratch, 15));
    EXPECT_TRUE(found.skipped.empty());
}

TEST(Checkpoint, SkipsDamagedOnesAndSaysWhich) {
    const ScratchFolder scratch;
    for (const int step : {5, 10, 15})
        ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(step)));
    std::filesystem::resize_file(path_of(scratch, 15), 500);
    {
        std::fstream file(path_of(scratch, 10),
                          std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(300);
        const int byte = file.get();
        file.seekp(300);
        file.put(static_cast<char>(byte ^ 16));
    }
    const FoundCheckpoint found = load_newest_checkpoint(scratch.path(), kScene);
    ASSERT_TRUE(found.found);
    EXPECT_EQ(found.checkpoint.step, 5);
    ASSERT_EQ(found.skipped.size(), 2u);
    EXPECT_NE(found.skipped[0].find("step_000000015.ckpt: truncated"), std::string::npos);
    EXPECT_NE(found.skipped[1].find("step_000000010.ckpt: damaged"), std::string::npos);
}

TEST(Checkpoint, SkipsOtherScenesAndRenamedFiles) {
    const ScratchFolder scratch;
    ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(5)));
    std::filesystem::rename(path_of(scratch, 5), path_of(scratch, 6));
    Checkpoint other = make_checkpoint(7);
    other.fingerprint = 1;
    ASSERT_TRUE(write_checkpoint(scratch.path(), other));
    const FoundCheckpoint found = load_newest_checkpoint(scratch.path(), kScene);
    EXPECT_FALSE(found.found);
    EXPECT_EQ(found.skipped.size(), 2u);
}

TEST(Checkpoint, IgnoresHalfWrittenAndForeignFiles) {
    const ScratchFolder scratch;
    ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(5)));
    std::ofstream(path_of(scratch, 9) + ".part") << "half";
    std::ofstream(scratch / "step_x.ckpt") << "foreign";
    const FoundCheckpoint found = load_newest_checkpoint(scratch.path(), kScene);
    ASSERT_TRUE(found.found);
    EXPECT_EQ(found.checkpoint.step, 5);
    EXPECT_TRUE(found.skipped.empty());
    EXPECT_FALSE(load_newest_checkpoint(scratch / "none", kScene).found);
}

TEST(Checkpoint, AWriteThatFailsLeavesTheOlderOnes) {
    const ScratchFolder scratch;
    ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(5)));
    std::filesystem::create_symlink("/dev/full", path_of(scratch, 6) + ".part");
    EXPECT_FALSE(write_checkpoint(scratch.path(), make_checkpoint(6)));
    EXPECT_EQ(load_newest_checkpoint(scratch.path(), kScene).checkpoint.step, 5);
}

TEST(Checkpoint, RemovesThoseAfterAStep) {
    const ScratchFolder scratch;
    for (const int step : {5, 10, 15})
        ASSERT_TRUE(write_checkpoint(scratch.path(), make_checkpoint(step)));
    remove_checkpoints_after(scratch.path(), 10);
    EXPECT_EQ(load_newest_checkpoint(scratch.path(), kScene).checkpoint.step, 10);
}

}  // namespace
}  // namespace noli
