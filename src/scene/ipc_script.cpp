// SPDX-License-Identifier: Apache-2.0
/// From the script to the scene: placements, materials, settings. Animations:
/// ipc_animation.cpp.
#include "scene/ipc_script.hpp"

#include "mesh/source.hpp"
#include "scene/affine.hpp"
#include "scene/ipc_script_data.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace noli {

namespace {

namespace fs = std::filesystem;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
    Vector3 lo{kInfinity, kInfinity, kInfinity};
    Vector3 hi{-kInfinity, -kInfinity, -kInfinity};

    void add(const Vec3d& p) {
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            lo[i] = std::min(lo[i], p[k]);
            hi[i] = std::max(hi[i], p[k]);
        }
    }
    void add(const Vector3& low, const Vector3& high) {
        add({low[0], low[1], low[2]});
        add({high[0], high[1], high[2]});
    }
    [[nodiscard]] Vector3 extent() const {
        return {hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]};
    }
    [[nodiscard]] double diagonal() const {
        const Vector3 e = extent();
        return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    }
    [[nodiscard]] double largest_extent() const {
        const Vector3 e = extent();
        return std::max({e[0], e[1], e[2]});
    }
};

/// The box of the copies of a box on a grid.
void add_copies(Box& box,
                const Box& one,
                const std::array<int, 3>& grid,
                const Vector3& spacing) {
    Vector3 lo = one.lo;
    Vector3 hi = one.hi;
    for (std::size_t k = 0; k < 3; ++k) {
        const double reach = (grid[k] - 1) * spacing[k];
        lo[k] += std::min(0.0, reach);
        hi[k] += std::max(0.0, reach);
    }
    box.add(lo, hi);
}

/// Finds the files that a script names, and reads each of them once.
class ScriptFiles {
  public:
    explicit ScriptFiles(const std::string& script) {
        std::error_code ec;
        script_folder_ =
            fs::absolute(script, ec).parent_path().lexically_normal().string();
    }

    /// The path to write into the scene: relative to the base folder if it lies there.
    std::string locate(const std::string& path,
                       const ScriptWords& place,
                       bool folder = false) {
        std::string searched;
        for (fs::path root = script_folder_;; root = root.parent_path()) {
            const std::string full = resolve_path(path, root.string());
            std::error_code ec;
            const bool found =
                folder ? fs::is_directory(full, ec) : mesh_file_exists(full);
            if (found) return named(path, root.string());
            if (root == root.parent_path()) break;
        }
        std::vector<std::string> siblings;
        std::error_code ec;
        const fs::path around =
            fs::path(resolve_path(path, base_.value_or(script_folder_))).parent_path();
        for (const auto& entry : fs::directory_iterator(around, ec))
            siblings.push_back(entry.path().filename().string());
        place.fail(
            fmt::format("found no file \"{}\" beside the script or in a folder above it, "
                        "expected a mesh{}; "
                        "correct the path or add the file",
                        path,
                        did_you_mean(fs::path(path).filename().string(), siblings)),
            Error::Code::FileNotReadable);
    }

    const Mesh& load(const std::string& path, const ScriptWords& place) {
        const std::string full = resolve_path(path, base_folder());
        if (const auto known = meshes_.find(full); known != meshes_.end())
            return known->second;
        MeshSource source;
        source.file = path;
        Result<Mesh> mesh = load_body_mesh(source, base_folder());
        if (!mesh)
            place.fail(mesh.error().where + ": " + mesh.error().message,
                       mesh.error().code);
        return meshes_.emplace(full, std::move(mesh.value())).first->second;
    }

    [[nodiscard]] std::string base_folder() const {
        return base_.value_or(script_folder_);
    }

  private:
    std::string named(const std::string& path, const std::string& root) {
        if (!base_) base_ = root;
        return *base_ == root ? path : resolve_path(path, root);
    }

    std::string script_folder_;
    std::optional<std::string> base_;
    std::map<std::string, Mesh> meshes_;
};

class Converter {
  public:
    explicit Converter(Script script) : script_(std::move(script)), files_(script_.file) {
        expand_rotated_grids();
    }

