// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Files that are either whole or not there. A whole file is written under a temporary
/// name
/// ("<path>.part") in the same folder and renamed, so that a process killed at any moment
/// leaves the old file or the new one; growing files (logs, tables) get whole lines, one
/// write each.

#include "noli/result.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace noli {

/// What a file name ends with until the file is whole.
inline constexpr std::string_view kPartSuffix = ".part";

/// The error of a system call on `path`: what failed, errno's text, a cure. `action` is a
/// verb phrase such as "write" or "create the folder".
Error io_error(const std::string& action, const std::string& path, int error_number);

/// How far a finished file is pushed before it gets its name. Buffered survives the death
/// of the process, Synced also the loss of power.
enum class Durability { Buffered, Synced };

/// Writes `bytes` as the file `path`, replacing an old one, all or nothing.
Status write_file(const std::string& path,
                  std::string_view bytes,
                  Durability durability = Durability::Buffered);

/// Pushes a finished file to the disk.
Status sync_file(const std::string& path);

/// The whole content of a file; FileNotReadable when that fails.
Result<std::string> read_file(const std::string& path);

/// Creates a folder and its parents; fine if it is there already.
Status make_folder(const std::string& path);

/// Names (not paths) of the entries of a folder, sorted; empty if there is no such
/// folder.
std::vector<std::string> list_folder(const std::string& path);

/// Removes what an interrupted write left behind ("*.part") in a folder.
void remove_partial_files(const std::string& folder);

/// A file that grows by whole lines. A line that cannot be written whole is taken back.
class AppendFile {
  public:
    static Result<AppendFile> open(const std::string& path);
    AppendFile() = default;
    AppendFile(AppendFile&& other) noexcept;
    AppendFile& operator=(AppendFile&& other) noexcept;
    ~AppendFile();

    /// Appends `text` (one or several lines, each ending in a newline). No-op on a closed
    /// file.
    Status append(std::string_view text);
    /// Pushes everything appended so far to the disk.
    Status sync();
    [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

  private:
    std::string path_;
    int descriptor_ = -1;
};

/// Holds a folder for one process (an advisory lock that dies with it).
class FolderLock {
  public:
    enum class Held { ByUs, ByAnother };
    FolderLock() = default;
    FolderLock(FolderLock&& other) noexcept;
    FolderLock& operator=(FolderLock&& other) noexcept;
    ~FolderLock();

    /// Tries to take the lock. File systems without locks count as ByUs.
    Held acquire(const std::string& folder);

  private:
    int descriptor_ = -1;
};

}  // namespace noli
