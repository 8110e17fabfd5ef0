// SPDX-License-Identifier: Apache-2.0
#include "output/stats.hpp"

#include "output/file.hpp"

#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>

namespace noli {

namespace {

/// Pieces of `line` between commas.
std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> fields;
    for (size_t comma = line.find(','); comma != std::string_view::npos;
         comma = line.find(',')) {
        fields.push_back(line.substr(0, comma));
        line.remove_prefix(comma + 1);
    }
    fields.push_back(line);
    return fields;
}

template <class T>
bool parse(std::string_view field, T& value) {
    const char* end = field.data() + field.size();
    const auto parsed = std::from_chars(field.data(), end, value);
    return parsed.ec == std::errc() && parsed.ptr == end;
}

bool parse_row(std::string_view line, StatsEntry& row) {
    const std::vector<std::string_view> f = split(line);
    if (f.size() != split(kStatsHeader).size()) return false;
    row.outcome = f[10];
    return parse(f[0], row.step) && parse(f[1], row.time) && parse(f[2], row.wall_s)
        && parse(f[3], row.newton) && parse(f[4], row.pcg) && parse(f[5], row.contacts)
        && parse(f[6], row.min_gap) && parse(f[8], row.intersections)
        && parse(f[9], row.inversions) && parse(f[17], row.peak_mb)
        && parse(f[24], row.threads);
}

nlohmann::ordered_json iteration_json(int step, const IterationRecord& it) {
    return {{"step", step},
            {"iteration", it.iteration},
            {"energy", it.energy},
            {"energy_after", it.energy_after},
            {"direction", it.direction},
            {"gradient", it.gradient},
            {"step_bound", it.step_bound},
            {"alpha", it.step},
            {"halvings", it.halvings},
            {"pcg", it.pcg},
            {"contacts", it.contacts},
            {"min_gap", it.min_gap},
            {"kappa", it.kappa},
            {"limiting", it.limiting},
            {"noise_accepted", it.noise_accepted},
            {"boundary_moved", it.boundary_moved}};
}

std::string dump(const nlohmann::ordered_json& json, int indent = -1) {
    using Handler = nlohmann::ordered_json::error_handler_t;
    return json.dump(indent, ' ', false, Handler::replace) + "\n";
}

/// The part of `text` made of whole lines that `keep` accepts, up to the first it does
/// not.
template <class Keep>
std::string_view leading_lines(std::string_view text, Keep keep) {
    size_t end = 0;
    for (size_t newline = text.find('\n'); newline != std::string_view::npos;
         newline = text.find('\n', end)) {
        if (!keep(text.substr(end, newline - end))) break;
        end = newline + 1;
    }
    return text.substr(0, end);
}

/// Replaces the file by `kept` unless it is that already.
Status rewrite(const std::string& path, std::string_view old, std::string_view kept) {
    if (old == kept) return Done{};
    return write_file(path, kept, Durability::Synced);
}

}  // namespace

std::string stats_row(const StepReport& r,
                      std::string_view outcome,
                      std::optional<std::uint64_t> state_hash) {
    return fmt::format(
        "{},{:.17g},{:.6g},{},{},{},{:.17g},{:.17g},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},"
        "{:.6g},{:.6g},{:.6g},{},{:.17g},{},{:.6g},{:.6g},{:.6g},{},{:.17g},{:.17g},"
        "{:.17g},{:.17g},{:.17g}\n",
        r.step,
        r.time,
        r.wall_s,
        r.newton,
        r.pcg,
        r.contacts,
        r.min_gap,
        r.kappa,
        r.intersections,
        r.inversions,
        outcome,
        r.t_pairs,
        r.t_assemble,
        r.t_solve,
        r.t_ccd,
        r.t_search,
        r.t_output,
        r.peak_mb,
        r.friction_updates,
        r.boundary_yield,
        state_hash ? fmt::format("{:016x}", *state_hash) : "",
        r.t_elastic,
        r.t_barrier,
        r.t_friction,
        r.threads,
        r.direction_ratio,
        r.gap_change,
        r.lag_change,
        r.net_force,
        r.net_torque);
}

std::vector<StatsEntry> parse_stats(std::string_view text) {
    std::vector<StatsEntry> rows;
    if (!text.starts_with(kStatsHeader)) return rows;
    leading_lines(text.substr(kStatsHeader.size()), [&rows](std::string_view line) {
        StatsEntry row;
        if (!parse_row(line, row)) return false;
        rows.push_back(std::move(row));
        return true;
    });
    return rows;
}

Status trim_stats(const std::string& path, int step) {
    const bool is_there = std::filesystem::exists(path);
    if (!is_there && step == 0) return write_file(path, kStatsHeader);
    Result<std::string> text = read_file(path);
    if (!text) return text.error();
    if (step == 0) return rewrite(path, text.value(), kStatsHeader);
    int last = 0;
    bool in_header = true;
    const auto keep = [&](std::string_view line) {
        if (in_header) {
            in_header = false;
            return line == kStatsHeader.substr(0, kStatsHeader.size() - 1);
        }
        StatsEntry row;
        if (!parse_row(line, row) || row.step != last + 1 || row.step > step)
            return false;
        last = row.step;
        return true;
    };
    const std::string_view kept = leading_lines(text.value(), keep);
    if (last != step)
        return Error{
            Error::Code::BadCheckpoint,
            path,
            fmt::format("has the rows of {} steps, the checkpoint needs {}; start "
                        "anew with --overwrite",
                        last,
                        step)};
    return rewrite(path, text.value(), kept);
}

std::string iteration_lines(const StepReport& report) {
    std::string out;
    for (const IterationRecord& iteration : report.iterations)
        out += dump(iteration_json(report.step, iteration));
    return out;
}

Status trim_iterations(const std::string& path, int step) {
    if (!std::filesystem::exists(path)) return Done{};
    Result<std::string> text = read_file(path);
    if (!text) return text.error();
    const auto keep = [step](std::string_view line) {
        const auto json = nlohmann::json::parse(line, nullptr, false);
        if (!json.is_object()) return false;
        const auto found = json.find("step");
        return found != json.end() && found->is_number_integer() && *found <= step;
    };
    return rewrite(path, text.value(), leading_lines(text.value(), keep));
}

std::string report_json(const StepReport& r, std::string_view outcome) {
    nlohmann::ordered_json json{{"step", r.step},
                                {"time", r.time},
                                {"outcome", outcome},
                                {"message", r.message},
                                {"newton", r.newton},
                                {"pcg", r.pcg},
                                {"friction_updates", r.friction_updates},
                                {"contacts", r.contacts},
                                {"min_gap", r.min_gap},
                                {"kappa", r.kappa},
                                {"boundary_yield", r.boundary_yield},
                                {"intersections", r.intersections},
                                {"inversions", r.inversions},
                                {"wall_s", r.wall_s}};
    auto iterations = nlohmann::ordered_json::array();
    for (const IterationRecord& iteration : r.iterations)
        iterations.push_back(iteration_json(r.step, iteration));
    json["iterations"] = std::move(iterations);
    return dump(json, 2);
}

}  // namespace noli