    Scene convert() {
        scene_.name = fs::path(script_.file).stem().string();
        scene_.description =
            "Converted from the IPC script " + fs::path(script_.file).filename().string();
        if (script_.shapes.empty())
            throw ScriptFailure{{Error::Code::InvalidScene,
                                 script_.file,
                                 "found no shapes, expected at least one; add \"shapes "
                                 "input 1\" and a line for it"}};
        load_shapes();
        place_shapes();
        for (ScriptObstacle& obstacle : script_.obstacles)
            add_obstacle(obstacle);
        set_time();
        for (const PlacedShape& placed : placed_)
            if (!placed.shape->sequence_folder.empty()) add_sequence(placed);
        set_contact();
        set_solver();
        apply_animation(script_, placed_, scene_);
        scene_.base_folder = files_.base_folder();
        return std::move(scene_);
    }

    [[nodiscard]] const std::vector<SceneWarning>& warnings() const {
        return script_.warnings;
    }

  private:
    /// Copies of a grid that rotateModel turns no longer lie along the axes.
    void expand_rotated_grids() {
        if (!script_.rotation) return;
        std::vector<ScriptShape> shapes;
        for (const ScriptShape& shape : script_.shapes)
            for (int i = 0; i < shape.grid[0]; ++i)
                for (int j = 0; j < shape.grid[1]; ++j)
                    for (int k = 0; k < shape.grid[2]; ++k) {
                        ScriptShape copy = shape;
                        copy.grid = {1, 1, 1};
                        copy.translation[0] += i * shape.spacing[0];
                        copy.translation[1] += j * shape.spacing[1];
                        copy.translation[2] += k * shape.spacing[2];
                        shapes.push_back(copy);
                    }
        script_.shapes = std::move(shapes);
    }

    std::string unique_name(const std::string& wish) {
        std::string name = wish;
        for (int i = 2; !names_.insert(name).second; ++i)
            name = fmt::format("{}_{}", wish, i);
        return name;
    }

    void load_shapes() {
        for (const ScriptShape& shape : script_.shapes) {
            const std::string path = files_.locate(shape.path, shape.place);
            const Mesh& mesh = files_.load(path, shape.place);
            Body body;
            body.name = unique_name(fs::path(path).stem().string());
            body.mesh.file = path;
            body.transform =
                make_affine(shape.scale, shape.rotation_deg, shape.translation);
            body.friction = script_.self_friction;
            body.grid = shape.grid;
            if (determinant(body.transform) == 0.0)
                shape.place.fail(
                    "found a scale of 0, expected other numbers; correct the scale");
            if (!mesh.tets.empty()) set_material(body, shape);
            placed_.push_back({.shape = &shape,
                               .body = scene_.bodies.size(),
                               .elastic = !mesh.tets.empty(),
                               .x = mesh.x,
                               .lo = {},
                               .hi = {}});
            scene_.bodies.push_back(body);
        }
    }

    void set_material(Body& body, const ScriptShape& shape) {
        const ScriptMaterial& m = shape.material ? *shape.material : script_.material;
        body.material = {.model = script_.energy,
                         .density = m.density,
                         .young = m.young,
                         .poisson = m.poisson,
                         .gipc_lame = false};
    }

    Body& body_of(const PlacedShape& placed) { return scene_.bodies[placed.body]; }

    /// Box of the shapes (all, or the elastic ones) with the transforms that the bodies
    /// have now.
    Box box_of_shapes(bool elastic_only, double spacing_scale) {
        Box all;
        for (const PlacedShape& placed : placed_) {
            if (elastic_only && !placed.elastic) continue;
            Box one;
            for (const Vec3d& p : placed.x)
                one.add(apply_affine(body_of(placed).transform, p));
            Vector3 spacing = placed.shape->spacing;
            for (double& s : spacing)
                s *= spacing_scale;
            add_copies(all, one, placed.shape->grid, spacing);
        }
        return all;
    }

