// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The repro bundle: a folder with everything that repeats a failed step, on any machine.
///
///     repro_step_000123/
///       scene.json, meshes/     the scene and copies of its mesh files
///       run/                    a run directory at the last checkpoint before the step
///       report.json             what the step said, with its iterations if they were
///       recorded failed_state.vtu        where it stopped repeat.sh               the
///       command

#include "noli/simulator.hpp"

#include "output/run_folder.hpp"

#include <string>
#include <string_view>

namespace noli {

struct Repro {
    const Scene& scene;
    const RunOptions& options;
    const RunPaths& paths;  ///< of the run that failed
    RunRecord record;       ///< of the run that failed
    const StepReport& report;
    std::string failed_state;  ///< text of a VTU file; empty = none
};

/// Writes the bundle into the run directory, all or nothing; its path.
Result<std::string> write_repro(const Repro& repro);

/// `noli run ...` of the bundle, to be started inside of it. `has_checkpoint`: run/ holds
/// one.
std::string repro_command(const SimulatorOptions& options, int step, bool has_checkpoint);

}  // namespace noli
