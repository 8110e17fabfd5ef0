// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The run directory (docs/frame-format.md): names of its files and the record run.json
/// that says what it is.

#include "noli/result.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace noli {

/// Version of the run directory; rises when an older program could misread it.
inline constexpr int kRunFormat = 1;

/// Paths of the files of a run directory.
struct RunPaths {
    explicit RunPaths(std::string root_folder);
    std::string root, record, scene, log, stats, iterations, frames, checkpoints,
        collection;
};

/// run.json: what a run is and how far it came.
struct RunRecord {
    int format = kRunFormat;
    std::string program;            ///< "noli 0.1.0"
    std::uint64_t fingerprint = 0;  ///< of the scene
    std::string scene_name;
    std::string status;   ///< "running", "finished", "interrupted" or "failed"
    std::string outcome;  ///< of the last step
    std::string message;
    int steps_done = 0;
    int steps_asked = 0;
    std::optional<std::uint64_t> state_hash;  ///< after steps_done, if known
    double dt = 0.0;                          ///< s
    double diagonal = 0.0, dhat = 0.0, epsv = 0.0, tolerance = 0.0;  ///< m, m, m/s, m/s
    int num_vertices = 0, num_tets = 0;
    std::string device;
    std::vector<std::string> bodies;  ///< names; body_id of the frames counts from 0
};

std::string encode_run_record(const RunRecord& record);
/// `where` is the path of the text. RunDirectory when it is not a record this program can
/// read.
Result<RunRecord> decode_run_record(const std::string& text, const std::string& where);

/// What stands at a path that shall become or is a run directory.
enum class FolderState { Missing, Empty, Run, Foreign };
FolderState inspect_folder(const std::string& path);

/// Removes what a run writes and nothing else; run.json last, so that an interrupted
/// removal can be repeated.
Status clear_run_folder(const std::string& root);

/// Removes frames of steps after `step`.
void remove_frames_after(const std::string& frames_folder, int step);

}  // namespace noli