    /// rotateModel, size and the initial lift, in this order; they change the placement
    /// only, so the length scale comes from the boxes of the shapes as the file places
    /// them.
    void place_shapes() {
        const bool any_elastic = std::any_of(
            placed_.begin(), placed_.end(), [](const auto& p) { return p.elastic; });
        const double rest_diagonal =
            any_elastic ? box_of_shapes(true, 1.0).diagonal() : 0.0;
        if (script_.rotation) rotate_shapes();

        const Box box = box_of_shapes(false, 1.0);
        double scale = 1.0;
        Vector3 shift{};
        if (script_.size > 0.0) {
            scale = script_.size / box.largest_extent();
            for (std::size_t k = 0; k < 3; ++k)
                shift[k] = -scale * box.lo[k];
        }
        if (animation_lifts(script_.animation)) shift[1] += 0.5 * scale * box.diagonal();
        scene_.length_scale = scale * rest_diagonal;
        for (PlacedShape& placed : placed_) {
            Body& body = body_of(placed);
            body.transform = scaled_and_moved(body.transform, scale, shift);
            for (std::size_t k = 0; k < 3; ++k)
                body.grid_spacing[k] =
                    body.grid[k] > 1 ? scale * placed.shape->spacing[k] : 0.0;
            finish_placement(placed, body);
        }
    }

    /// Turns about half the extent of the box, as the original does: its centre only if
    /// the box starts at 0. `size` removes the difference, otherwise it is part of the
    /// placement.
    void rotate_shapes() {
        const Vector3 extent = box_of_shapes(false, 1.0).extent();
        const Affine turn =
            make_rotation(script_.rotation->axis, script_.rotation->degrees);
        const Vec3d center{0.5 * extent[0], 0.5 * extent[1], 0.5 * extent[2]};
        const Vec3d turned = apply_affine(turn, center);
        Affine about = turn;
        for (int k = 0; k < 3; ++k)
            about.rows[static_cast<std::size_t>(k)][3] = center[k] - turned[k];
        for (const PlacedShape& placed : placed_)
            body_of(placed).transform = compose(about, body_of(placed).transform);
    }

    static void finish_placement(PlacedShape& placed, const Body& body) {
        Box one;
        for (Vec3d& p : placed.x) {
            p = apply_affine(body.transform, p);
            one.add(p);
        }
        Box all;
        add_copies(all, one, body.grid, body.grid_spacing);
        placed.lo = all.lo;
        placed.hi = all.hi;
    }

    void add_obstacle(ScriptObstacle& obstacle) {
        const std::string path = files_.locate(obstacle.path, obstacle.place);
        const Mesh& mesh = files_.load(path, obstacle.place);
        const Affine turn = make_rotation(obstacle.rotation_deg);
        Box box;
        Vec3d mean{0, 0, 0};
        for (const Vec3d& p : mesh.x) {
            box.add(apply_affine(turn, p));
            mean += p;
        }
        const double scale = obstacle.scale / box.largest_extent();
        const Vec3d turned =
            apply_affine(turn, (1.0 / static_cast<double>(mesh.x.size())) * mean);
        Body body;
        body.name = unique_name(fs::path(path).stem().string());
        body.mesh.file = path;
        body.transform = scaled_and_moved(turn,
                                          scale,
                                          {obstacle.origin[0] - scale * turned.x,
                                           obstacle.origin[1] - scale * turned.y,
                                           obstacle.origin[2] - scale * turned.z});
        obstacle.right_end = -kInfinity;
        for (const Vec3d& p : mesh.x)
            obstacle.right_end =
                std::max(obstacle.right_end, apply_affine(body.transform, p).x);
        body.friction = obstacle.friction;
        scene_.bodies.push_back(body);
        // Two bodies use the larger coefficient; here the obstacle's own counts.
        if (obstacle.friction < script_.self_friction)
            scene_.contact.pairs.push_back(
                {"*", body.name, obstacle.friction, std::nullopt});
    }

    /// meshSeq: files 0, 1, ... with the extension of the shape, as far as the steps need
    /// them.
    void add_sequence(const PlacedShape& placed) {
        const ScriptShape& shape = *placed.shape;
        const std::string folder =
            files_.locate(shape.sequence_folder, shape.place, true);
        const std::string extension = fs::path(shape.path).extension().string();
        BoundaryCondition condition;
        condition.kind = BoundaryCondition::Kind::Sequence;
        for (int step = 0; step < scene_.num_steps(); ++step) {
            const std::string file = fmt::format("{}/{}{}", folder, step, extension);
            if (!mesh_file_exists(resolve_path(file, files_.base_folder()))) break;
            condition.sequence.push_back(file);
        }
        if (condition.sequence.empty())
            shape.place.fail(
                fmt::format(
                    "found no file \"0{}\" in {}, expected one per step; add them",
                    extension,
                    folder),
                Error::Code::FileNotReadable);
        body_of(placed).boundary.push_back(condition);
    }

