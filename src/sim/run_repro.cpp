// SPDX-License-Identifier: Apache-2.0
#include "sim/run_repro.hpp"

#include "output/checkpoint.hpp"
#include "output/file.hpp"
#include "output/stats.hpp"
#include "sim/run_scene_files.hpp"

#include <filesystem>
#include <fmt/format.h>

namespace noli {

namespace fs = std::filesystem;

namespace {

Status copy_file(const std::string& from, const fs::path& to) {
    std::error_code failed;
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, failed);
    if (failed) return io_error("copy " + from + " to", to.string(), failed.value());
    return Done{};
}

/// Copies the mesh files to meshes/<k>/, since two of them may have the same name.
Status copy_scene(const Scene& scene, const fs::path& folder) {
    Scene moved = scene;
    Status status = Done{};
    int k = 0;
    for_each_file(moved, [&](std::string& file) {
        const fs::path place = fs::path("meshes") / std::to_string(k++);
        if (status) status = make_folder((folder / place).string());
        for (const std::string& part : companion_files(absolute_file(scene, file)))
            if (status)
                status = copy_file(part, folder / place / fs::path(part).filename());
        file = (place / fs::path(file).filename()).string();
    });
    moved.base_folder.clear();
    if (!status) return status;
    return write_file((folder / "scene.json").string(), scene_to_json(moved));
}

/// A run directory at the newest checkpoint; false if there is none.
Result<bool> copy_run(const Repro& repro, const fs::path& folder) {
    const FoundCheckpoint found =
        load_newest_checkpoint(repro.paths.checkpoints, repro.record.fingerprint);
    if (!found.found) return false;
    const RunPaths to((folder / "run").string());
    if (Status made = make_folder(to.checkpoints); !made) return made.error();
    Status copied =
        copy_file(found.path, fs::path(to.checkpoints) / fs::path(found.path).filename());
    if (copied) copied = copy_file(repro.paths.stats, to.stats);
    if (copied) copied = trim_stats(to.stats, found.checkpoint.step);
    RunRecord record = repro.record;
    record.status = "interrupted";
    record.outcome = to_string(Outcome::Converged);
    record.message.clear();
    record.steps_done = found.checkpoint.step;
    record.state_hash = found.checkpoint.state_hash;
    if (copied) copied = write_file(to.record, encode_run_record(record));
    if (!copied) return copied.error();
    return true;
}

Status fill_bundle(const Repro& repro, const fs::path& folder) {
    if (Status made = make_folder(folder.string()); !made) return made;
    if (Status copied = copy_scene(repro.scene, folder); !copied) return copied;
    const Result<bool> has_checkpoint = copy_run(repro, folder);
    if (!has_checkpoint) return has_checkpoint.error();
    Status written =
        write_file((folder / "report.json").string(),
                   report_json(repro.report, to_string(repro.report.outcome)));
    if (written && !repro.failed_state.empty())
        written = write_file((folder / "failed_state.vtu").string(), repro.failed_state);
    if (!written) return written;
    const std::string command =
        repro_command(repro.options.simulator, repro.report.step, has_checkpoint.value());
    return write_file(
        (folder / "repeat.sh").string(),
        fmt::format("#!/bin/sh\n# Repeats step {} of a run of {} that ended with "
                    "{}.\ncd \"$(dirname \"$0\")\" && exec {}\n",
                    repro.report.step,
                    repro.record.program,
                    to_string(repro.report.outcome),
                    command));
}

}  // namespace

std::string repro_command(const SimulatorOptions& options,
                          int step,
                          bool has_checkpoint) {
    std::string command =
        fmt::format("noli run scene.json -o run {} --steps {} --iteration-log",
                    has_checkpoint ? "--resume" : "--overwrite",
                    step);
    if (options.threads > 0) command += fmt::format(" --threads {}", options.threads);
    if (options.device == Device::Cpu) command += " --device cpu";
    if (options.device == Device::Cuda) command += " --device cuda";
    if (options.verify) command += " --verify";
    return command;
}

Result<std::string> write_repro(const Repro& repro) {
    const fs::path folder =
        fs::path(repro.paths.root) / fmt::format("repro_step_{:06}", repro.report.step);
    const fs::path part(folder.string() + std::string(kPartSuffix));
    std::error_code failed;
    fs::remove_all(part, failed);
    if (Status filled = fill_bundle(repro, part); !filled) {
        fs::remove_all(part, failed);
        return filled.error();
    }
    fs::remove_all(folder, failed);
    fs::rename(part, folder, failed);
    if (failed) return io_error("create the folder", folder.string(), failed.value());
    return folder.string();
}

}  // namespace noli
