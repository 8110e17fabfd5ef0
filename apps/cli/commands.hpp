// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The commands of `noli`, as functions of their arguments; each returns the exit code.

#include <optional>
#include <string>
#include <vector>

namespace noli::cli {

struct RunArguments {
    std::string scene;      ///< file, or a run directory
    std::string directory;  ///< empty = runs/<name of the scene file>
    int steps = -1;
    int threads = 0;
    std::string device = "auto";
    bool resume = false, overwrite = false, verify = false, iteration_log = false,
         quiet = false;
    std::optional<int> frames_every;
    std::vector<std::string> formats;
    std::optional<int> checkpoint_every;
    std::optional<double> checkpoint_seconds;
    std::string linear, contact_hessian, mollifier,
        integrator;  ///< empty = as the scene says
    std::optional<double> tolerance, pcg_tolerance, dt, duration;
    std::optional<int> max_newton, friction_iterations;
};
int run_command(const RunArguments& arguments);

struct CheckArguments {
    std::string scene;
    std::string mark_folder;  ///< for the mesh with coloured intersections; empty = here
};
int check_command(const CheckArguments& arguments);

int info_command(const std::vector<std::string>& paths);

struct ConvertArguments {
    std::string from, to;
    bool overwrite = false;
};
int convert_command(const ConvertArguments& arguments);

}  // namespace noli::cli
