// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the program says: plain text on stdout, complaints on stderr, colours only on a
/// terminal.

#include "noli/result.hpp"

#include <cstdio>
#include <string>
#include <string_view>

namespace noli::cli {

/// Exit codes, the same for all commands (docs/cli.md).
enum ExitCode {
    kFine = 0,
    kFailure = 1,     ///< a bug, or the system failed: disk full, no permission to write
    kYourInput = 2,   ///< scene, mesh, command line, directory, device
    kNumbers = 3,     ///< a step did not converge
    kSignalled = 128  ///< plus the number of the signal that stopped a run
};

enum class Colour { Plain, Bold, Dim, Red, Green, Yellow };

/// `text` in a colour if `stream` is a terminal and NO_COLOR is not set.
std::string paint(std::FILE* stream, Colour colour, std::string_view text);

bool is_terminal(std::FILE* stream);

/// Columns of the terminal behind stdout; 80 if unknown.
int terminal_width();

/// Writes to stdout at once. A reader that went away is no error; a full disk is
/// remembered.
void print(std::string_view text);

/// kFailure with a message if something printed did not arrive, else `code`.
int finish_printing(int code);

/// "error: where: message" on stderr.
void print_error(const Error& error);
void print_error(std::string_view where, std::string_view message);
void print_warning(std::string_view where, std::string_view message);
void print_note(std::string_view message);

int exit_code_of(const Error& error);

/// Prints the error; its exit code.
int fail(const Error& error);

}  // namespace noli::cli
