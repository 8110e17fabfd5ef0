// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace noli::cli {

namespace {

int print_failure = 0;  ///< errno of the first write to stdout that failed

const char* code_of(Colour colour) {
    switch (colour) {
        case Colour::Plain:
            return "";
        case Colour::Bold:
            return "\033[1m";
        case Colour::Dim:
            return "\033[2m";
        case Colour::Red:
            return "\033[1;31m";
        case Colour::Green:
            return "\033[32m";
        case Colour::Yellow:
            return "\033[33m";
    }
    return "";
}

/// "kind: where: message" on stderr; further lines of the message are complaints of their
/// own.
void complain(Colour colour,
              std::string_view kind,
              std::string_view where,
              std::string_view message) {
    std::fflush(stdout);
    const std::string label = paint(stderr, colour, fmt::format("{}:", kind));
    std::string text = fmt::format("{} {}{}", label, where, where.empty() ? "" : ": ");
    for (const char c : message) {
        text += c;
        if (c == '\n') text += label + " ";
    }
    text += '\n';
    std::fputs(text.c_str(), stderr);
}

}  // namespace

bool is_terminal(std::FILE* stream) {
    return ::isatty(::fileno(stream)) == 1;
}

std::string paint(std::FILE* stream, Colour colour, std::string_view text) {
    const char* no_color = std::getenv("NO_COLOR");
    const bool is_plain = colour == Colour::Plain || !is_terminal(stream)
                       || (no_color != nullptr && *no_color != '\0');
    return is_plain ? std::string(text)
                    : fmt::format("{}{}\033[0m", code_of(colour), text);
}

int terminal_width() {
    struct winsize size {};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
    return size.ws_col;
}

void print(std::string_view text) {
    if (print_failure != 0) return;
    std::fwrite(text.data(), 1, text.size(), stdout);
    if (std::fflush(stdout) != 0) print_failure = errno;
}

int finish_printing(int code) {
    if (print_failure == 0 || print_failure == EPIPE) return code;
    print_error("standard output",
                fmt::format("cannot write: {}; free some space or redirect elsewhere",
                            std::strerror(print_failure)));
    return code == kFine ? static_cast<int>(kFailure) : code;
}

void print_error(std::string_view where, std::string_view message) {
    complain(Colour::Red, "error", where, message);
}
void print_error(const Error& error) {
    print_error(error.where, error.message);
}
void print_warning(std::string_view where, std::string_view message) {
    complain(Colour::Yellow, "warning", where, message);
}
void print_note(std::string_view message) {
    complain(Colour::Dim, "note", "", message);
}

int exit_code_of(const Error& error) {
    return error.code == Error::Code::FileNotWritable ? kFailure : kYourInput;
}

int fail(const Error& error) {
    print_error(error);
    return exit_code_of(error);
}

}  // namespace noli::cli
