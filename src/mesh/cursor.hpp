// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What all mesh readers share: a whole file in memory and a position in it.
///
/// Readers nest deeply (file, section, block, number) and every number can be wrong. They
/// report through one exception that read_mesh turns into an Error; it never leaves this
/// room.

#include "noli/result.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace noli::detail {

/// Ends a reader; caught by read_mesh and nowhere else.
struct ReadFailure {
    Error error;
};

/// The bytes of a regular file. Throws ReadFailure (FileNotReadable).
std::string load_file(const std::string& path);

/// At most 40 characters of found text in quotes, with unprintable bytes replaced.
std::string quoted(std::string_view text);

/// Position in a file; reads text tokens and binary values, and says where it stands when
/// it fails.
class Cursor {
  public:
    /// comment: character that hides the rest of its line, or 0. The bytes must outlive
    /// the cursor.
    Cursor(std::string path, std::string_view bytes, char comment = '\0');

    /// Next run of non-blank characters; empty at the end of the file.
    std::string_view token();
    /// Next token of this line; empty at its end. A backslash before the end continues
    /// the line.
    std::string_view token_in_line();
    /// Goes to the next line that has a token; false at the end of the file.
    bool next_line();
    /// Goes behind the next line end.
    void skip_line();

    /// Next token as a finite number. what: its name in messages ("x of node 3").
    double number(std::string_view what) { return parse_number(token(), what); }
    std::int64_t integer(std::string_view what) { return parse_integer(token(), what); }
    [[nodiscard]] double parse_number(std::string_view text, std::string_view what) const;
    [[nodiscard]] std::int64_t parse_integer(std::string_view text,
                                             std::string_view what) const;
    /// Fails unless `count` items of at least `min_bytes` each fit into the rest of the
    /// file and into an int. Called before anything is allocated.
    [[nodiscard]] int checked_count(std::int64_t count,
                                    std::size_t min_bytes,
                                    std::string_view what) const;

    /// Next value of a binary file.
    template <class T>
    T take(std::string_view what) {
        mark_ = pos_;
        if (bytes_.size() - pos_ < sizeof(T)) fail_truncated(what);
        char raw[sizeof(T)];
        std::memcpy(raw, bytes_.data() + pos_, sizeof(T));
        if (swap_) std::reverse(raw, raw + sizeof(T));
        T value;
        std::memcpy(&value, raw, sizeof(T));
        pos_ += sizeof(T);
        return value;
    }
    /// Fails when a binary coordinate is NaN or infinite.
    [[nodiscard]] double checked_finite(double value, std::string_view what) const;

    /// From here on places are told in bytes; swap: values have the other byte order.
    void set_binary(bool swap) {
        binary_ = true;
        swap_ = swap;
    }
    void skip_bytes(std::size_t count, std::string_view what);
    /// Moves behind the next occurrence of text; false (and no move) when there is none.
    bool skip_behind(std::string_view text);

    [[nodiscard]] std::size_t remaining() const { return bytes_.size() - pos_; }
    [[nodiscard]] std::size_t position() const { return pos_; }
    [[nodiscard]] const std::string& path() const { return path_; }
    /// "file:line" or "file (byte n)" of the last token.
    [[nodiscard]] std::string place() const;

    [[noreturn]] void fail(std::string message) const;
    [[noreturn]] void fail_truncated(std::string_view what) const;

  private:
    void skip_blanks();

    std::string path_;
    std::string_view bytes_;
    char comment_;
    bool binary_ = false, swap_ = false;
    std::size_t pos_ = 0;
    std::size_t mark_ = 0;  // start of the last token, where errors point to
    bool started_ = false;  // next_line() was called
};

}  // namespace noli::detail
