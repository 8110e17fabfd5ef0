// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The progress of a run: a line per frame, and on a terminal a bar with the time that is
/// left.

#include "noli/simulator.hpp"

#include <chrono>
#include <string>

namespace noli::cli {

/// "2.4 s", "3:05", "1:02:11".
std::string format_duration(double seconds);

/// One line about a step, without colours and newline.
std::string format_step(const StepReport& report, int last_step);

class Progress {
  public:
    /// `frames_every`: a line is printed for every step with a frame (all if 0).
    Progress(bool is_quiet, int frames_every);

    void start(int first_step, int last_step);
    void step(const StepReport& report);
    /// Takes the bar away.
    void finish();

  private:
    void draw_bar(int step);

    bool is_quiet_;
    bool has_bar_;
    int frames_every_;
    int first_step_ = 1;
    int last_step_ = 0;
    double step_seconds_ = 0.0;  ///< of a recent step, smoothed, output included
    std::chrono::steady_clock::time_point previous_;
};

}  // namespace noli::cli
