// SPDX-License-Identifier: Apache-2.0
#include "scene/json_text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <set>
#include <vector>

namespace noli {

namespace {

/// Follows the parser through the text and remembers the first key that appears twice.
class DuplicateKeys {
  public:
    void operator()(Json::parse_event_t event, const Json& parsed) {
        switch (event) {
            case Json::parse_event_t::object_start:
                frames_.push_back({.is_array = false});
                break;
            case Json::parse_event_t::array_start:
                frames_.push_back({.is_array = true});
                break;
            case Json::parse_event_t::key:
                enter_key(parsed.get<std::string>());
                break;
            case Json::parse_event_t::object_end:
            case Json::parse_event_t::array_end:
                frames_.pop_back();
                next_element();
                break;
            case Json::parse_event_t::value:
                next_element();
                break;
        }
    }

    /// Pointer to the second appearance; empty if there is none.
    [[nodiscard]] const std::string& pointer() const { return pointer_; }
    [[nodiscard]] const std::string& key() const { return key_; }

  private:
    struct Frame {
        bool is_array = false;
        int index = 0;
        std::string key = {};
        std::set<std::string> keys = {};
    };

    void enter_key(const std::string& key) {
        Frame& frame = frames_.back();
        frame.key = key;
        if (frame.keys.insert(key).second || !pointer_.empty()) return;
        key_ = key;
        for (const Frame& f : frames_)
            pointer_ +=
                "/" + (f.is_array ? std::to_string(f.index) : escape_pointer(f.key));
    }

    void next_element() {
        if (!frames_.empty() && frames_.back().is_array) ++frames_.back().index;
    }

    std::vector<Frame> frames_;
    std::string pointer_;
    std::string key_;
};

std::string line_and_column(const std::string& text, std::size_t byte) {
    const std::size_t at = std::min(byte == 0 ? 0 : byte - 1, text.size());
    std::size_t line = 1;
    std::size_t column = 1;
    for (std::size_t i = 0; i < at; ++i) {
        ++column;
        if (text[i] == '\n') {
            ++line;
            column = 1;
        }
    }
    return fmt::format("{}:{}", line, column);
}

/// The library's sentence without its own codes and places, which we give ourselves.
std::string plain_sentence(const std::string& what) {
    std::string text = what;
    if (const auto at = text.find("] "); at != std::string::npos) text.erase(0, at + 2);
    if (const auto at = text.find(": ");
        text.starts_with("parse error") && at != std::string::npos)
        text.erase(0, at + 2);
    for (std::size_t at = text.find("; last read:"); at != std::string::npos;
         at = std::string::npos)
        text.replace(at, 12, "; read so far:");
    return text;
}

const char* syntax_cure(const std::string& text, std::size_t byte) {
    std::size_t i = std::min(byte == 0 ? 0 : byte - 1, text.size());
    const bool closes = i < text.size() && (text[i] == '}' || text[i] == ']');
    while (i > 0 && std::isspace(static_cast<unsigned char>(text[i - 1])) != 0)
        --i;
    if (i == 0) return "; write a scene as { \"format_version\": 1, ... }";
    if (closes && text[i - 1] == ',') return "; remove the comma before this bracket";
    if (byte > text.size())
        return "; the text ends too early: close every bracket and quote";
    return "; check for a missing comma, colon, quote or bracket just before this place";
}

constexpr int kLineWidth = 100;

std::string print_number(const Json& value) {
    if (!value.is_number_float()) return value.dump();
    const double number = value.get<double>();
    if (number == 0.0 && std::signbit(number))
        return "-0.0";  // "-0" would read as a whole number
    return fmt::format("{}", number);
}

std::string print_flat(const Json& value) {
    if (value.is_number()) return print_number(value);
    if (!value.is_structured() || value.empty()) return value.dump();
    std::string text;
    for (const auto& [key, item] : value.items()) {
        text += text.empty() ? "" : ", ";
        if (value.is_object()) text += Json(key).dump() + ": ";
        text += print_flat(item);
    }
    return value.is_object() ? "{ " + text + " }" : "[" + text + "]";
}

/// `used` characters stand before the value on its line.
void print_into(std::string& out, const Json& value, int indent, int used) {
    const std::string flat = print_flat(value);
    const bool top = indent == 0;
    const bool fits = used + static_cast<int>(flat.size()) <= kLineWidth;
    if (!value.is_structured() || value.empty() || (fits && !top)) {
        out += flat;
        return;
    }
    const std::string margin(static_cast<std::size_t>(indent) + 2, ' ');
    const bool numbers = value.is_array() && !value.front().is_structured();
    out += value.is_object() ? "{" : "[";
    int column = kLineWidth;  // the first item starts a line
    bool first = true;
    for (const auto& [key, item] : value.items()) {
        const std::string lead = value.is_object() ? Json(key).dump() + ": " : "";
        const std::string short_form = numbers ? print_flat(item) : "";
        const bool same_line =
            numbers && column + static_cast<int>(short_form.size()) + 2 <= kLineWidth - 1;
        out += first ? "" : ",";
        out += same_line ? " " : "\n" + margin;
        column = same_line ? column + 1 : indent + 2;
        out += lead;
        const std::size_t before = out.size();
        print_into(out, item, indent + 2, indent + 2 + static_cast<int>(lead.size()) + 1);
        column += static_cast<int>(out.size() - before) + 1;
        first = false;
    }
    out += '\n' + std::string(static_cast<std::size_t>(indent), ' ');
    out += value.is_object() ? "}" : "]";
}

}  // namespace

Result<Json> parse_json(const std::string& text, const std::string& file) {
    DuplicateKeys duplicates;
    const auto follow = [&](int, Json::parse_event_t event, Json& parsed) {
        duplicates(event, parsed);
        return true;
    };
    try {
        Json tree = Json::parse(text, follow, true, true);
        if (duplicates.pointer().empty()) return tree;
        return Error{
            Error::Code::InvalidScene,
            file + ":" + duplicates.pointer(),
            fmt::format(
                "found the key \"{}\" twice in one object, expected it once; remove "
                "one of the two",
                duplicates.key())};
    } catch (const Json::parse_error& e) {
        return Error{Error::Code::InvalidScene,
                     file + ":" + line_and_column(text, e.byte),
                     "found text that is not JSON (" + plain_sentence(e.what())
                         + "), expected JSON" + syntax_cure(text, e.byte)};
    } catch (const Json::exception& e) {  // a number out of the range of doubles
        return Error{
            Error::Code::InvalidScene,
            file,
            "found text that is not JSON (" + plain_sentence(e.what())
                + "), expected JSON with numbers below 1.8e308; correct the number"};
    }
}

std::string print_json(const Json& value) {
    std::string text;
    print_into(text, value, 0, 0);
    return text;
}

std::string escape_pointer(const std::string& key) {
    std::string out;
    for (const char c : key)
        out += c == '~' ? "~0" : (c == '/' ? "~1" : std::string(1, c));
    return out;
}

}  // namespace noli
