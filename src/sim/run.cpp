// SPDX-License-Identifier: Apache-2.0
/// run_scene: a scene, a directory and a simulator, from the first step or the last
/// checkpoint to the end, a stop request, a step that fails, or a disk that is full.

#include "noli/simulator.hpp"

#include "output/run_folder.hpp"
#include "output/stats.hpp"
#include "sim/run_checks.hpp"
#include "sim/run_output.hpp"
#include "sim/run_repro.hpp"
#include "sim/run_scene_files.hpp"

#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <utility>

namespace noli {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One run. Members in the order in which `start` fills them.
class Run {
  public:
    Run(const Scene& scene, const RunOptions& options)
        : scene_(scene), options_(options), paths_(options.directory) {}

    Status start();
    Result<RunSummary> finish();

  private:
    Status admit_start();
    Status take_directory();
    Status find_checkpoint();
    Status restore();
    Status open_output();
    Status advance();
    Status fail(const StepReport& report);
    Status give_up(const StepReport& report);
    Status save_checkpoint();
    Status write_record(const char* status);
    [[nodiscard]] bool is_checkpoint_due() const;
    [[nodiscard]] bool is_stopped() const {
        return options_.stop && options_.stop->load();
    }
    [[nodiscard]] bool is_done() const {
        return is_complete_ || simulator_->steps_done() >= steps_asked_;
    }
    void note(const std::string& text);

