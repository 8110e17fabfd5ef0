// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "commands.hpp"
#include "terminal.hpp"

#include <algorithm>

namespace noli::cli {

int info_command(const std::vector<std::string>& paths) {
    int code = kFine;
    for (const std::string& path : paths) {
        const Result<std::string> text = describe(path);
        if (text)
            print(text.value());
        else
            code = std::max(code, fail(text.error()));
    }
    return code;
}

}  // namespace noli::cli
