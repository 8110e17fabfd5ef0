// SPDX-License-Identifier: Apache-2.0
/// From the script to the scene: placements, materials. Settings: ipc_settings.cpp.
/// Animations: ipc_animation.cpp.
#include "scene/ipc_script.hpp"

#include "mesh/source.hpp"
#include "mesh/topology.hpp"
#include "scene/affine.hpp"
#include "scene/ipc_box.hpp"
#include "scene/ipc_files.hpp"
#include "scene/ipc_script_data.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>

namespace noli {

namespace {

namespace fs = std::filesystem;

/// Without vertices that belong to no element.
std::vector<Vec3d> used_points(const Mesh& mesh) {
    const std::vector<std::uint8_t> used = referenced_vertices(mesh);
    std::vector<Vec3d> out;
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v] != 0) out.push_back(mesh.x[v]);
    return out;
}

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
        apply_time(script_, scene_);
        for (const PlacedShape& placed : placed_)
            if (!placed.shape->sequence_folder.empty()) add_sequence(placed);
        add_half_spaces();
        apply_contact(script_, placed_, scene_);
        apply_solver(script_, scene_);
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
                               .x = used_points(mesh),
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
    ScriptBox box_of_shapes(bool elastic_only, double spacing_scale) {
        ScriptBox all;
        for (const PlacedShape& placed : placed_) {
            if (elastic_only && !placed.elastic) continue;
            ScriptBox one;
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

        const ScriptBox box = box_of_shapes(false, 1.0);
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
        ScriptBox one;
        for (Vec3d& p : placed.x) {
            p = apply_affine(body.transform, p);
            one.add(p);
        }
        ScriptBox all;
        add_copies(all, one, body.grid, body.grid_spacing);
        placed.lo = all.lo;
        placed.hi = all.hi;
    }

    void add_obstacle(ScriptObstacle& obstacle) {
        const std::string path = files_.locate(obstacle.path, obstacle.place);
        const std::vector<Vec3d> points = used_points(files_.load(path, obstacle.place));
        const Affine turn = make_rotation(obstacle.rotation_deg);
        ScriptBox box;
        Vec3d mean{0, 0, 0};
        for (const Vec3d& p : points) {
            box.add(apply_affine(turn, p));
            mean += p;
        }
        const double scale = obstacle.scale / box.largest_extent();
        const Vec3d turned =
            apply_affine(turn, (1.0 / static_cast<double>(points.size())) * mean);
        Body body;
        body.name = unique_name(fs::path(path).stem().string());
        body.mesh.file = path;
        body.transform = scaled_and_moved(turn,
                                          scale,
                                          {obstacle.origin[0] - scale * turned.x,
                                           obstacle.origin[1] - scale * turned.y,
                                           obstacle.origin[2] - scale * turned.z});
        obstacle.right_end = -std::numeric_limits<double>::infinity();
        for (const Vec3d& p : points)
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

    void add_half_spaces() {
        for (HalfSpace half_space : script_.half_spaces) {
            half_space.name = unique_name("ground");
            scene_.half_spaces.push_back(half_space);
        }
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
