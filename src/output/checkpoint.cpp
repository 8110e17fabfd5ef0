// SPDX-License-Identifier: Apache-2.0
#include "output/checkpoint.hpp"

#include "output/file.hpp"
#include "output/hash.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <string_view>

namespace noli {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little,
              "checkpoints are little-endian");

constexpr std::string_view kMagic = "NOLICKPT";
constexpr std::string_view kPrefix = "step_";
constexpr std::string_view kSuffix = ".ckpt";
constexpr std::uint32_t kVersion1 = 1;
constexpr size_t kHeaderBytes = 56;
constexpr size_t kChecksumBytes = 8;

template <class T>
void put(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T get(std::string_view bytes, size_t offset) {
    T value{};
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

/// Step number of a checkpoint's file name, or -1.
int step_of_name(const std::string& name) {
    if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return -1;
    const char* end = name.data() + name.size() - kSuffix.size();
    int step = -1;
    const auto parsed = std::from_chars(name.data() + kPrefix.size(), end, step);
    return parsed.ec == std::errc() && parsed.ptr == end ? step : -1;
}

/// Steps of the checkpoint files in a folder, newest first.
std::vector<int> listed_steps(const std::string& folder) {
    std::vector<int> steps;
    for (const std::string& name : list_folder(folder))
        if (const int step = step_of_name(name); step >= 0) steps.push_back(step);
    std::sort(steps.rbegin(), steps.rend());
    return steps;
}

std::string path_of(const std::string& folder, int step) {
    return (fs::path(folder) / checkpoint_file_name(step)).string();
}

void remove_quietly(const std::string& path) {
    std::error_code ignored;
    fs::remove(path, ignored);
}

}  // namespace

std::string checkpoint_file_name(int step) {
    return fmt::format("{}{:09}{}", kPrefix, step, kSuffix);
}

std::string encode_checkpoint(const Checkpoint& checkpoint) {
    std::string out(kMagic);
    out.reserve(kHeaderBytes + checkpoint.payload.size() + kChecksumBytes);
    put(out, kVersion1);
    put(out, std::uint32_t{0});
    put(out, checkpoint.fingerprint);
    put(out, checkpoint.state_hash);
    put(out, static_cast<std::int64_t>(checkpoint.step));
    put(out, checkpoint.time);
    put(out, static_cast<std::uint64_t>(checkpoint.payload.size()));
    out.append(reinterpret_cast<const char*>(checkpoint.payload.data()),
               checkpoint.payload.size());
    put(out, hash_bytes(out));
    return out;
}

Result<Checkpoint> decode_checkpoint(const std::string& bytes, const std::string& where) {
    const auto bad = [&where](const std::string& what) {
        return Error{Error::Code::BadCheckpoint,
                     where,
                     what + "; delete it or resume from an older checkpoint"};
    };
    if (bytes.size() < kHeaderBytes + kChecksumBytes)
        return bad(
            fmt::format("truncated: {} bytes are less than a header", bytes.size()));
    if (!bytes.starts_with(kMagic)) return bad("not a checkpoint of noli");
    if (const auto version = get<std::uint32_t>(bytes, 8); version != kVersion1)
        return bad(fmt::format(
            "has version {}, this program reads version {}", version, kVersion1));
    const auto payload_size = get<std::uint64_t>(bytes, 48);
    const std::uint64_t there = bytes.size() - kHeaderBytes - kChecksumBytes;
    if (payload_size != there)
        return bad(
            fmt::format("truncated: {} of {} bytes of state", there, payload_size));
    const std::string_view checked =
        std::string_view(bytes).substr(0, bytes.size() - kChecksumBytes);
    if (hash_bytes(checked) != get<std::uint64_t>(bytes, checked.size()))
        return bad("damaged: the checksum does not match");
    Checkpoint out;
    out.fingerprint = get<std::uint64_t>(bytes, 16);
    out.state_hash = get<std::uint64_t>(bytes, 24);
    out.step = static_cast<int>(get<std::int64_t>(bytes, 32));
    out.time = get<double>(bytes, 40);
    out.payload.resize(payload_size);
    if (payload_size > 0)
        std::memcpy(out.payload.data(), bytes.data() + kHeaderBytes, payload_size);
    return out;
}

Status write_checkpoint(const std::string& folder, const Checkpoint& checkpoint) {
    if (Status made = make_folder(folder); !made) return made;
    Status written = write_file(path_of(folder, checkpoint.step),
                                encode_checkpoint(checkpoint),
                                Durability::Synced);
    if (!written) return written;
    int kept = 0;
    for (const int step : listed_steps(folder))
        if (step <= checkpoint.step && ++kept > kCheckpointsKept)
            remove_quietly(path_of(folder, step));
    return written;
}

FoundCheckpoint load_newest_checkpoint(const std::string& folder,
                                       std::uint64_t fingerprint) {
    FoundCheckpoint found;
    for (const int step : listed_steps(folder)) {
        const std::string path = path_of(folder, step);
        Result<std::string> bytes = read_file(path);
        Result<Checkpoint> read = bytes ? decode_checkpoint(bytes.value(), path)
                                        : Result<Checkpoint>(bytes.error());
        if (!read) {
            found.skipped.push_back(path + ": " + read.error().message);
        } else if (read.value().fingerprint != fingerprint) {
            found.skipped.push_back(path + ": belongs to another scene");
        } else if (read.value().step != step) {
            found.skipped.push_back(path + ": its name and its content name two steps");
        } else {
            found.found = true;
            found.checkpoint = std::move(read.value());
            found.path = path;
            return found;
        }
    }
    return found;
}

void remove_checkpoints_after(const std::string& folder, int step) {
    for (const int listed : listed_steps(folder))
        if (listed > step) remove_quietly(path_of(folder, listed));
}

}  // namespace noli
