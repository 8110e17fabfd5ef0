// SPDX-License-Identifier: Apache-2.0
#include "output/stats.hpp"

#include "output/file.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace noli {
namespace {

StepReport make_report(int step) {
    StepReport r;
    r.step = step;
    r.time = 0.1 * step;
    r.newton = 4;
    r.pcg = 321;
    r.contacts = 17;
    r.min_gap = 1.0 / 3.0;
    r.kappa = 1e9;
    r.wall_s = 0.25;
    r.peak_mb = 100.5;
    r.threads = 2;
    IterationRecord iteration;
    iteration.iteration = 1;
    iteration.energy = std::numeric_limits<double>::quiet_NaN();
    iteration.limiting = "pair EE 1 2 | 3 4";
    r.iterations = {iteration, iteration};
    return r;
}

std::string row(int step) {
    return stats_row(make_report(step), "Converged", 0xabcu);
}

/// A stats.csv with rows of steps 1..steps and `tail` after them.
void write_table(const std::string& path, int steps, const std::string& tail = "") {
    std::string text(kStatsHeader);
    for (int step = 1; step <= steps; ++step)
        text += row(step);
    ASSERT_TRUE(write_file(path, text + tail));
}

TEST(StatsRow, HasAValueForEveryColumn) {
    const auto commas = [](std::string_view text) {
        return std::count(text.begin(), text.end(), ',');
    };
    EXPECT_EQ(commas(row(1)), commas(kStatsHeader));
    EXPECT_TRUE(kStatsHeader.starts_with(
        "step,t,wall_s,newton,pcg,contacts,min_gap,kappa,intersections,inversions,"
        "outcome,"
        "t_pairs,t_assemble,t_solve,t_ccd,t_search,t_output,peak_mb"));
}

TEST(StatsRow, KeepsEveryBitOfQuantities) {
    const std::vector<StatsEntry> rows = parse_stats(std::string(kStatsHeader) + row(7));
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].step, 7);
    EXPECT_EQ(rows[0].time, 0.1 * 7);
    EXPECT_EQ(rows[0].min_gap, 1.0 / 3.0);
    EXPECT_EQ(rows[0].newton, 4);
    EXPECT_EQ(rows[0].pcg, 321);
    EXPECT_EQ(rows[0].contacts, 17);
    EXPECT_EQ(rows[0].intersections, -1);
    EXPECT_EQ(rows[0].outcome, "Converged");
    EXPECT_EQ(rows[0].peak_mb, 100.5);
    EXPECT_EQ(rows[0].threads, 2);
}

TEST(StatsRow, HoldsAnInfiniteGap) {
    StepReport report = make_report(1);
    report.min_gap = std::numeric_limits<double>::infinity();
    const auto rows =
        parse_stats(std::string(kStatsHeader) + stats_row(report, "Converged", 0));
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_TRUE(std::isinf(rows[0].min_gap));
}

TEST(StatsRow, MayLackTheHash) {
    const std::string without = stats_row(make_report(2), "Converged", {});
    EXPECT_EQ(parse_stats(std::string(kStatsHeader) + without).size(), 1u);
    EXPECT_EQ(without.size() + 16, stats_row(make_report(2), "Converged", 1).size());
}

TEST(ParseStats, StopsAtAHalfWrittenRow) {
    const std::string text = std::string(kStatsHeader) + row(1) + row(2);
    for (size_t cut = text.size() - row(2).size(); cut < text.size(); ++cut)
        EXPECT_EQ(parse_stats(text.substr(0, cut)).size(), 1u);
    EXPECT_EQ(parse_stats("other,columns\n1,2\n").size(), 0u);
}

TEST(TrimStats, CreatesTheTableWithItsHeader) {
    const ScratchFolder scratch;
    ASSERT_TRUE(trim_stats(scratch / "stats.csv", 0));
    EXPECT_EQ(read_file(scratch / "stats.csv").value(), kStatsHeader);
}

TEST(TrimStats, CutsRowsAfterTheStepAndHalfRows) {
    const ScratchFolder scratch;
    const std::string path = scratch / "stats.csv";
    write_table(path, 9, "10,1.0,0.2");
    ASSERT_TRUE(trim_stats(path, 4));
    EXPECT_EQ(read_file(path).value(),
              std::string(kStatsHeader) + row(1) + row(2) + row(3) + row(4));
    ASSERT_TRUE(trim_stats(path, 0));
    EXPECT_EQ(read_file(path).value(), kStatsHeader);
}

TEST(TrimStats, RefusesATableWithMissingRowsAndLeavesItAlone) {
    const ScratchFolder scratch;
    const std::string path = scratch / "stats.csv";
    write_table(path, 3, row(5));
    const std::string before = read_file(path).value();
    const Status trimmed = trim_stats(path, 5);
    ASSERT_FALSE(trimmed);
    EXPECT_EQ(trimmed.error().code, Error::Code::BadCheckpoint);
    EXPECT_EQ(read_file(path).value(), before);
    EXPECT_FALSE(trim_stats(scratch / "none.csv", 5));
}

TEST(IterationLines, AreOneJsonObjectEach) {
    const std::string lines = iteration_lines(make_report(3));
    EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2);
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line);) {
        const auto json = nlohmann::json::parse(line);
        EXPECT_EQ(json.at("step"), 3);
        EXPECT_EQ(json.at("limiting"), "pair EE 1 2 | 3 4");
        EXPECT_TRUE(json.at("energy").is_null());  // NaN has no JSON form
    }
}

TEST(TrimIterations, CutsStepsAfterTheStepAndHalfLines) {
    const ScratchFolder scratch;
    const std::string path = scratch / "iterations.jsonl";
    EXPECT_TRUE(trim_iterations(path, 3));
    const std::string first = iteration_lines(make_report(1));
    ASSERT_TRUE(
        write_file(path, first + iteration_lines(make_report(2)) + "{\"step\": 1"));
    ASSERT_TRUE(trim_iterations(path, 1));
    EXPECT_EQ(read_file(path).value(), first);
}

TEST(ReportJson, IsADocumentWithTheMessage) {
    StepReport report = make_report(4);
    report.message = "element 7 \"bad\"";
    const auto json = nlohmann::json::parse(report_json(report, "Stalled"));
    EXPECT_EQ(json.at("outcome"), "Stalled");
    EXPECT_EQ(json.at("message"), report.message);
    EXPECT_EQ(json.at("iterations").size(), 2u);
}

}  // namespace
}  // namespace noli