    const Scene& scene_;
    const RunOptions& options_;
    RunPaths paths_;
    Clock::time_point started_ = Clock::now();
    int steps_asked_ = 0;
    std::unique_ptr<Simulator> simulator_;
    FolderLock lock_;
    RunRecord record_;
    FoundCheckpoint checkpoint_;
    bool is_complete_ = false;  ///< the checkpoint is at or past the last step asked for
    std::vector<std::string> notes_;
    std::unique_ptr<RunOutput> output_;
    bool is_cancelled_ = false;  ///< in the middle of a step
    Clock::time_point checkpointed_ = Clock::now();
    int checkpointed_step_ = 0;
    double carried_output_s_ = 0.0;  ///< of the checkpoint after the last row
    RunSummary summary_;
};

Status Run::start() {
    if (Status fine = check_request(scene_, options_); !fine) return fine;
    if (Status fine = admit_directory(options_); !fine) return fine;
    steps_asked_ = options_.steps >= 0 ? options_.steps : scene_.num_steps();
    SimulatorOptions simulator_options = options_.simulator;
    simulator_options.record_iterations |= options_.iteration_log;
    Result<Simulator> created = Simulator::create(scene_, simulator_options);
    if (!created) return created.error();
    simulator_ = std::make_unique<Simulator>(std::move(created.value()));
    for (const SceneWarning& warning : simulator_->resolved().warnings)
        note("warning: " + warning.where + ": " + warning.message);

    Result<std::uint64_t> fingerprint = scene_fingerprint(scene_);
    if (!fingerprint) return fingerprint.error();
    record_.fingerprint = fingerprint.value();
    if (options_.resume)
        if (Status found = find_checkpoint(); !found) return found;
    if (!checkpoint_.found) {
        const VerifyReport initial = simulator_->verify();
        if (initial.num_intersections > 0 || initial.num_inversions > 0)
            return initial_contact(scene_, initial);
        if (Status fine = admit_start(); !fine) return fine;
    }
    if (Status taken = take_directory(); !taken) return taken;
    return open_output();
}

/// What `noli check` calls an error keeps the run from starting; its warnings are said
/// and logged.
Status Run::admit_start() {
    std::vector<Finding> warnings;
    for (const Finding& finding : simulator_->findings()) {
        if (finding.severity == Finding::Severity::Error)
            return Error{Error::Code::InitialContact, finding.where, finding.message};
        if (finding.severity != Finding::Severity::Warning) continue;
        warnings.push_back(finding);
        notes_.push_back("warning: " + finding.where + ": " + finding.message);
    }
    if (options_.on_warnings && !warnings.empty()) options_.on_warnings(warnings);
    return Done{};
}

/// On a resume: is this a run of the same scene, and where does it stand?
Status Run::find_checkpoint() {
    if (inspect_folder(paths_.root) != FolderState::Run) {
        note("nothing to resume in " + paths_.root + ": starting at step 0");
        return Done{};
    }
    Result<std::string> text = read_file(paths_.record);
    if (!text) return text.error();
    Result<RunRecord> old = decode_run_record(text.value(), paths_.record);
    if (!old) return old.error();
    if (old.value().fingerprint != record_.fingerprint)
        return wrong_directory(
            paths_.root,
            fmt::format(
                "holds a run of another scene ({}, {} steps done) or of an older version "
                "of this one; resume with its own scene.json, start anew with "
                "--overwrite, or choose another directory with -o",
                old.value().scene_name.empty() ? "unnamed" : old.value().scene_name,
                old.value().steps_done));
    checkpoint_ = load_newest_checkpoint(paths_.checkpoints, record_.fingerprint);
    for (const std::string& skipped : checkpoint_.skipped)
        note("skipped a checkpoint: " + skipped);
    if (!checkpoint_.found && !checkpoint_.skipped.empty())
        return Error{Error::Code::BadCheckpoint,
                     paths_.checkpoints,
                     "no checkpoint is whole; start anew with --overwrite"};
    if (!checkpoint_.found) {
        note("no checkpoint yet in " + paths_.root + ": starting at step 0");
        return Done{};
    }
    is_complete_ = checkpoint_.checkpoint.step >= steps_asked_;
    note(fmt::format(
        "resuming after step {} ({})", checkpoint_.checkpoint.step, checkpoint_.path));
    return Done{};
}

/// Creates or clears the directory and keeps other processes out of it.
Status Run::take_directory() {
    if (Status made = make_folder(paths_.root); !made) return made;
    if (lock_.acquire(paths_.root) == FolderLock::Held::ByAnother)
        return wrong_directory(paths_.root,
                               "another noli run is writing here; wait for it or choose "
                               "another directory with -o");
    // Looked at again under the lock: another run may have come and gone since.
    if (Status fine = admit_directory(options_); !fine) return fine;
    if (options_.overwrite) return clear_run_folder(paths_.root);
    return Done{};
}

Status Run::restore() {
    const Checkpoint& from = checkpoint_.checkpoint;
    if (Status restored = simulator_->restore(from.payload); !restored) {
        Error error = restored.error();
        error.where = checkpoint_.path + (error.where.empty() ? "" : ": " + error.where);
        return error;
    }
    if (simulator_->steps_done() != from.step
        || simulator_->state_hash() != from.state_hash)
        return Error{
            Error::Code::BadCheckpoint,
            checkpoint_.path,
            "the restored state is not the one that was saved; use the version of noli "
            "that wrote it, or start anew with --overwrite"};
    checkpointed_step_ = from.step;
    checkpoint_.checkpoint.payload = {};
    return Done{};
}

Status Run::open_output() {
    const Resolved& resolved = simulator_->resolved();
    const Topology topology = simulator_->topology();
    record_.program = std::string("noli ") + kVersion;
    record_.scene_name = scene_.name;
    record_.steps_asked = steps_asked_;
    record_.dt = scene_.dt;
    record_.diagonal = resolved.diagonal;
    record_.dhat = resolved.dhat;
    record_.epsv = resolved.epsv;
    record_.tolerance = resolved.tolerance;
    record_.num_vertices = resolved.num_vertices;
    record_.num_tets = resolved.num_tets;
    record_.device = resolved.device;
    record_.bodies.assign(topology.body_names.begin(), topology.body_names.end());
    output_ = std::make_unique<RunOutput>(
        paths_, scene_.output, topology, simulator_->positions());
    if (checkpoint_.found)
        if (Status restored = restore(); !restored) return restored;
    record_.steps_done = simulator_->steps_done();
    record_.state_hash = simulator_->state_hash();
    if (is_complete_) return Done{};  // nothing is left to do, so nothing is changed

    // run.json first: a directory that has it is a run, whatever else is missing.
    if (Status written = write_record("running"); !written) return written;
    Status written = write_file(paths_.scene, scene_to_json(with_absolute_files(scene_)));
    if (written)
        written = output_->open(simulator_->steps_done(), options_.iteration_log);
    if (written)
        written = output_->log(
            fmt::format("{} on {}; dhat {:.6g} m, {} vertices, {} tetrahedra",
                        record_.program,
                        resolved.device,
                        resolved.dhat,
                        resolved.num_vertices,
                        resolved.num_tets));
    for (const std::string& text : notes_)
        if (written) written = output_->log(text);
    if (written && !checkpoint_.found && output_->is_frame_due(0))
        written = output_->write_frame(*simulator_);
    checkpointed_ = Clock::now();
    return written;
}

bool Run::is_checkpoint_due() const {
    const OutputSettings& settings = scene_.output;
    const int since = simulator_->steps_done() - checkpointed_step_;
    if (settings.checkpoint_steps > 0 && since >= settings.checkpoint_steps) return true;
    return settings.checkpoint_seconds > 0.0
        && seconds_since(checkpointed_) >= settings.checkpoint_seconds;
}

Status Run::save_checkpoint() {
    const Clock::time_point start = Clock::now();
    const Result<std::uint64_t> hash =
        output_->write_checkpoint(*simulator_, record_.fingerprint);
    if (!hash) return hash.error();
    record_.steps_done = simulator_->steps_done();
    record_.state_hash = hash.value();
    Status written = write_record("running");
    checkpointed_ = Clock::now();
    checkpointed_step_ = simulator_->steps_done();
    carried_output_s_ = seconds_since(start);
    return written;
}

Status Run::write_record(const char* status) {
    record_.status = status;
    record_.outcome = to_string(summary_.outcome);
    record_.message = summary_.message;
    return write_file(paths_.record, encode_run_record(record_), Durability::Synced);
}

/// One step and everything that is written about it.
Status Run::advance() {
    StepReport report = simulator_->step(options_.stop);
    if (report.outcome == Outcome::Cancelled) return give_up(report);
    const bool failed = report.outcome != Outcome::Converged;
    summary_.outcome = report.outcome;
    summary_.message = report.message;
    const auto widen = [](double& largest, double of_step) {
        largest = std::max(largest, of_step);
    };
    widen(summary_.direction_ratio, report.direction_ratio);
    widen(summary_.gap_change, report.gap_change);
    widen(summary_.lag_change, report.lag_change);
    const Clock::time_point start = Clock::now();
    if (!failed && output_->is_frame_due(report.step))
        if (Status written = output_->write_frame(*simulator_); !written) return written;
    report.t_output += std::exchange(carried_output_s_, 0.0) + seconds_since(start);
    std::optional<std::uint64_t> hash;
    if (output_->is_hash_due(report.step, simulator_->resolved().on_gpu))
        hash = simulator_->state_hash();
    if (!failed) {
        record_.steps_done = report.step;
        record_.state_hash = hash;
    }
    Status written = output_->write_step(report, hash);
    if (!written) return written;
    if (options_.on_step) options_.on_step(report);
    if (failed) return fail(report);
    if (is_checkpoint_due()) return save_checkpoint();
    return Done{};
}

/// Writes the repro bundle of a step that did not converge. A device that failed has left
/// the state before the step: a checkpoint of it first.
Status Run::fail(const StepReport& report) {
    if (report.outcome == Outcome::DeviceFailed
        && simulator_->steps_done() > checkpointed_step_)
        if (Status saved = save_checkpoint(); !saved) return saved;
    const Repro repro{
        scene_, options_, paths_, record_, report, output_->encode_vtu(*simulator_)};
    Result<std::string> folder = write_repro(repro);
    if (folder)
        summary_.repro_folder = folder.value();
    else
        note("no repro bundle: " + folder.error().where + ": " + folder.error().message);
    return output_->log(folder ? "repro bundle: " + folder.value() : notes_.back());
}

/// A step that was cancelled leaves nothing but a line in the log: the run stands where
/// it stood before it.
Status Run::give_up(const StepReport& report) {
    is_cancelled_ = true;
    return output_->log(fmt::format("step {} {}", report.step, report.message));
}

Result<RunSummary> Run::finish() {
    if (options_.on_start)
        options_.on_start(
            simulator_->resolved(), simulator_->steps_done() + 1, steps_asked_);
    Status status = Done{};
    const bool has_work = !is_done();
    while (status && !is_done() && !is_stopped() && !is_cancelled_
           && summary_.outcome == Outcome::Converged)
        status = advance();
    const bool converged = summary_.outcome == Outcome::Converged;
    summary_.interrupted = converged && !is_done();
    if (status && converged && simulator_->steps_done() > checkpointed_step_)
        status = save_checkpoint();
    const char* end = !status || !converged ? "failed"
                    : summary_.interrupted  ? "interrupted"
                                            : "finished";
    if (status && (has_work || !is_complete_)) {
        status = write_record(end);
        if (status) status = output_->log(end);
    }
    if (!status) {
        // The record may be all that still fits on the disk; the error is what counts.
        summary_.message = status.error().where + ": " + status.error().message;
        static_cast<void>(write_record("failed"));
        return status.error();
    }
    summary_.steps_done = record_.steps_done;
    summary_.steps_asked = steps_asked_;
    summary_.time = simulator_->time();
    summary_.state_hash = record_.state_hash.value_or(0);
    summary_.wall_s = seconds_since(started_);
    return summary_;
}

void Run::note(const std::string& text) {
    notes_.push_back(text);
    if (options_.on_note) options_.on_note(text);
}

}  // namespace

Result<RunSummary> run_scene(const Scene& scene, const RunOptions& options) {
    Run run(scene, options);
    if (Status started = run.start(); !started) return started.error();
    return run.finish();
}

}  // namespace noli
