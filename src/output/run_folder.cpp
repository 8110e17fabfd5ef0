// SPDX-License-Identifier: Apache-2.0
#include "output/run_folder.hpp"

#include "output/file.hpp"
#include "output/frame.hpp"
#include "output/hash.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

namespace noli {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kKind = "noli run";
constexpr std::string_view kReproPrefix = "repro_step_";

/// What a run writes into its root, folders included.
bool is_of_a_run(const std::string& name) {
    static const std::vector<std::string> names{"run.json",
                                                "scene.json",
                                                "log.txt",
                                                "stats.csv",
                                                "iterations.jsonl",
                                                "frames",
                                                "frames.pvd",
                                                "checkpoints"};
    return std::find(names.begin(), names.end(), name) != names.end()
        || name.starts_with(kReproPrefix) || name.ends_with(kPartSuffix);
}

std::uint64_t parse_hash(const std::string& text) {
    std::uint64_t hash = 0;
    std::from_chars(text.data(), text.data() + text.size(), hash, 16);
    return hash;
}

nlohmann::ordered_json hash_json(const std::optional<std::uint64_t>& hash) {
    return hash ? nlohmann::ordered_json(hash_text(*hash)) : nlohmann::ordered_json();
}

}  // namespace

RunPaths::RunPaths(std::string root_folder) : root(std::move(root_folder)) {
    const auto in_root = [this](const char* name) {
        return (fs::path(root) / name).string();
    };
    record = in_root("run.json");
    scene = in_root("scene.json");
    log = in_root("log.txt");
    stats = in_root("stats.csv");
    iterations = in_root("iterations.jsonl");
    frames = in_root("frames");
    checkpoints = in_root("checkpoints");
    collection = in_root("frames.pvd");
}

std::string encode_run_record(const RunRecord& r) {
    const nlohmann::ordered_json json{{"kind", kKind},
                                      {"format", r.format},
                                      {"program", r.program},
                                      {"fingerprint", hash_text(r.fingerprint)},
                                      {"scene_name", r.scene_name},
                                      {"status", r.status},
                                      {"outcome", r.outcome},
                                      {"message", r.message},
                                      {"steps_done", r.steps_done},
                                      {"steps_asked", r.steps_asked},
                                      {"state_hash", hash_json(r.state_hash)},
                                      {"dt_s", r.dt},
                                      {"diagonal_m", r.diagonal},
                                      {"dhat_m", r.dhat},
                                      {"epsv_m_per_s", r.epsv},
                                      {"tolerance_m_per_s", r.tolerance},
                                      {"num_vertices", r.num_vertices},
                                      {"num_tets", r.num_tets},
                                      {"device", r.device},
                                      {"bodies", r.bodies}};
    using Handler = nlohmann::ordered_json::error_handler_t;
    return json.dump(2, ' ', false, Handler::replace) + "\n";
}

Result<RunRecord> decode_run_record(const std::string& text, const std::string& where) {
    const auto bad = [&where](const std::string& what) {
        return Error{Error::Code::RunDirectory, where, what};
    };
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object() || json.value("kind", nlohmann::json()) != kKind)
        return bad("is not the record of a noli run; choose another directory with -o");
    try {
        RunRecord r;
        json.at("format").get_to(r.format);
        if (r.format != kRunFormat)
            return bad(
                fmt::format("has run format {}, this program reads format {}; use the "
                            "program that wrote it or choose another directory with -o",
                            r.format,
                            kRunFormat));
        json.at("program").get_to(r.program);
        r.fingerprint = parse_hash(json.at("fingerprint").get<std::string>());
        json.at("scene_name").get_to(r.scene_name);
        json.at("status").get_to(r.status);
        json.at("outcome").get_to(r.outcome);
        json.at("message").get_to(r.message);
        json.at("steps_done").get_to(r.steps_done);
        json.at("steps_asked").get_to(r.steps_asked);
        if (!json.at("state_hash").is_null())
            r.state_hash = parse_hash(json.at("state_hash").get<std::string>());
        r.dt = json.value("dt_s", 0.0);
        r.diagonal = json.value("diagonal_m", 0.0);
        r.dhat = json.value("dhat_m", 0.0);
        r.epsv = json.value("epsv_m_per_s", 0.0);
        r.tolerance = json.value("tolerance_m_per_s", 0.0);
        r.num_vertices = json.value("num_vertices", 0);
        r.num_tets = json.value("num_tets", 0);
        r.device = json.value("device", "");
        r.bodies = json.value("bodies", std::vector<std::string>{});
        return r;
    } catch (const nlohmann::json::exception& problem) {
        return bad(std::string("is damaged (") + problem.what()
                   + "); start anew with --overwrite");
    }
}

FolderState inspect_folder(const std::string& path) {
    std::error_code failed;
    if (!fs::exists(fs::symlink_status(path, failed))) return FolderState::Missing;
    if (!fs::is_directory(path, failed)) return FolderState::Foreign;
    const std::vector<std::string> names = list_folder(path);
    if (std::find(names.begin(), names.end(), "run.json") != names.end())
        return FolderState::Run;
    const bool is_empty = std::all_of(names.begin(), names.end(), [](const auto& name) {
        return name == std::string("run.json") + std::string(kPartSuffix);
    });
    return is_empty ? FolderState::Empty : FolderState::Foreign;
}

Status clear_run_folder(const std::string& root) {
    std::vector<std::string> names = list_folder(root);
    std::stable_partition(
        names.begin(), names.end(), [](const auto& name) { return name != "run.json"; });
    for (const std::string& name : names) {
        if (!is_of_a_run(name)) continue;
        const std::string path = (fs::path(root) / name).string();
        std::error_code failed;
        fs::remove_all(path, failed);
        if (failed) return io_error("remove", path, failed.value());
    }
    return Done{};
}

void remove_frames_after(const std::string& frames_folder, int step) {
    for (const std::string& name : list_folder(frames_folder)) {
        if (step_of_frame_file(name) <= step) continue;
        std::error_code ignored;
        fs::remove(fs::path(frames_folder) / name, ignored);
    }
}

}  // namespace noli