    void set_time() {
        scene_.duration = script_.duration;
        scene_.dt = script_.dt;
        scene_.gravity = script_.gravity ? Vector3{0, -9.80665, 0} : Vector3{0, 0, 0};
        // The original multiplies the elastic Hessian by dampingStiff / dt, ours by beta
        // dt.
        const double dt = script_.dt;
        scene_.damping.stiffness = script_.damping_ratio
                                     ? 0.75 * *script_.damping_ratio * dt
                                     : script_.damping_stiff / (dt * dt);
    }

    void set_contact() {
        ContactSettings& contact = scene_.contact;
        for (HalfSpace half_space : script_.half_spaces) {
            half_space.name = unique_name("ground");
            scene_.half_spaces.push_back(half_space);
        }
        contact.dhat = script_.tuning[2];
        contact.epsv = script_.tuning[5];
        contact.dhat_absolute = contact.epsv_absolute = script_.absolute;
        contact.friction_iterations = script_.friction_iterations;
        contact.kappa_min_multiplier = script_.kappa_min_multiplier;
        if (script_.tuning[0] != 0.0)
            throw ScriptFailure{{Error::Code::Unsupported,
                                 script_.file,
                                 "found a fixed contact stiffness (first number of "
                                 "\"tuning\"), whose scale belongs to "
                                 "the other program; write 0 for an adaptive one, or set "
                                 "contact.kappa in JSON"}};
        if (script_.tuning[1] != script_.tuning[2]
            || script_.tuning[4] != script_.tuning[5])
            script_.warnings.push_back(
                {script_.file,
                 "dHat and epsv start at their target values: their homotopy "
                 "within a step is not done"});
        if (!(contact.dhat > 0.0 && contact.epsv > 0.0))
            throw ScriptFailure{
                {Error::Code::InvalidScene,
                 script_.file,
                 fmt::format(
                     "found dHat {} and epsv {}, expected both > 0; correct \"tuning\"",
                     contact.dhat,
                     contact.epsv)}};
        if (!script_.self_collision) disable_contact_of_shapes();
    }

    /// Obstacles and half-spaces keep their contact with the shapes.
    void disable_contact_of_shapes() {
        ContactSettings& contact = scene_.contact;
        contact.self_contact = false;
        if (script_.obstacles.empty() && script_.half_spaces.empty()) {
            contact.enabled = false;
            return;
        }
        for (std::size_t i = 0; i < placed_.size(); ++i)
            for (std::size_t j = i; j < placed_.size(); ++j)
                if (i != j || placed_[i].copies() > 1)
                    contact.pairs.push_back({body_of(placed_[i]).name,
                                             body_of(placed_[j]).name,
                                             std::nullopt,
                                             false});
    }

    void set_solver() {
        SolverSettings& solver = scene_.solver;
        solver.integrator = script_.integrator;
        solver.newmark_beta = script_.newmark_beta;
        solver.newmark_gamma = script_.newmark_gamma;
        solver.tolerance_absolute = script_.absolute;
        solver.tolerance = script_.tolerances.front();
        if (script_.tolerances.size() > 1) solver.tolerance_per_step = script_.tolerances;
        if (std::any_of(script_.tolerances.begin(),
                        script_.tolerances.end(),
                        [](double t) { return !(t > 0); }))
            throw ScriptFailure{{Error::Code::InvalidScene,
                                 script_.file,
                                 "found a tolerance that is not positive, expected > 0; "
                                 "correct \"tol\""}};
    }

    Script script_;
    ScriptFiles files_;
    Scene scene_;
    std::vector<PlacedShape> placed_;
    std::set<std::string> names_;
};

}  // namespace

Result<Scene> read_ipc_script(const std::string& path,
                              std::vector<SceneWarning>* warnings) {
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    try {
        Converter converter(parse_script(path, text));
        Scene scene = converter.convert();
        if (warnings != nullptr)
            warnings->insert(warnings->end(),
                             converter.warnings().begin(),
                             converter.warnings().end());
        return scene;
    } catch (const ScriptFailure& failure) {
        return failure.error;
    }
}

}  // namespace noli
