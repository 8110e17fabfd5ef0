// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The lines and words of an IPC script.

#include "noli/result.hpp"
#include "noli/scene.hpp"

#include <string>
#include <vector>

namespace noli {

/// Thrown inside the script reader; becomes the Error of a Result.
struct ScriptFailure {
    Error error;
};

/// The words of one line, taken from left to right. Failures name the line.
class ScriptWords {
  public:
    ScriptWords() = default;
    ScriptWords(std::string file, int line, std::vector<std::string> words);

    [[nodiscard]] bool done() const { return next_ >= words_.size(); }
    /// The next word without taking it; empty at the end.
    [[nodiscard]] std::string peek() const {
        return done() ? std::string{} : words_[next_];
    }
    [[nodiscard]] bool number_follows() const;
    std::string word(const char* what);
    double number(const char* what);
    int integer(const char* what);
    Vector3 vector(const char* what);

    [[nodiscard]] int line() const { return line_; }
    [[nodiscard]] std::string where() const;
    [[noreturn]] void fail(const std::string& message,
                           Error::Code code = Error::Code::InvalidScene) const;

  private:
    std::string file_;
    int line_ = 0;
    std::vector<std::string> words_;
    std::size_t next_ = 0;
};

/// Fails at the place of `words` unless the condition holds.
inline void require(bool holds, const ScriptWords& words, const std::string& message) {
    if (!holds) words.fail(message);
}

/// Walks through a script. `#` starts a comment, `\` at the end of a line joins the next
/// one.
class ScriptLines {
  public:
    ScriptLines(std::string file, const std::string& text);

    /// The next line that has words; false at the end.
    bool next(ScriptWords& words);
    /// `count` numbers from the lines that follow; what stands after the last of them is
    /// a line.
    std::vector<double> numbers(int count, const ScriptWords& opening);

  private:
    struct Line {
        int number = 0;
        std::vector<std::string> words;
    };
    std::string file_;
    std::vector<Line> lines_;
    std::size_t next_ = 0;
};

}  // namespace noli
