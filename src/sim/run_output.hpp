// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a run writes while it goes: frames, table, iterations, log, checkpoints, in an
/// order that makes every checkpoint on the disk one that can be resumed from: frames and
/// rows up to its step are on the disk before it gets its name.

#include "noli/simulator.hpp"

#include "output/checkpoint.hpp"
#include "output/file.hpp"
#include "output/frame.hpp"
#include "output/run_folder.hpp"
#include "output/surface.hpp"
#include "output/vtu.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace noli {

class RunOutput {
  public:
    /// `initial_positions` (m): what displacements count from.
    RunOutput(RunPaths paths,
              OutputSettings settings,
              const Topology& topology,
              std::vector<Vector3> initial_positions);

    /// Brings the files of the folder to the state after `step` (0: none yet) and opens
    /// them.
    Status open(int step, bool iteration_log);

    /// Writes the frame of the current state in every format asked for.
    Status write_frame(Simulator& simulator);
    [[nodiscard]] bool is_frame_due(int step) const;
    /// Whether the row of a step has the hash of the state.
    [[nodiscard]] bool is_hash_due(int step, bool on_gpu) const;

    /// The text of the current state as a VTU file.
    [[nodiscard]] std::string encode_vtu(Simulator& simulator) const;

    /// Appends the rows of a step to the table, the iteration log and the log.
    Status write_step(const StepReport& report, std::optional<std::uint64_t> state_hash);

    /// Writes a checkpoint of the current state; its hash.
    Result<std::uint64_t> write_checkpoint(const Simulator& simulator,
                                           std::uint64_t fingerprint);

    /// A line of log.txt, stamped with the time of day.
    Status log(std::string_view text);

    [[nodiscard]] const RunPaths& paths() const { return paths_; }

  private:
    [[nodiscard]] bool has_format(std::string_view name) const;
    Status write_frame_file(const std::string& name, std::string_view bytes);
    Status trim_frames(int step);

    RunPaths paths_;
    OutputSettings settings_;
    std::vector<Vector3> initial_positions_;
    FrameMesh mesh_;
    std::unique_ptr<VtuWriter> vtu_;
    std::unique_ptr<SurfaceWriter> surface_;
    std::vector<PvdEntry> collection_;
    std::vector<std::string> unsynced_;  ///< frames not yet pushed to the disk
    AppendFile stats_, iterations_, log_;
};

}  // namespace noli
