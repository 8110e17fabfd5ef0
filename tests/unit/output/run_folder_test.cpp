// SPDX-License-Identifier: Apache-2.0
#include "output/run_folder.hpp"

#include "output/file.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

RunRecord make_record() {
    RunRecord r;
    r.program = "noli 0.1.0";
    r.fingerprint = 0xfedcba9876543210ull;
    r.scene_name = "drop \"1\"";
    r.status = "interrupted";
    r.outcome = "Converged";
    r.steps_done = 12;
    r.steps_asked = 100;
    r.state_hash = 0x0123456789abcdefull;
    r.dt = 0.1;
    r.dhat = 1e-3;
    r.bodies = {"a", "b"};
    return r;
}

TEST(RunRecord, ReadsBackWhatWasWritten) {
    const RunRecord original = make_record();
    const Result<RunRecord> read =
        decode_run_record(encode_run_record(original), "run.json");
    ASSERT_TRUE(read);
    EXPECT_EQ(read.value().fingerprint, original.fingerprint);
    EXPECT_EQ(read.value().state_hash, original.state_hash);
    RunRecord unknown = original;
    unknown.state_hash.reset();
    const Result<RunRecord> again =
        decode_run_record(encode_run_record(unknown), "run.json");
    ASSERT_TRUE(again);
    EXPECT_FALSE(again.value().state_hash.has_value());
    EXPECT_EQ(read.value().scene_name, original.scene_name);
    EXPECT_EQ(read.value().status, original.status);
    EXPECT_EQ(read.value().steps_done, 12);
    EXPECT_EQ(read.value().dt, 0.1);
    EXPECT_EQ(read.value().bodies, original.bodies);
}

TEST(RunRecord, RefusesOtherDocumentsAndOtherFormats) {
    RunRecord newer = make_record();
    newer.format = kRunFormat + 1;
    for (const std::string& text : {std::string("{"),
                                    std::string("{}"),
                                    std::string("[1]"),
                                    std::string("{\"kind\": \"noli run\"}"),
                                    encode_run_record(newer)}) {
        const Result<RunRecord> read = decode_run_record(text, "run.json");
        ASSERT_FALSE(read) << text;
        EXPECT_EQ(read.error().code, Error::Code::RunDirectory);
        EXPECT_EQ(read.error().where, "run.json");
    }
}

TEST(InspectFolder, TellsRunsFromEmptyAndForeignFolders) {
    const ScratchFolder scratch;
    EXPECT_EQ(inspect_folder(scratch / "none"), FolderState::Missing);
    EXPECT_EQ(inspect_folder(scratch.path()), FolderState::Empty);
    ASSERT_TRUE(write_file(scratch / "run.json.part", "half"));
    EXPECT_EQ(inspect_folder(scratch.path()), FolderState::Empty);
    ASSERT_TRUE(write_file(scratch / "thesis.tex", "x"));
    EXPECT_EQ(inspect_folder(scratch.path()), FolderState::Foreign);
    EXPECT_EQ(inspect_folder(scratch / "thesis.tex"), FolderState::Foreign);
    ASSERT_TRUE(write_file(scratch / "run.json", "x"));
    EXPECT_EQ(inspect_folder(scratch.path()), FolderState::Run);
}

TEST(ClearRunFolder, RemovesOnlyWhatARunWrites) {
    const ScratchFolder scratch;
    const RunPaths paths(scratch.path());
    for (const std::string& folder :
         {paths.frames, paths.checkpoints, scratch / "repro_step_000001"}) {
        ASSERT_TRUE(make_folder(folder));
        ASSERT_TRUE(write_file(folder + "/x", "x"));
    }
    for (const std::string& file :
         {paths.record, paths.scene, paths.log, paths.stats, scratch / "notes.txt"})
        ASSERT_TRUE(write_file(file, "x"));
    ASSERT_TRUE(clear_run_folder(scratch.path()));
    EXPECT_EQ(list_folder(scratch.path()), std::vector<std::string>{"notes.txt"});
}

TEST(RemoveFramesAfter, KeepsEarlierFramesAndForeignFiles) {
    const ScratchFolder scratch;
    for (const char* name :
         {"frame_000000.vtu", "frame_000010.obj", "frame_000011.vtu", "a.txt"})
        ASSERT_TRUE(write_file(scratch / name, "x"));
    remove_frames_after(scratch.path(), 10);
    const std::vector<std::string> expected{
        "a.txt", "frame_000000.vtu", "frame_000010.obj"};
    EXPECT_EQ(list_folder(scratch.path()), expected);
}

}  // namespace
}  // namespace noli
