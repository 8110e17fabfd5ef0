// SPDX-License-Identifier: Apache-2.0
#include "scene/ipc_lines.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <sstream>

namespace noli {

namespace {

std::optional<double> parse_number(const std::string& word) {
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* end = word.data() + word.size();
    double value = 0.0;
    const auto [stop, failure] = std::from_chars(begin, end, value);
    if (failure != std::errc{} || stop != end || !std::isfinite(value))
        return std::nullopt;
    return value;
}

}  // namespace

ScriptWords::ScriptWords(std::string file, int line, std::vector<std::string> words)
    : file_(std::move(file)), line_(line), words_(std::move(words)) {}

bool ScriptWords::number_follows() const {
    return !done() && parse_number(words_[next_]).has_value();
}

std::string ScriptWords::word(const char* what) {
    if (done())
        fail(fmt::format("found the end of the line, expected {}; complete the line",
                         what));
    return words_[next_++];
}

double ScriptWords::number(const char* what) {
    const std::string text = word(what);
    const auto value = parse_number(text);
    if (!value)
        fail(fmt::format(
            "found \"{}\", expected a number: {}; correct the word", text, what));
    return *value;
}

int ScriptWords::integer(const char* what) {
    const double value = number(what);
    if (std::floor(value) != value || std::abs(value) > 1e9)
        fail(fmt::format(
            "found {}, expected a whole number: {}; correct it", value, what));
    return static_cast<int>(value);
}

Vector3 ScriptWords::vector(const char* what) {
    Vector3 v{};
    for (double& x : v)
        x = number(what);
    return v;
}

std::string ScriptWords::where() const {
    return fmt::format("{}:{}", file_, line_);
}

void ScriptWords::fail(const std::string& message, Error::Code code) const {
    throw ScriptFailure{{code, where(), message}};
}

ScriptLines::ScriptLines(std::string file, const std::string& text)
    : file_(std::move(file)) {
    std::istringstream in(text);
    std::string raw;
    bool continues = false;
    for (int number = 1; std::getline(in, raw); ++number) {
        while (!raw.empty()
               && (raw.back() == '\r' || raw.back() == ' ' || raw.back() == '\t'))
            raw.pop_back();
        const bool joins_next = raw.ends_with('\\');  // also at the end of a comment
        if (joins_next) raw.pop_back();
        std::istringstream content(raw.substr(0, raw.find('#')));
        if (!continues) lines_.push_back({number, {}});
        for (std::string word; content >> word;)
            lines_.back().words.push_back(word);
        continues = joins_next;
    }
}

bool ScriptLines::next(ScriptWords& words) {
    while (next_ < lines_.size() && lines_[next_].words.empty())
        ++next_;
    if (next_ >= lines_.size()) return false;
    words = ScriptWords(file_, lines_[next_].number, lines_[next_].words);
    ++next_;
    return true;
}

std::vector<double> ScriptLines::numbers(int count, const ScriptWords& opening) {
    std::vector<double> values;
    while (static_cast<int>(values.size()) < count) {
        while (next_ < lines_.size() && lines_[next_].words.empty())
            ++next_;
        if (next_ >= lines_.size())
            opening.fail(fmt::format(
                "found {} numbers up to the end of the file, expected {}; add the others",
                values.size(),
                count));
        Line& line = lines_[next_];
        values.push_back(
            ScriptWords(file_, line.number, line.words).number("one of the list above"));
        line.words.erase(line.words.begin());
    }
    return values;
}

}  // namespace noli
