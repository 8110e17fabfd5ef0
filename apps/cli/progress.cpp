// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include "terminal.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace noli::cli {

std::string format_duration(double seconds) {
    if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<long>(std::lround(seconds));
    const long hours = whole / 3600;
    const long minutes = whole / 60 % 60;
    if (hours == 0) return fmt::format("{}:{:02}", minutes, whole % 60);
    return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
}

std::string format_step(const StepReport& r, int last_step) {
    const std::string total = std::to_string(last_step);
    std::string line = fmt::format(
        "step {:>{}}/{}  t {:.4f} s  wall {:.3f} s  newton {}  pcg {}  contacts {}",
        r.step,
        total.size(),
        total,
        r.time,
        r.wall_s,
        r.newton,
        r.pcg,
        r.contacts);
    line +=
        std::isfinite(r.min_gap) ? fmt::format("  gap {:.3e} m", r.min_gap) : "  gap -";
    line += fmt::format("  kappa {:.2e}  mem {:.0f} MB", r.kappa, r.peak_mb);
    if (r.intersections >= 0)
        line += fmt::format(
            "  intersections {}  inversions {}", r.intersections, r.inversions);
    if (r.outcome != Outcome::Converged)
        line += fmt::format("  {}", to_string(r.outcome));
    return line;
}

Progress::Progress(bool is_quiet, int frames_every)
    : is_quiet_(is_quiet),
      has_bar_(!is_quiet && is_terminal(stdout)),
      frames_every_(frames_every) {}

void Progress::start(int first_step, int last_step) {
    first_step_ = first_step;
    last_step_ = last_step;
    previous_ = std::chrono::steady_clock::now();
    if (has_bar_ && first_step <= last_step) draw_bar(first_step - 1);
}

void Progress::step(const StepReport& report) {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - previous_).count();
    previous_ = now;
    step_seconds_ = step_seconds_ > 0.0 ? 0.8 * step_seconds_ + 0.2 * seconds : seconds;
    if (is_quiet_) return;
    const bool converged = report.outcome == Outcome::Converged;
    const bool has_frame = frames_every_ <= 0 || report.step % frames_every_ == 0;
    if (has_frame || !converged || report.step == last_step_) {
        const std::string line = format_step(report, last_step_);
        print((has_bar_ ? "\r\033[K" : "")
              + paint(stdout, converged ? Colour::Plain : Colour::Red, line) + "\n");
    }
    if (has_bar_) draw_bar(report.step);
}

void Progress::draw_bar(int step) {
    const int total = std::max(last_step_, 1);
    const std::string after = fmt::format(
        " {}/{}  {}%  {}/step  ETA {}",
        step,
        last_step_,
        100 * step / total,
        step_seconds_ > 0.0 ? fmt::format("{:.3g} s", step_seconds_) : "- s",
        step_seconds_ > 0.0 ? format_duration(step_seconds_ * (last_step_ - step)) : "-");
    const int room = terminal_width() - static_cast<int>(after.size()) - 3;
    const int width = std::clamp(room, 0, 40);
    const int full = width * step / total;
    const std::string bar =
        width > 3 ? fmt::format("[{}{}]",
                                std::string(static_cast<size_t>(full), '#'),
                                std::string(static_cast<size_t>(width - full), '.'))
                  : "";
    print("\r\033[K" + paint(stdout, Colour::Green, bar) + after);
}

void Progress::finish() {
    if (has_bar_) print("\r\033[K");
}

}  // namespace noli::cli
