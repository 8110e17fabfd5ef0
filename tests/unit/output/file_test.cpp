// SPDX-License-Identifier: Apache-2.0
#include "output/file.hpp"

#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace noli {
namespace {

namespace fs = std::filesystem;

std::string content(const std::string& path) {
    return read_file(path).value();
}

/// Files of at most `bytes` while it lives: what a full disk looks like to a process.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        const struct rlimit limit { bytes, before_.rlim_max };
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    struct rlimit before_ {};
    void (*handler_)(int) = nullptr;
};

/// Runs as an ordinary user while it lives, since root may write anywhere.
class OrdinaryUser {
  public:
    OrdinaryUser() { is_changed_ = ::geteuid() == 0 && ::seteuid(65534) == 0; }
    ~OrdinaryUser() {
        if (is_changed_) static_cast<void>(::seteuid(0));
    }

  private:
    bool is_changed_ = false;
};

TEST(WriteFile, WritesAndReplacesAWholeFile) {
    const ScratchFolder scratch;
    const std::string path = scratch / "a.txt";
    ASSERT_TRUE(write_file(path, "one"));
    EXPECT_EQ(content(path), "one");
    ASSERT_TRUE(write_file(path, std::string(100000, 'x'), Durability::Synced));
    EXPECT_EQ(content(path), std::string(100000, 'x'));
    EXPECT_EQ(list_folder(scratch.path()), std::vector<std::string>{"a.txt"});
}

TEST(WriteFile, KeepsTheOldFileAndNamesTheCauseWhenTheDiskIsFull) {
    const ScratchFolder scratch;
    const std::string path = scratch / "a.txt";
    ASSERT_TRUE(write_file(path, "old"));
    // The temporary file is the full device, which takes nothing.
    fs::create_symlink("/dev/full", path + ".part");
    const Status written = write_file(path, "new");
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Error::Code::FileNotWritable);
    EXPECT_EQ(written.error().where, path);
    EXPECT_NE(written.error().message.find("No space left on device"), std::string::npos);
    EXPECT_NE(written.error().message.find("--resume"), std::string::npos);
    EXPECT_EQ(content(path), "old");
    EXPECT_EQ(list_folder(scratch.path()), std::vector<std::string>{"a.txt"});
}

TEST(WriteFile, KeepsTheOldFileWhenTheWriteStopsHalfWay) {
    const ScratchFolder scratch;
    const std::string path = scratch / "a.txt";
    ASSERT_TRUE(write_file(path, "old"));
    const FileSizeLimit limit(1000);
    const Status written = write_file(path, std::string(5000, 'x'));
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("File too large"), std::string::npos);
    EXPECT_NE(written.error().message.find("ulimit"), std::string::npos);
    EXPECT_EQ(content(path), "old");
    EXPECT_EQ(list_folder(scratch.path()), std::vector<std::string>{"a.txt"});
}

TEST(WriteFile, NamesTheCureInAFolderThatMayNotBeWritten) {
    const ScratchFolder scratch;
    fs::create_directory(scratch / "closed");
    ::chmod(scratch.path().c_str(), 0755);
    ::chmod((scratch / "closed").c_str(), 0555);
    const OrdinaryUser user;
    const Status written = write_file(scratch / "closed/a.txt", "x");
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("Permission denied"), std::string::npos);
    EXPECT_NE(written.error().message.find("-o"), std::string::npos);
}

TEST(WriteFile, ReportsAMissingFolder) {
    const ScratchFolder scratch;
    const Status written = write_file(scratch / "none/a.txt", "x");
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("No such file"), std::string::npos);
}

TEST(ReadFile, ReportsAFileThatIsMissingOrAFolder) {
    const ScratchFolder scratch;
    EXPECT_EQ(read_file(scratch / "none").error().code, Error::Code::FileNotReadable);
    EXPECT_EQ(read_file(scratch.path()).error().code, Error::Code::FileNotReadable);
}

TEST(MakeFolder, CreatesParentsAndRefusesAFileInTheWay) {
    const ScratchFolder scratch;
    EXPECT_TRUE(make_folder(scratch / "a/b/c"));
    EXPECT_TRUE(make_folder(scratch / "a/b/c"));
    ASSERT_TRUE(write_file(scratch / "file", "x"));
    EXPECT_FALSE(make_folder(scratch / "file"));
    EXPECT_FALSE(make_folder(scratch / "file/below"));
}

TEST(RemovePartialFiles, RemovesOnlyThem) {
    const ScratchFolder scratch;
    ASSERT_TRUE(write_file(scratch / "whole", "x"));
    std::ofstream(scratch / "half.part") << "x";
    remove_partial_files(scratch.path());
    EXPECT_EQ(list_folder(scratch.path()), std::vector<std::string>{"whole"});
}

TEST(AppendFile, GrowsByLinesAcrossOpenings) {
    const ScratchFolder scratch;
    const std::string path = scratch / "log";
    for (const char* line : {"one\n", "two\n"}) {
        Result<AppendFile> file = AppendFile::open(path);
        ASSERT_TRUE(file);
        EXPECT_TRUE(file.value().append(line));
        EXPECT_TRUE(file.value().sync());
    }
    EXPECT_EQ(content(path), "one\ntwo\n");
}

TEST(AppendFile, TakesBackALineThatDidNotFit) {
    const ScratchFolder scratch;
    const std::string path = scratch / "log";
    Result<AppendFile> file = AppendFile::open(path);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file.value().append("whole\n"));
    {
        const FileSizeLimit limit(10);
        EXPECT_FALSE(file.value().append("does not fit\n"));
        EXPECT_EQ(content(path), "whole\n");
    }
    EXPECT_TRUE(file.value().append("fits\n"));
    EXPECT_EQ(content(path), "whole\nfits\n");
}

TEST(AppendFile, ReportsAFullDisk) {
    Result<AppendFile> file = AppendFile::open("/dev/full");
    ASSERT_TRUE(file);
    const Status written = file.value().append("line\n");
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().where, "/dev/full");
    EXPECT_NE(written.error().message.find("No space left"), std::string::npos);
}

TEST(FolderLock, IsHeldByOneAtATimeAndFreeAfterwards) {
    const ScratchFolder scratch;
    {
        FolderLock first;
        FolderLock second;
        EXPECT_EQ(first.acquire(scratch.path()), FolderLock::Held::ByUs);
        EXPECT_EQ(second.acquire(scratch.path()), FolderLock::Held::ByAnother);
    }
    FolderLock third;
    EXPECT_EQ(third.acquire(scratch.path()), FolderLock::Held::ByUs);
}

}  // namespace
}  // namespace noli
