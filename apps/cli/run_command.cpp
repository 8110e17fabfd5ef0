// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "commands.hpp"
#include "progress.hpp"
#include "terminal.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fmt/format.h>
#include <string_view>
#include <unistd.h>

namespace noli::cli {

namespace fs = std::filesystem;

namespace {

std::atomic<bool> stop_requested{false};
std::atomic<int> stop_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free);

/// First signal: give the step up, write a checkpoint of the one before, say how to
/// resume. Second: stop at once.
extern "C" void on_stop_signal(int number) {
    if (stop_requested.exchange(true)) ::_exit(kSignalled + number);
    stop_signal = number;
    constexpr std::string_view kText =
        "\nnote: stopping in this step and writing a checkpoint of the one before; once "
        "more to stop at once\n";
    static_cast<void>(!::write(STDERR_FILENO, kText.data(), kText.size()));
}

void catch_signals() {
    struct sigaction action {};
    action.sa_handler = on_stop_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

/// Where the scene is and where the run goes, once a run directory given as scene is
/// resolved.
struct Places {
    std::string scene, directory;
};

Places find_places(const RunArguments& arguments) {
    const fs::path given(arguments.scene);
    std::error_code failed;
    const bool is_run =
        fs::is_directory(given, failed) && fs::exists(given / "run.json", failed);
    if (!is_run) {
        const std::string fallback = (fs::path("runs") / given.stem()).string();
        return {arguments.scene,
                arguments.directory.empty() ? fallback : arguments.directory};
    }
    return {(given / "scene.json").string(),
            arguments.directory.empty() ? arguments.scene : arguments.directory};
}

template <class T>
void override_with(const std::optional<T>& value, T& setting) {
    if (value) setting = *value;
}

/// The same for a value given by its name; empty: as the scene says.
template <class E>
void override_by_name(const std::string& name, E& setting) {
    override_with(value_named<E>(name), setting);
}

/// What the command line says instead of the scene.
void apply_overrides(const RunArguments& a, Scene& scene) {
    override_with(a.frames_every, scene.output.every);
    override_with(a.checkpoint_every, scene.output.checkpoint_steps);
    override_with(a.checkpoint_seconds, scene.output.checkpoint_seconds);
    override_with(a.tolerance, scene.solver.tolerance);
    if (a.tolerance) scene.solver.tolerance_per_step.clear();
    override_with(a.pcg_tolerance, scene.solver.pcg_tolerance);
    override_with(a.max_newton, scene.solver.max_newton);
    override_with(a.dt, scene.dt);
    override_with(a.duration, scene.duration);
    override_with(a.friction_iterations, scene.contact.friction_iterations);
    if (!a.formats.empty()) scene.output.formats = a.formats;
    override_by_name(a.linear, scene.solver.linear);
    override_by_name(a.contact_hessian, scene.contact.hessian);
    override_by_name(a.mollifier, scene.contact.mollifier);
    override_by_name(a.integrator, scene.solver.integrator);
}

/// The first few; `noli check` has them all.
void print_warnings(const std::vector<Finding>& warnings, const std::string& scene) {
    constexpr std::size_t kSaid = 3;
    const std::size_t said = std::min(kSaid, warnings.size());
    for (std::size_t k = 0; k < said; ++k)
        print_warning(warnings[k].where, warnings[k].message);
    if (warnings.size() > said)
        print_warning(
            "scene",
            fmt::format(
                "{} more warnings: noli check {}", warnings.size() - said, scene));
}

void print_start(const Resolved& r, const std::string& directory, int first, int last) {
    const std::string why = r.device_note.empty() ? "" : " (auto: " + r.device_note + ")";
    print(fmt::format(
        "{}{}\n{} bodies, {} vertices, {} tetrahedra, about {:.0f} MB\n"
        "dhat {:.4g} m, epsv {:.4g} m/s, tolerance {:.4g} m/s, diagonal {:.4g} m\n"
        "linear solver: {}\n",
        r.device,
        why,
        r.num_bodies,
        r.num_vertices,
        r.num_tets,
        r.estimated_mb,
        r.dhat,
        r.epsv,
        r.tolerance,
        r.diagonal,
        r.linear_solver));
    if (first <= last)
        print(fmt::format("steps {} to {} into {}\n", first, last, directory));
}

/// How far from their tolerances the steps ended, at most.
std::string describe_ends(const RunSummary& summary) {
    std::string text = fmt::format("steps ended within {:.2g} of the tolerance",
                                   summary.direction_ratio);
    if (summary.gap_change > 0.0)
        text += fmt::format(", gaps within {:.2g} %", 100.0 * summary.gap_change);
    if (summary.lag_change > 0.0)
        text +=
            fmt::format(", friction forces within {:.2g} %", 100.0 * summary.lag_change);
    return text;
}

/// Says how the run ended; the exit code.
int conclude(const RunSummary& summary, const std::string& directory, bool is_quiet) {
    if (summary.outcome != Outcome::Converged) {
        print_error(fmt::format("step {}", summary.steps_done + 1),
                    fmt::format("{}: {}", to_string(summary.outcome), summary.message));
        if (!summary.repro_folder.empty())
            print_note(
                fmt::format("everything to repeat this step is in {}; run its repeat.sh",
                            summary.repro_folder));
        return summary.outcome == Outcome::Intersecting ? kFailure : kNumbers;
    }
    const std::string went = fmt::format("{} of {} steps, {:.6g} s simulated, {} here",
                                         summary.steps_done,
                                         summary.steps_asked,
                                         summary.time,
                                         format_duration(summary.wall_s));
    if (summary.interrupted) {
        print_note(fmt::format(
            "stopped after {}; go on with: noli run {} --resume", went, directory));
        return kSignalled + stop_signal.load();
    }
    if (is_quiet) return kFine;
    print(fmt::format(
        "{} {}\n{}\nstate {:016x}\nresults in {} (frames.pvd opens in ParaView)\n",
        paint(stdout, Colour::Green, "done:"),
        went,
        describe_ends(summary),
        summary.state_hash,
        directory));
    return kFine;
}

}  // namespace

int run_command(const RunArguments& arguments) {
    const Places places = find_places(arguments);
    std::vector<SceneWarning> warnings;
    Result<Scene> read = read_scene(places.scene, &warnings);
    for (const SceneWarning& warning : warnings)
        print_warning(warning.where, warning.message);
    if (!read) return fail(read.error());
    Scene& scene = read.value();
    apply_overrides(arguments, scene);

    Progress progress(arguments.quiet, scene.output.every);
    RunOptions options;
    options.directory = places.directory;
    options.steps = arguments.steps;
    options.resume = arguments.resume;
    options.overwrite = arguments.overwrite;
    options.iteration_log = arguments.iteration_log;
    options.simulator.device = arguments.device == "cpu"  ? Device::Cpu
                             : arguments.device == "cuda" ? Device::Cuda
                                                          : Device::Auto;
    options.simulator.threads = arguments.threads;
    options.simulator.verify = arguments.verify;
    options.stop = &stop_requested;
    options.on_start = [&](const Resolved& resolved, int first, int last) {
        if (!arguments.quiet) print_start(resolved, places.directory, first, last);
        progress.start(first, last);
    };
    options.on_warnings = [&](const std::vector<Finding>& found) {
        print_warnings(found, places.scene);
    };
    options.on_step = [&](const StepReport& report) { progress.step(report); };
    options.on_note = [&](const std::string& text) {
        if (!arguments.quiet) print_note(text);
    };
    catch_signals();
    const Result<RunSummary> summary = run_scene(scene, options);
    progress.finish();
    if (!summary) return fail(summary.error());
    return conclude(summary.value(), places.directory, arguments.quiet);
}

}  // namespace noli::cli
