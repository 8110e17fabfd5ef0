// SPDX-License-Identifier: Apache-2.0
/// describe: what a path holds, in a few lines for a person.

#include "noli/simulator.hpp"

#include "mesh/check.hpp"
#include "mesh/source.hpp"
#include "mesh/topology.hpp"
#include "output/checkpoint.hpp"
#include "output/file.hpp"
#include "output/run_folder.hpp"
#include "output/stats.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace noli {

namespace fs = std::filesystem;

namespace {

/// Lines of "label  value" under a title.
class Lines {
  public:
    explicit Lines(const std::string& title) : text_(title + "\n") {}
    template <class... Args>
    void add(const char* label, fmt::format_string<Args...> format, Args&&... args) {
        text_ += fmt::format("  {:<14}", label);
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += '\n';
    }
    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    std::string text_;
};

std::string extents(const Vec3d& lo, const Vec3d& hi) {
    return fmt::format("{:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g} m",
                       lo.x,
                       lo.y,
                       lo.z,
                       hi.x,
                       hi.y,
                       hi.z);
}

const char* role_name(MeshRole role) {
    switch (role) {
        case MeshRole::Solid:
            return "tetrahedral mesh (elastic body)";
        case MeshRole::Surface:
            return "triangle mesh (obstacle)";
        case MeshRole::Segments:
            return "segments (obstacle)";
        case MeshRole::Points:
            return "points (obstacle)";
    }
    return "mesh";
}

void add_quality(Lines& lines, MeshRole role, const MeshQuality& quality) {
    if (quality.max_edge <= 0.0) return;
    lines.add("box", "{}", extents(quality.lo, quality.hi));
    lines.add("edges",
              "{:.4g} to {:.4g} m, mean {:.4g} m",
              quality.min_edge,
              quality.max_edge,
              quality.mean_edge);
    if (role == MeshRole::Solid) {
        lines.add(
            "volume", "{:.6g} m^3, surface {:.6g} m^2", quality.volume, quality.area);
        lines.add("quality",
                  "radius ratio {:.3g} at worst (element {}), {:.3g} on average; "
                  "dihedral angles "
                  "{:.3g} to {:.3g} degrees",
                  quality.min_radius_ratio,
                  quality.worst_element,
                  quality.mean_radius_ratio,
                  quality.min_dihedral,
                  quality.max_dihedral);
    } else if (role == MeshRole::Surface) {
        lines.add("area", "{:.6g} m^2", quality.area);
        lines.add("quality",
                  "radius ratio {:.3g} at worst (element {}), {:.3g} on average",
                  quality.min_radius_ratio,
                  quality.worst_element,
                  quality.mean_radius_ratio);
    }
}

/// Vertices without an element are none of them.
int count_components(const Mesh& mesh) {
    const Components components = connected_components(mesh);
    const std::vector<std::uint8_t> used = referenced_vertices(mesh);
    std::vector<std::uint8_t> counts(static_cast<size_t>(components.count), 0);
    for (size_t v = 0; v < used.size(); ++v)
        counts[static_cast<size_t>(components.of_vertex[v])] |= used[v];
    return static_cast<int>(std::count(counts.begin(), counts.end(), 1));
}

Result<std::string> describe_mesh(const std::string& path) {
    const Result<Mesh> read = read_body_mesh(path);
    if (!read) return read.error();
    const Mesh& mesh = read.value();
    const MeshRole role = natural_role(mesh);
    const MeshReport report = check_mesh(mesh, role, body_check_options());
    Lines lines(fmt::format("{}: {}", path, role_name(role)));
    lines.add("counts",
              "{} vertices, {} tetrahedra, {} triangles, {} segments",
              mesh.x.size(),
              mesh.tets.size(),
              mesh.triangles.size(),
              mesh.segments.size());
    if (!mesh.points.empty()) lines.add("points", "{}", mesh.points.size());
    if (report.ok()) {
        if (role == MeshRole::Solid)
            lines.add("surface", "{} triangles", boundary_triangles(mesh.tets).size());
        lines.add("components", "{}", count_components(mesh));
    }
    add_quality(lines, role, report.quality);
    for (const MeshIssue& issue : report.errors)
        lines.add("error", "{}", issue.message);
    for (const MeshIssue& issue : report.warnings)
        lines.add("warning", "{}", issue.message);
    if (report.errors.empty() && report.warnings.empty()) lines.add("issues", "none");
    return lines.text();
}

/// What belongs to one body of a simulator.
struct BodySize {
    int vertices = 0, tets = 0;
    Vec3d lo{kForever, kForever, kForever}, hi{-kForever, -kForever, -kForever};
};

std::vector<BodySize> body_sizes(const Simulator& simulator) {
    const Topology topology = simulator.topology();
    const std::vector<Vector3> positions = simulator.positions();
    std::vector<BodySize> sizes(topology.body_names.size());
    const auto has_element = [&](size_t v) {
        return !std::binary_search(topology.unreferenced.begin(),
                                   topology.unreferenced.end(),
                                   static_cast<int>(v));
    };
    for (size_t v = 0; v < positions.size(); ++v) {
        BodySize& size = sizes[static_cast<size_t>(topology.body_of_vertex[v])];
        ++size.vertices;
        if (!has_element(v)) continue;
        for (int k = 0; k < 3; ++k) {
            const double coordinate = positions[v][static_cast<size_t>(k)];
            size.lo[k] = std::min(size.lo[k], coordinate);
            size.hi[k] = std::max(size.hi[k], coordinate);
        }
    }
    for (const auto& tet : topology.tets) {
        const int body = topology.body_of_vertex[static_cast<size_t>(tet[0])];
        ++sizes[static_cast<size_t>(body)].tets;
    }
    return sizes;
}

/// The bodies with their sizes; of many, the first few.
void add_bodies(Lines& lines, const Simulator& simulator) {
    constexpr size_t kListed = 20;
    const Topology topology = simulator.topology();
    const std::vector<BodySize> sizes = body_sizes(simulator);
    for (size_t b = 0; b < std::min(sizes.size(), kListed); ++b)
        lines.add("body",
                  "{}: {}, {} vertices, {} tetrahedra, {}",
                  topology.body_names[b],
                  sizes[b].tets > 0 ? "elastic" : "obstacle",
                  sizes[b].vertices,
                  sizes[b].tets,
                  extents(sizes[b].lo, sizes[b].hi));
    if (sizes.size() > kListed)
        lines.add("", "and {} more bodies", sizes.size() - kListed);
}

Result<std::string> describe_scene(const std::string& path) {
    std::vector<SceneWarning> warnings;
    const Result<Scene> read = read_scene(path, &warnings);
    if (!read) return read.error();
    const Scene& scene = read.value();
    SimulatorOptions options;
    options.device = Device::Cpu;
    const Result<Simulator> created = Simulator::create(scene, options);
    if (!created) return created.error();
    const Resolved& resolved = created.value().resolved();
    Lines lines(fmt::format(
        "{}: scene{}", path, scene.name.empty() ? "" : " \"" + scene.name + "\""));
    if (!scene.description.empty()) lines.add("about", "{}", scene.description);
    lines.add("duration",
              "{:.6g} s in {} steps of {:.6g} s",
              scene.duration,
              scene.num_steps(),
              scene.dt);
    lines.add(
        "size",
        "{} bodies, {} vertices, {} tetrahedra, {} surface triangles, {} half-spaces{}",
        resolved.num_bodies,
        resolved.num_vertices,
        resolved.num_tets,
        resolved.num_triangles,
        scene.half_spaces.size(),
        scene.containers.empty()
            ? ""
            : fmt::format(", {} containers", scene.containers.size()));
    lines.add("mass", "{:.6g} kg", resolved.total_mass);
    add_bodies(lines, created.value());
    if (scene.contact.enabled)
        lines.add("contact",
                  "dhat {:.6g} m, epsv {:.6g} m/s (diagonal {:.6g} m)",
                  resolved.dhat,
                  resolved.epsv,
                  resolved.diagonal);
    else
        lines.add("contact", "off");
    lines.add("tolerance", "{:.6g} m/s", resolved.tolerance);
    lines.add("memory", "about {:.0f} MB", resolved.estimated_mb);
    const std::vector<SceneWarning>& of_model = resolved.warnings;
    warnings.insert(warnings.end(), of_model.begin(), of_model.end());
    for (const SceneWarning& warning : warnings)
        lines.add("warning", "{}: {}", warning.where, warning.message);
    return lines.text();
}

/// Sums and extremes over the rows of a run.
void add_totals(Lines& lines, const std::vector<StatsEntry>& rows) {
    double wall = 0.0;
    double gap = std::numeric_limits<double>::infinity();
    double peak = 0.0;
    long newton = 0;
    long pcg = 0;
    long contacts = 0;
    long intersections = -1;
    long inversions = -1;
    long on_one = 0;
    int threads = 0;
    for (const StatsEntry& row : rows) {
        wall += row.wall_s;
        newton += row.newton;
        pcg += row.pcg;
        contacts = std::max(contacts, row.contacts);
        gap = std::min(gap, row.min_gap);
        peak = std::max(peak, row.peak_mb);
        intersections = std::max(intersections, row.intersections);
        inversions = std::max(inversions, row.inversions);
        on_one += row.threads == 1 ? 1 : 0;
        threads = std::max(threads, row.threads);
    }
    const auto steps = static_cast<double>(rows.size());
    lines.add("wall", "{:.3f} s, {:.4g} s a step", wall, wall / steps);
    if (threads > 1 && on_one > 0)
        lines.add("threads",
                  "{}; {} of {} steps on one, which was faster or had to be tried",
                  threads,
                  on_one,
                  rows.size());
    lines.add("newton",
              "{} iterations, {:.3g} a step; {} of pcg",
              newton,
              static_cast<double>(newton) / steps,
              pcg);
    lines.add("contacts", "at most {}", contacts);
    if (std::isfinite(gap)) lines.add("min gap", "{:.6g} m", gap);
    if (intersections >= 0)
        lines.add("verified",
                  "at most {} intersections, {} inversions",
                  intersections,
                  inversions);
    lines.add("memory", "{:.0f} MB at most", peak);
}

/// The status, with "running" told from "killed" by the lock that a running process
/// holds.
std::string living_status(const RunRecord& record, const std::string& root) {
    if (record.status != "running") return record.status;
    FolderLock lock;
    return lock.acquire(root) == FolderLock::Held::ByAnother
             ? "running"
             : "ended without saying so (killed?)";
}

Result<std::string> describe_run(const std::string& root) {
    const RunPaths paths(root);
    const Result<std::string> text = read_file(paths.record);
    if (!text) return text.error();
    const Result<RunRecord> read = decode_run_record(text.value(), paths.record);
    if (!read) return read.error();
    const RunRecord& record = read.value();
    const Result<std::string> table = read_file(paths.stats);
    const std::vector<StatsEntry> rows =
        table ? parse_stats(table.value()) : std::vector<StatsEntry>{};
    const std::string status = living_status(record, root);
    Lines lines(fmt::format(
        "{}: run{}",
        root,
        record.scene_name.empty() ? "" : " of \"" + record.scene_name + "\""));
    lines.add("status", "{}", status);
    // The row of a step that failed is the last one, and its step is not done.
    const bool has_failed =
        !rows.empty() && rows.back().outcome != to_string(Outcome::Converged);
    const size_t steps_done = rows.size() - (has_failed ? 1 : 0);
    lines.add("steps",
              "{} of {} ({:.6g} s of simulated time)",
              steps_done,
              record.steps_asked,
              steps_done == 0 ? 0.0 : rows[steps_done - 1].time);
    if (!rows.empty()) lines.add("outcome", "{} at the last step", rows.back().outcome);
    if (!record.message.empty()) lines.add("message", "{}", record.message);
    lines.add("size",
              "{} bodies, {} vertices, {} tetrahedra",
              record.bodies.size(),
              record.num_vertices,
              record.num_tets);
    lines.add("contact", "dhat {:.6g} m, epsv {:.6g} m/s", record.dhat, record.epsv);
    lines.add("by", "{} on {}", record.program, record.device);
    if (!rows.empty()) add_totals(lines, rows);
    const FoundCheckpoint found =
        load_newest_checkpoint(paths.checkpoints, record.fingerprint);
    for (const std::string& skipped : found.skipped)
        lines.add("warning", "{}", skipped);
    if (found.found) lines.add("checkpoint", "after step {}", found.checkpoint.step);
    if (status != "finished" && status != "running")
        lines.add("go on with", "noli run {} --resume", root);
    return lines.text();
}

}  // namespace

Result<std::string> describe(const std::string& path) {
    std::error_code failed;
    if (!fs::exists(path, failed) && !fs::path(path).extension().empty())
        return Error{Error::Code::FileNotReadable, path, "is not there; check the path"};
    if (fs::is_directory(path, failed)) {
        if (inspect_folder(path) == FolderState::Run) return describe_run(path);
        return Error{
            Error::Code::RunDirectory,
            path,
            "is a folder without run.json; name a mesh, a scene or a run directory"};
    }
    const std::string extension = fs::path(path).extension().string();
    if (extension == ".json" || extension == ".txt") return describe_scene(path);
    return describe_mesh(path);
}

}  // namespace noli
