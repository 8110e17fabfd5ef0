// SPDX-License-Identifier: Apache-2.0
#include "sim/run_output.hpp"

#include "output/hash.hpp"
#include "output/stats.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <utility>

namespace noli {

namespace fs = std::filesystem;

namespace {

/// Where the collection, which lies in the run directory, finds a frame.
std::string in_collection(const std::string& frame_name) {
    return "frames/" + frame_name;
}

std::string log_line(const StepReport& r) {
    std::string line = fmt::format(
        "step {}  t {:.6g} s  {}  wall {:.3f} s  newton {}  pcg {}  contacts {}  min gap "
        "{:.4g} m"
        "  kappa {:.4g}  memory {:.0f} MB",
        r.step,
        r.time,
        to_string(r.outcome),
        r.wall_s,
        r.newton,
        r.pcg,
        r.contacts,
        r.min_gap,
        r.kappa,
        r.peak_mb);
    if (!r.message.empty()) line += "  (" + r.message + ")";
    return line;
}

}  // namespace

RunOutput::RunOutput(RunPaths paths,
                     OutputSettings settings,
                     const Topology& topology,
                     std::vector<Vector3> initial_positions)
    : paths_(std::move(paths)),
      settings_(std::move(settings)),
      initial_positions_(std::move(initial_positions)),
      mesh_{topology.tets,
            topology.triangles,
            topology.segments,
            topology.body_of_vertex,
            topology.body_names,
            initial_positions_,
            topology.unreferenced} {
    vtu_ = std::make_unique<VtuWriter>(mesh_);
    if (has_format("obj") || has_format("ply"))
        surface_ = std::make_unique<SurfaceWriter>(mesh_);
}

bool RunOutput::has_format(std::string_view name) const {
    return std::find(settings_.formats.begin(), settings_.formats.end(), name)
        != settings_.formats.end();
}

bool RunOutput::is_frame_due(int step) const {
    return settings_.every > 0 && step % settings_.every == 0;
}

bool RunOutput::is_hash_due(int step, bool on_gpu) const {
    if (settings_.hash_every > 0) return step % settings_.hash_every == 0;
    return !on_gpu || is_frame_due(step);
}

Status RunOutput::open(int step, bool iteration_log) {
    for (const std::string& folder : {paths_.frames, paths_.checkpoints})
        if (Status made = make_folder(folder); !made) return made;
    for (const std::string& folder : {paths_.root, paths_.frames, paths_.checkpoints})
        remove_partial_files(folder);
    remove_checkpoints_after(paths_.checkpoints, step);
    if (Status trimmed = trim_stats(paths_.stats, step); !trimmed) return trimmed;
    if (Status trimmed = trim_iterations(paths_.iterations, step); !trimmed)
        return trimmed;
    if (Status trimmed = trim_frames(step); !trimmed) return trimmed;
    std::vector<std::pair<std::string, AppendFile*>> files{{paths_.stats, &stats_},
                                                           {paths_.log, &log_}};
    if (iteration_log) files.emplace_back(paths_.iterations, &iterations_);
    for (auto& [path, file] : files) {
        Result<AppendFile> opened = AppendFile::open(path);
        if (!opened) return opened.error();
        *file = std::move(opened.value());
    }
    return Done{};
}

/// Frames after `step` go; the collection is made anew of those that stay.
Status RunOutput::trim_frames(int step) {
    remove_frames_after(paths_.frames, step);
    Result<std::string> table = read_file(paths_.stats);
    if (!table) return table.error();
    std::vector<double> times{0.0};  // of steps 0, 1, ...
    for (const StatsEntry& row : parse_stats(table.value()))
        times.push_back(row.time);
    for (const std::string& name : list_folder(paths_.frames)) {
        const int frame_step = step_of_frame_file(name);
        if (name.ends_with(".vtu") && frame_step >= 0
            && static_cast<size_t>(frame_step) < times.size())
            collection_.push_back(
                {times[static_cast<size_t>(frame_step)], in_collection(name)});
    }
    if (collection_.empty()) return Done{};
    return write_file(paths_.collection, encode_pvd(collection_));
}

Status RunOutput::write_frame_file(const std::string& name, std::string_view bytes) {
    const std::string path = (fs::path(paths_.frames) / name).string();
    Status written = write_file(path, bytes);
    if (written) unsynced_.push_back(path);
    return written;
}

std::string RunOutput::encode_vtu(Simulator& simulator) const {
    const std::vector<Vector3> positions = simulator.positions();
    const std::vector<Vector3> velocities = simulator.velocities();
    const Fields fields = simulator.fields();
    Frame frame;
    frame.step = simulator.steps_done();
    frame.time = simulator.time();
    frame.positions = positions;
    frame.velocities = velocities;
    frame.contact_force = fields.contact_force;
    frame.von_mises = fields.von_mises;
    frame.stress = fields.stress;
    return vtu_->encode(frame);
}

Status RunOutput::write_frame(Simulator& simulator) {
    const int step = simulator.steps_done();
    if (has_format("vtu")) {
        const std::string name = frame_file_name(step, "vtu");
        Status written = write_frame_file(name, encode_vtu(simulator));
        if (!written) return written;
        collection_.push_back({simulator.time(), in_collection(name)});
        written = write_file(paths_.collection, encode_pvd(collection_));
        if (!written) return written;
    }
    if (!surface_) return Done{};
    const std::vector<Vector3> positions = simulator.positions();
    const std::vector<Vector3> velocities = simulator.velocities();
    Frame frame;
    frame.step = step;
    frame.time = simulator.time();
    frame.positions = positions;
    frame.velocities = velocities;
    Status written = Done{};
    if (has_format("obj"))
        written =
            write_frame_file(frame_file_name(step, "obj"), surface_->encode_obj(frame));
    if (written && has_format("ply"))
        written =
            write_frame_file(frame_file_name(step, "ply"), surface_->encode_ply(frame));
    return written;
}

Status RunOutput::write_step(const StepReport& report,
                             std::optional<std::uint64_t> state_hash) {
    Status written =
        stats_.append(stats_row(report, to_string(report.outcome), state_hash));
    if (written) written = iterations_.append(iteration_lines(report));
    if (written) written = log(log_line(report));
    return written;
}

Result<std::uint64_t> RunOutput::write_checkpoint(const Simulator& simulator,
                                                  std::uint64_t fingerprint) {
    for (const std::string& path : unsynced_)
        if (Status synced = sync_file(path); !synced) return synced.error();
    unsynced_.clear();
    Status synced = stats_.sync();
    if (synced) synced = iterations_.sync();
    if (!synced) return synced.error();
    Checkpoint checkpoint;
    checkpoint.fingerprint = fingerprint;
    checkpoint.step = simulator.steps_done();
    checkpoint.time = simulator.time();
    checkpoint.payload = simulator.save();
    checkpoint.state_hash = hash_bytes(std::span<const std::byte>(checkpoint.payload));
    Status written = noli::write_checkpoint(paths_.checkpoints, checkpoint);
    if (!written) return written.error();
    return checkpoint.state_hash;
}

Status RunOutput::log(std::string_view text) {
    const std::time_t now = std::time(nullptr);
    return log_.append(fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {}\n", fmt::gmtime(now), text));
}

}  // namespace noli
