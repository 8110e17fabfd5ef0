// SPDX-License-Identifier: Apache-2.0
#pragma once
/// stats.csv (one row per step) and iterations.jsonl (one JSON object per Newton
/// iteration).

#include "noli/result.hpp"
#include "noli/simulator.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace noli {

/// Columns, in this order; times in seconds, min_gap and boundary_yield in metres, kappa
/// in J/m^4.
inline constexpr std::string_view kStatsHeader =
    "step,t,wall_s,newton,pcg,contacts,min_gap,kappa,intersections,inversions,outcome,"
    "t_pairs,t_assemble,t_solve,t_ccd,t_search,t_output,peak_mb,"
    "friction_updates,boundary_yield,state_hash,t_elastic,t_barrier,t_friction,threads,"
    "direction_ratio,gap_change,lag_change,net_force,net_torque\n";

/// A row of stats.csv, newline included. Quantities of the simulation have 17 digits, so
/// that equal runs give equal text. Without a hash its column is empty.
std::string stats_row(const StepReport& report,
                      std::string_view outcome,
                      std::optional<std::uint64_t> state_hash);

/// What a row says that a resume or a description needs.
struct StatsEntry {
    int step = 0;
    double time = 0.0, wall_s = 0.0;
    long newton = 0, pcg = 0, contacts = 0;
    double min_gap = 0.0;
    long intersections = -1, inversions = -1;
    std::string outcome;
    double peak_mb = 0.0;
    int threads = 0;
};

/// Whole rows of the text of a stats.csv. Stops at the first row that is not whole.
std::vector<StatsEntry> parse_stats(std::string_view text);

/// Cuts stats.csv back to its rows of steps 1..step, or creates it with its header.
/// BadCheckpoint if rows of those steps are missing.
Status trim_stats(const std::string& path, int step);

/// The iterations of a step as lines of JSON: step, iteration, energy, ...
/// (docs/frame-format.md).
std::string iteration_lines(const StepReport& report);

/// Cuts iterations.jsonl back to steps 1..step; fine if there is no such file.
Status trim_iterations(const std::string& path, int step);

/// A step report as a JSON document, iterations included.
std::string report_json(const StepReport& report, std::string_view outcome);

}  // namespace noli
