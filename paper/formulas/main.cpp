// SPDX-License-Identifier: Apache-2.0
/// Prints CSV tables of the library's formulas beside those of the GIPC supplement:
///
///     noli_paper_formulas constructions|eigenvalues|friction|mollified [SAMPLES [SEED]]

#include "tables.hpp"

#include <cstdlib>
#include <string_view>

namespace {

struct Command {
    std::string_view name;
    void (*print)(const noli::paper::SampleOptions&);
};

constexpr Command kCommands[] = {
    {"constructions", noli::paper::print_constructions},
    {"eigenvalues", noli::paper::print_eigenvalues},
    {"friction", noli::paper::print_friction},
    {"mollified", noli::paper::print_mollified},
};

int usage() {
    std::fprintf(stderr,
                 "usage: noli_paper_formulas "
                 "constructions|eigenvalues|friction|mollified [SAMPLES [SEED]]\n");
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 4) return usage();
    noli::paper::SampleOptions options;
    if (argc > 2) options.samples = std::atoi(argv[2]);
    if (argc > 3) options.seed = unsigned(std::atoi(argv[3]));
    if (options.samples < 1) return usage();
    for (const Command& command : kCommands) {
        if (command.name != argv[1]) continue;
        command.print(options);
        return 0;
    }
    return usage();
}
