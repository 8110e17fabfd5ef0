// SPDX-License-Identifier: Apache-2.0
/// The command line: what it offers, and what it says to a command line that it does not
/// understand.

#include "noli/scene.hpp"
#include "noli/simulator.hpp"

#include "commands.hpp"
#include "suggest.hpp"
#include "terminal.hpp"

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace noli::cli {

namespace {

constexpr const char* kFooter = R"(Exit codes:
  0  fine
  1  a bug, or the system failed (disk full, no permission to write)
  2  your input: command line, scene, mesh, directory, device
  3  the numbers gave up: a step did not converge; a repro bundle is written
  130, 143  a run stopped by Ctrl-C or SIGTERM, after writing a checkpoint

`noli COMMAND --help` explains a command.)";

constexpr const char* kRunFooter = R"(Examples:
  noli run scenes/drop.json                  run all of it into runs/drop
  noli run drop.json -o out --steps 20       the first 20 steps into out
  noli run out --resume                      go on with the run in out
  noli run x.txt --verify --threads 2        an IPC script, every step tested exactly
  noli run drop.json --format vtu,obj --frames-every 5

Ctrl-C (or SIGTERM) gives up the step within a Newton iteration, writes a checkpoint of the step
before and says how to go on; a second one stops at once. A run killed at any moment goes on from its last checkpoint, bit for bit.)";

void add_run_output_options(CLI::App& run, RunArguments& a) {
    const char* kGroup = "Output";
    run.add_option("-o,--output", a.directory, "Run directory [runs/<scene>]")
        ->group(kGroup);
    auto* resume = run.add_flag("--resume", a.resume, "Go on from the last checkpoint")
                       ->group(kGroup);
    run.add_flag("--overwrite", a.overwrite, "Start anew in a directory that holds a run")
        ->group(kGroup)
        ->excludes(resume);
    run.add_option("--frames-every", a.frames_every, "A frame every N steps; 0 = none")
        ->check(CLI::NonNegativeNumber)
        ->group(kGroup);
    run.add_option("--format", a.formats, "Frame formats, of vtu,obj,ply")
        ->delimiter(',')
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(CLI::IsMember({"vtu", "obj", "ply"}))
        ->group(kGroup);
    run.add_option("--checkpoint-every",
                   a.checkpoint_every,
                   "A checkpoint every N steps; 0 = by time only")
        ->check(CLI::NonNegativeNumber)
        ->group(kGroup);
    run.add_option("--checkpoint-seconds",
                   a.checkpoint_seconds,
                   "A checkpoint at least every S seconds [10]")
        ->check(CLI::PositiveNumber)
        ->group(kGroup);
    run.add_flag("--iteration-log",
                 a.iteration_log,
                 "Write iterations.jsonl, a line per Newton iteration")
        ->group(kGroup);
    run.add_flag("-q,--quiet", a.quiet, "Say nothing but warnings and errors")
        ->group(kGroup);
}

/// An option whose value is one of a few names.
CLI::Option* add_choice(CLI::App& run,
                        const std::string& option,
                        std::string& chosen,
                        const std::string& what,
                        const std::vector<std::string>& names) {
    const std::string but_last =
        fmt::format("{}", fmt::join(names.begin(), names.end() - 1, ", "));
    const std::string help = fmt::format("{}{} or {}", what, but_last, names.back());
    return run.add_option(option, chosen, help)->check(CLI::IsMember(names));
}

void add_run_scene_options(CLI::App& run, RunArguments& a) {
    const char* kGroup = "Instead of what the scene says";
    run.add_option("--dt", a.dt, "Time step, s")
        ->check(CLI::PositiveNumber)
        ->group(kGroup);
    run.add_option("--duration", a.duration, "Simulated time, s")
        ->check(CLI::PositiveNumber)
        ->group(kGroup);
    run.add_option(
           "--tolerance", a.tolerance, "Newton tolerance, in the scene's own measure")
        ->check(CLI::PositiveNumber)
        ->group(kGroup);
    run.add_option("--max-newton", a.max_newton, "Newton iterations per step, at most")
        ->check(CLI::PositiveNumber)
        ->group(kGroup);
    add_choice(run, "--integrator", a.integrator, "", value_names<Integrator>())
        ->group(kGroup);
    add_choice(run, "--linear", a.linear, "Linear solver: ", value_names<LinearSolver>())
        ->group(kGroup);
    run.add_option("--pcg-tolerance",
                   a.pcg_tolerance,
                   "Of the preconditioned residual, relative [automatic]")
        ->check(CLI::PositiveNumber)
        ->group(kGroup);
    // Not all: a scene may ask for "numeric" too, which is for comparison.
    add_choice(run, "--contact-hessian", a.contact_hessian, "", {"gn", "gn+", "exact"})
        ->group(kGroup);
    add_choice(run, "--mollifier", a.mollifier, "", value_names<MollifierModel>())
        ->group(kGroup);
    run.add_option("--friction-iterations",
                   a.friction_iterations,
                   "Friction updates per step; 0 = until convergence, -1 = as needed")
        ->check(CLI::Range(kFrictionAsNeeded, 1'000'000))
        ->group(kGroup);
}

