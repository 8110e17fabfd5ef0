// SPDX-License-Identifier: Apache-2.0
#include "mesh/cursor.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <limits>

namespace noli::detail {

namespace {

bool is_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

[[noreturn]] void fail_file(const std::string& path, std::string message) {
    throw ReadFailure{{Error::Code::FileNotReadable, path, std::move(message)}};
}

/// from_chars reports 1e-400 and 1e400 alike; the first is a fine zero.
bool is_underflow(std::string_view text) {
    const std::size_t exponent = text.find_first_of("eE");
    if (exponent != std::string_view::npos)
        return exponent + 1 < text.size() && text[exponent + 1] == '-';
    const std::size_t first_digit = text.find_first_of("0123456789");
    return first_digit != std::string_view::npos && text[first_digit] == '0';
}

}  // namespace

std::string load_file(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (!fs::exists(status))
        fail_file(
            path,
            "there is no such file; check the path (relative paths start at the working "
            "directory or at the scene's folder)");
    if (fs::is_directory(status))
        fail_file(path, "found a directory, expected a mesh file; name a file inside it");
    if (!fs::is_regular_file(status))
        fail_file(
            path,
            "found a device or pipe, expected a regular file; copy it to a file first");
    std::ifstream file(path, std::ios::binary);
    const std::uintmax_t size = fs::file_size(path, ec);
    if (!file || ec)
        fail_file(path,
                  fmt::format("the file cannot be opened ({}); check its permissions",
                              std::strerror(errno)));
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(file.gcount()) != size)
        fail_file(
            path,
            fmt::format("only {} of {} bytes could be read; check the disk and copy the "
                        "file again",
                        file.gcount(),
                        size));
    return bytes;
}

std::string quoted(std::string_view text) {
    constexpr std::size_t kMaxShown = 40;
    std::string out = "\"";
    for (const char c : text.substr(0, kMaxShown))
        out += (c >= ' ' && c <= '~') ? c : '?';
    return out + (text.size() > kMaxShown ? "...\"" : "\"");
}

Cursor::Cursor(std::string path, std::string_view bytes, char comment)
    : path_(std::move(path)), bytes_(bytes), comment_(comment) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (bytes_.substr(0, 3) == kByteOrderMark) pos_ = 3;
}

void Cursor::skip_blanks() {
    while (pos_ < bytes_.size()) {
        const char c = bytes_[pos_];
        if (c == comment_ && comment_ != '\0') {
            skip_line();
        } else if (is_blank(c)) {
            ++pos_;
        } else {
            return;
        }
    }
}

std::string_view Cursor::token() {
    skip_blanks();
    mark_ = pos_;
    while (pos_ < bytes_.size() && !is_blank(bytes_[pos_]))
        ++pos_;
    return bytes_.substr(mark_, pos_ - mark_);
}

std::string_view Cursor::token_in_line() {
    while (pos_ < bytes_.size() && bytes_[pos_] != '\n') {
        const bool continued = bytes_[pos_] == '\\'
                            && (bytes_.substr(pos_ + 1, 1) == "\n"
                                || bytes_.substr(pos_ + 1, 2) == "\r\n");
        if (continued) {
            skip_line();
        } else if (is_blank(bytes_[pos_])) {
            ++pos_;
        } else {
            break;
        }
    }
    mark_ = pos_;
    if (pos_ < bytes_.size() && bytes_[pos_] == comment_ && comment_ != '\0') return {};
    while (pos_ < bytes_.size() && !is_blank(bytes_[pos_]))
        ++pos_;
    return bytes_.substr(mark_, pos_ - mark_);
}

void Cursor::skip_line() {
    const std::size_t end = bytes_.find('\n', pos_);
    pos_ = end == std::string_view::npos ? bytes_.size() : end + 1;
}

bool Cursor::next_line() {
    if (started_) skip_line();
    started_ = true;
    skip_blanks();
    mark_ = pos_;
    return pos_ < bytes_.size();
}

double Cursor::parse_number(std::string_view text, std::string_view what) const {
    if (text.empty()) fail_truncated(what);
    double value = 0.0;
    const char* first = text.data() + (text[0] == '+' ? 1 : 0);
    const char* last = text.data() + text.size();
    const auto [end, ec] = std::from_chars(first, last, value);
    if (ec == std::errc::result_out_of_range && end == last && is_underflow(text))
        return 0.0;
    if (ec == std::errc::result_out_of_range
        || (ec == std::errc{} && !std::isfinite(value)))
        fail(fmt::format(
            "{} is {}, expected a finite number; the program that wrote the file "
            "failed there: correct or remove this point",
            what,
            quoted(text)));
    if (ec != std::errc{} || end != last)
        fail(fmt::format(
            "found {} as {}, expected a number like 0.25 or 1e-3; correct this line "
            "or write the file again",
            quoted(text),
            what));
    return value;
}

std::int64_t Cursor::parse_integer(std::string_view text, std::string_view what) const {
    if (text.empty()) fail_truncated(what);
    std::int64_t value = 0;
    const char* first = text.data() + (text[0] == '+' ? 1 : 0);
    const char* last = text.data() + text.size();
    const auto [end, ec] = std::from_chars(first, last, value);
    if (ec != std::errc{} || end != last)
        fail(fmt::format(
            "found {} as {}, expected a whole number; correct this line or write the "
            "file again",
            quoted(text),
            what));
    return value;
}

int Cursor::checked_count(std::int64_t count,
                          std::size_t min_bytes,
                          std::string_view what) const {
    if (count < 0)
        fail(fmt::format(
            "the number of {} is {}, expected 0 or more; correct the count or write "
            "the file again",
            what,
            count));
    const std::size_t fits = remaining() / std::max<std::size_t>(min_bytes, 1);
    if (static_cast<std::uint64_t>(count) > fits)
        fail(fmt::format(
            "the file announces {} {}, but its remaining {} bytes hold at most {}; the "
            "count is wrong or the file is truncated: write or copy it again",
            count,
            what,
            remaining(),
            fits));
    if (count > std::numeric_limits<int>::max() / 4)
        fail(fmt::format(
            "the file announces {} {}, more than this program can number; split or "
            "coarsen the mesh",
            count,
            what));
    return static_cast<int>(count);
}

double Cursor::checked_finite(double value, std::string_view what) const {
    if (!std::isfinite(value))
        fail(fmt::format(
            "{} is {}, expected a finite number; the program that wrote the file failed "
            "there, or the file is damaged: write it again",
            what,
            value));
    return value;
}

void Cursor::skip_bytes(std::size_t count, std::string_view what) {
    mark_ = pos_;
    if (count > remaining()) fail_truncated(what);
    pos_ += count;
}

bool Cursor::skip_behind(std::string_view text) {
    const std::size_t found = bytes_.find(text, pos_);
    if (found == std::string_view::npos) return false;
    pos_ = found + text.size();
    return true;
}

std::string Cursor::place() const {
    if (binary_) return fmt::format("{} (byte {})", path_, mark_);
    const auto line =
        std::count(bytes_.begin(), bytes_.begin() + static_cast<long>(mark_), '\n');
    return fmt::format("{}:{}", path_, line + 1);
}

void Cursor::fail(std::string message) const {
    throw ReadFailure{{Error::Code::BadMesh, place(), std::move(message)}};
}

void Cursor::fail_truncated(std::string_view what) const {
    fail(fmt::format(
        "the {} ends where {} was expected; the file is truncated or a count in it is "
        "too large: write or copy it again",
        mark_ >= bytes_.size() || binary_ ? "file" : "line",
        what));
}

}  // namespace noli::detail
