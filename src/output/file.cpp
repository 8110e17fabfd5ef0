// SPDX-License-Identifier: Apache-2.0
#include "output/file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace noli {

namespace fs = std::filesystem;

namespace {

const char* cure_of(int error_number) {
    switch (error_number) {
        case ENOSPC:
        case EDQUOT:
            return "free some space, then go on with --resume, or choose another disk "
                   "with -o";
        case EACCES:
        case EPERM:
        case EROFS:
            return "choose a folder that you may write to with -o";
        case EFBIG:
            return "raise the file-size limit (ulimit -f), then go on with --resume";
        case ENOENT:
        case ENOTDIR:
        case EISDIR:
        case ELOOP:
        case ENAMETOOLONG:
            return "check the path given with -o";
        case EMFILE:
        case ENFILE:
            return "raise the limit of open files (ulimit -n), then go on with --resume";
        default:
            return "check the disk, then go on with --resume";
    }
}

/// Writes all bytes, whatever pieces the system takes them in; 0 or an errno.
int write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            return errno;
        }
        bytes.remove_prefix(static_cast<size_t>(written));
    }
    return 0;
}

/// fsync; file kinds that know no such thing (pipes, devices) count as synced. 0 or an
/// errno.
int sync_descriptor(int descriptor) {
    if (::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
    return errno;
}

std::string folder_of(const std::string& path) {
    const std::string folder = fs::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

/// Makes a rename in `folder` last; best effort, since the file itself is already safe.
void sync_folder(const std::string& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

/// Writes `bytes` under the temporary name; 0 or an errno.
int write_part(const std::string& part, std::string_view bytes, Durability durability) {
    const int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
    const int descriptor = ::open(part.c_str(), flags, 0666);
    if (descriptor < 0) return errno;
    int failed = write_all(descriptor, bytes);
    if (failed == 0 && durability == Durability::Synced)
        failed = sync_descriptor(descriptor);
    // close() may be the first to report a full network disk.
    if (::close(descriptor) != 0 && failed == 0) failed = errno;
    return failed;
}

}  // namespace

Error io_error(const std::string& action, const std::string& path, int error_number) {
    return {Error::Code::FileNotWritable,
            path,
            "cannot " + action + ": " + std::strerror(error_number) + "; "
                + cure_of(error_number)};
}

Status write_file(const std::string& path,
                  std::string_view bytes,
                  Durability durability) {
    const std::string part = path + std::string(kPartSuffix);
    if (const int failed = write_part(part, bytes, durability); failed != 0) {
        ::unlink(part.c_str());
        return io_error("write", path, failed);
    }
    if (::rename(part.c_str(), path.c_str()) != 0) {
        const int failed = errno;
        ::unlink(part.c_str());
        return io_error("write", path, failed);
    }
    if (durability == Durability::Synced) sync_folder(folder_of(path));
    return Done{};
}

Status sync_file(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return io_error("write", path, errno);
    const int failed = sync_descriptor(descriptor);
    ::close(descriptor);
    if (failed != 0) return io_error("write", path, failed);
    return Done{};
}

Result<std::string> read_file(const std::string& path) {
    const auto unreadable = [&path](int error_number) {
        return Error{Error::Code::FileNotReadable,
                     path,
                     std::string("cannot read: ") + std::strerror(error_number)
                         + "; check the path and its permissions"};
    };
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return unreadable(errno);
    std::string bytes;
    std::vector<char> chunk(1 << 16);
    ssize_t got = 0;
    int failed = 0;
    while ((got = ::read(descriptor, chunk.data(), chunk.size())) != 0) {
        if (got > 0) {
            bytes.append(chunk.data(), static_cast<size_t>(got));
        } else if (errno != EINTR) {
            failed = errno;
            break;
        }
    }
    ::close(descriptor);
    if (failed != 0) return unreadable(failed);
    return bytes;
}

Status make_folder(const std::string& path) {
    std::error_code failed;
    fs::create_directories(path, failed);
    if (failed) return io_error("create the folder", path, failed.value());
    if (!fs::is_directory(path, failed))
        return io_error("create the folder", path, ENOTDIR);
    return Done{};
}

std::vector<std::string> list_folder(const std::string& path) {
    std::vector<std::string> names;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(path, failed))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

void remove_partial_files(const std::string& folder) {
    for (const std::string& name : list_folder(folder)) {
        if (!name.ends_with(kPartSuffix)) continue;
        std::error_code ignored;
        fs::remove(fs::path(folder) / name, ignored);
    }
}

Result<AppendFile> AppendFile::open(const std::string& path) {
    AppendFile file;
    file.path_ = path;
    file.descriptor_ =
        ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file.descriptor_ < 0) return io_error("write", path, errno);
    return file;
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

AppendFile::~AppendFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Status AppendFile::append(std::string_view text) {
    if (descriptor_ < 0) return Done{};
    struct stat before {};
    const bool is_file = ::fstat(descriptor_, &before) == 0 && S_ISREG(before.st_mode);
    const int failed = write_all(descriptor_, text);
    if (failed == 0) return Done{};
    // Half a line would be taken for a whole one by a reader of the table.
    if (is_file && ::ftruncate(descriptor_, before.st_size) != 0)
        return io_error("write", path_, errno);
    return io_error("write", path_, failed);
}

Status AppendFile::sync() {
    if (descriptor_ < 0) return Done{};
    if (const int failed = sync_descriptor(descriptor_); failed != 0)
        return io_error("write", path_, failed);
    return Done{};
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

FolderLock::Held FolderLock::acquire(const std::string& folder) {
    descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ < 0) return Held::ByUs;
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return Held::ByAnother;
    return Held::ByUs;
}

}  // namespace noli