void add_run(CLI::App& app, RunArguments& a) {
    CLI::App* run = app.add_subcommand("run", "Simulate a scene into a run directory");
    run->footer(kRunFooter);
    run->option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    run->add_option("SCENE", a.scene, "Scene (.json), IPC script (.txt) or run directory")
        ->required();
    run->add_option("--steps", a.steps, "Stop after step N [all of the scene]")
        ->check(CLI::NonNegativeNumber);
    run->add_option("--threads", a.threads, "CPU threads; 0 = all cores")
        ->check(CLI::Range(0, 4096));
    run->add_option("--device", a.device, "auto, cpu or cuda [auto]")
        ->check(CLI::IsMember({"auto", "cpu", "cuda"}));
    run->add_flag(
        "--verify", a.verify, "Exact intersection and inversion test after every step");
    add_run_output_options(*run, a);
    add_run_scene_options(*run, a);
}

/// Names of the options of a command, with dashes.
std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    return names;
}

std::string did_you_mean(const std::string& word,
                         const std::vector<std::string>& candidates) {
    const std::string best = nearest(word, candidates);
    return best.empty() ? "" : fmt::format("; did you mean {}?", best);
}

/// The first word that no command took, if it looks like an option; else "".
std::string unknown_option(const CLI::App& command) {
    for (const std::string& word : command.remaining())
        if (word.size() > 1 && word[0] == '-') return word.substr(0, word.find('='));
    return "";
}

/// The sentence about a command line that could not be parsed.
int reject(const CLI::App& app,
           const CLI::ParseError& problem,
           const std::vector<std::string>& words) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const CLI::App& command = chosen.empty() ? app : *chosen.front();
    const std::string name = chosen.empty() ? "noli" : "noli " + command.get_name();
    const std::string option = unknown_option(command);
    std::string message;
    if (!option.empty()) {
        message = fmt::format(
            "unknown option {}{}", option, did_you_mean(option, option_names(command)));
    } else if (chosen.empty() && !words.empty() && words[0][0] != '-') {
        std::vector<std::string> names;
        for (const CLI::App* sub : app.get_subcommands({}))
            names.push_back(sub->get_name());
        message =
            fmt::format("unknown command {}{}", words[0], did_you_mean(words[0], names));
    } else {
        message = problem.what();
    }
    print_error(name, fmt::format("{} (see {} --help)", message, name));
    return kYourInput;
}

/// What all commands take.
struct Arguments {
    RunArguments run;
    CheckArguments check;
    std::vector<std::string> paths;
    ConvertArguments convert;
};

void add_other_commands(CLI::App& app, Arguments& a) {
    CLI::App* check = app.add_subcommand(
        "check", "Say everything that is wrong before the first frame");
    check->add_option("SCENE", a.check.scene, "Scene (.json) or IPC script (.txt)")
        ->required();
    check->add_option("-o,--output",
                      a.check.mark_folder,
                      "Folder for the mesh that marks intersections [.]");
    check->footer("Example:\n  noli check scenes/drop.json");

    CLI::App* info = app.add_subcommand("info", "Describe a mesh, a scene or a run");
    info->add_option("PATH", a.paths, "Mesh or scene files, run directories")->required();
    info->footer("Examples:\n  noli info bunny.msh\n  noli info runs/drop");

    CLI::App* convert =
        app.add_subcommand("convert", "IPC script to native scene, or mesh to mesh");
    convert->add_option("IN", a.convert.from, "IPC script, scene or mesh")->required();
    convert
        ->add_option("-o,--output", a.convert.to, "Result; its extension says the format")
        ->required();
    convert->add_flag("--overwrite", a.convert.overwrite, "Replace a file that is there");
    convert->footer(
        "Examples:\n  noli convert x.txt -o x.json\n  noli convert bunny.mesh -o "
        "bunny.msh");
}

int run_program(const std::vector<std::string>& words) {
    CLI::App app("noli: elastic bodies in contact, never intersecting", "noli");
    app.set_version_flag("--version", std::string("noli ") + kVersion);
    app.require_subcommand(1);
    app.footer(kFooter);
    Arguments arguments;
    add_run(app, arguments.run);
    add_other_commands(app, arguments);
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& problem) {
        return reject(app, problem, words);
    }
    if (app.got_subcommand("run")) return run_command(arguments.run);
    if (app.got_subcommand("check")) return check_command(arguments.check);
    if (app.got_subcommand("info")) return info_command(arguments.paths);
    return convert_command(arguments.convert);
}

}  // namespace

}  // namespace noli::cli

int main(int argc, char** argv) {
    using namespace noli::cli;
    // A reader that goes away must not end a long run; a file-size limit is an error like
    // others.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        return finish_printing(run_program({argv + 1, argv + argc}));
    } catch (const std::bad_alloc&) {
        print_error("memory", "not enough; use a coarser mesh or a larger machine");
    } catch (const std::exception& bug) {
        print_error(
            "bug", fmt::format("{}; please report it with the command line", bug.what()));
    }
    return kFailure;
}
