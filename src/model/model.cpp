// SPDX-License-Identifier: Apache-2.0
#include "model/model.hpp"

#include "energy/elastic.hpp"
#include "mesh/source.hpp"
#include "mesh/topology.hpp"
#include "model/origin.hpp"
#include "model/rotation.hpp"
#include "model/select.hpp"
#include "model/sequence.hpp"
#include "model/settings.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace noli {

namespace {

Vec3d apply(const Affine& m, const Vec3d& p) {
    const auto row = [&](std::size_t i) {
        return m.rows[i][0] * p.x + m.rows[i][1] * p.y + m.rows[i][2] * p.z
             + m.rows[i][3];
    };
    return {row(0), row(1), row(2)};
}

double linear_det(const Affine& m) {
    return det(Mat3d{m.rows[0][0],
                     m.rows[0][1],
                     m.rows[0][2],
                     m.rows[1][0],
                     m.rows[1][1],
                     m.rows[1][2],
                     m.rows[2][0],
                     m.rows[2][1],
                     m.rows[2][2]});
}

std::string body_place(const Scene& scene, std::size_t index) {
    return fmt::format("{}:/bodies/{}", scene.name.empty() ? "scene" : scene.name, index);
}

/// Appends bodies one after the other.
class Builder {
  public:
    explicit Builder(const Scene& scene) : scene_(scene) {}

    /// Loads the bodies and puts them where they are.
    Status place() {
        for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
            Status added = add_body(b);
            if (!added) return added.error();
        }
        if (model_.num_vertices == 0)
            return Error{Error::Code::InvalidScene,
                         scene_.name + ":/bodies",
                         "the scene has no bodies; add at least one"};
        return Done{};
    }

    /// Everything else, after place. Places count from `origin` in the world.
    Result<Model> finish(const Vec3d& origin) {
        model_.origin = origin;
        sort_tets();
        model_.tet_source = source_;
        if (Status loaded = load_sequences(scene_.base_folder, model_); !loaded)
            return loaded.error();
        add_walls(scene_, model_);
        set_contact_rules(scene_, source_body_, model_);
        resolve_scales(scene_, model_);
        Status fits = check_containers();
        if (!fits) return fits.error();
        return std::move(model_);
    }

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const std::vector<SceneWarning>& warnings() const { return warnings_; }

  private:
    /// The barrier of a container must end before its centre, where its wall has no
    /// normal.
    [[nodiscard]] Status check_containers() const {
        for (std::size_t k = 0; k < scene_.containers.size(); ++k)
            if (!(model_.dhat + model_.min_separation < scene_.containers[k].radius))
                return Error{Error::Code::InvalidScene,
                             fmt::format("{}:/containers/{}/radius",
                                         scene_.name.empty() ? "scene" : scene_.name,
                                         k),
                             fmt::format("found a radius of {:g} m, expected more than "
                                         "{:g} m, where its barrier begins; "
                                         "reduce contact/dhat",
                                         scene_.containers[k].radius,
                                         model_.dhat + model_.min_separation)};
        return Done{};
    }

    Status add_body(std::size_t index) {
        const Body& body = scene_.bodies[index];
        std::vector<std::string> notes;
        Result<Mesh> loaded = load_body_mesh(body.mesh, scene_.base_folder, &notes);
        for (const std::string& note : notes)
            warn(body_place(scene_, index) + "/mesh", note);
        if (!loaded) {
            Error error = loaded.error();
            error.where = body_place(scene_, index) + "/mesh: " + error.where;
            return error;
        }
        Mesh& mesh = loaded.value();
        if (linear_det(body.transform) < 0.0)  // a mirror turns every element inside out
            for (Int4& t : mesh.tets)
                std::swap(t[2], t[3]);
        const std::vector<Vec3d> file_x = mesh.x;
        for (Vec3d& p : mesh.x)
            p = apply(body.transform, p);
        for (int i = 0; i < body.grid[0]; ++i)
            for (int j = 0; j < body.grid[1]; ++j)
                for (int k = 0; k < body.grid[2]; ++k) {
                    const Vec3d shift{i * body.grid_spacing[0],
                                      j * body.grid_spacing[1],
                                      k * body.grid_spacing[2]};
                    const bool copies = body.grid[0] * body.grid[1] * body.grid[2] > 1;
                    const std::string name =
                        copies ? fmt::format("{}[{},{},{}]", body.name, i, j, k)
                               : body.name;
                    Status added = add_copy(index, mesh, file_x, shift, name);
                    if (!added) return added.error();
                }
        return Done{};
    }

    Status add_copy(std::size_t index,
                    const Mesh& mesh,
                    const std::vector<Vec3d>& file_x,
                    const Vec3d& shift,
                    const std::string& name) {
        const Body& body = scene_.bodies[index];
        const int first = model_.num_vertices;
        const int count = static_cast<int>(mesh.x.size());
        const bool elastic = !mesh.tets.empty();
        model_.num_vertices += count;
        model_.body_names.push_back(name);
        source_body_.push_back(index);
        for (const Vec3d& p : mesh.x)
            model_.x0.push_back(p + shift);
        model_.body.resize(static_cast<std::size_t>(model_.num_vertices),
                           model_.num_bodies() - 1);
        model_.mass.resize(static_cast<std::size_t>(model_.num_vertices), 0.0);
        model_.obstacle.resize(static_cast<std::size_t>(model_.num_vertices),
                               elastic ? 0 : 1);
        add_surface(mesh, first);
        if (elastic) {
            Status added = add_tets(index, mesh, first, name);
            if (!added) return added.error();
        }
        const std::vector<std::uint8_t> used = referenced_vertices(mesh);
        set_aside_unreferenced(used, first);
        add_velocity(body, used, first);
        return add_conditions(index,
                              {.mesh = mesh,
                               .file_x = file_x,
                               .x = model_.x0,
                               .used = used,
                               .first = first},
                              name);
    }

    Status add_tets(std::size_t index,
                    const Mesh& mesh,
                    int first,
                    const std::string& name) {
        const Body& body = scene_.bodies[index];
        const Material& material = body.material;
        const auto lame = lame_parameters(static_cast<ElasticModel>(material.model),
                                          material.young,
                                          material.poisson,
                                          material.gipc_lame);
        for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
            Int4 tet = mesh.tets[t];
            for (int& v : tet.v)
                v += first;
            const auto at = [&](int k) {
                return model_.x0[static_cast<std::size_t>(tet[k])];
            };
            const Mat3d dm = from_columns(at(1) - at(0), at(2) - at(0), at(3) - at(0));
            const double volume = det(dm) / 6.0;
            if (!(volume > 0.0))
                return Error{
                    Error::Code::BadMesh,
                    body_place(scene_, index) + "/mesh",
                    fmt::format(
                        "tetrahedron {} of body \"{}\" has volume {:g} m^3 after the "
                        "transform, expected > 0; set \"fix_orientation\": true or "
                        "repair the mesh",
                        t,
                        name,
                        volume)};
            model_.tets.push_back(tet);
            model_.dm_inv.push_back(inverse(dm));
            model_.volume.push_back(volume);
            model_.mu.push_back(lame.mu);
            model_.lambda.push_back(lame.lambda);
            elastic_model_.push_back(static_cast<int>(material.model));
            for (const int v : tet.v)
                model_.mass[static_cast<std::size_t>(v)] +=
                    0.25 * material.density * volume;
        }
        return Done{};
    }

    /// Vertices without an element stay where they are. The check of the mesh has warned
    /// of them.
    void set_aside_unreferenced(const std::vector<std::uint8_t>& used, int first) {
        for (std::size_t v = 0; v < used.size(); ++v) {
            if (used[v] != 0) continue;
            model_.obstacle[static_cast<std::size_t>(first) + v] = 1;
            model_.unreferenced.push_back(first + static_cast<int>(v));
        }
    }

    void add_surface(const Mesh& mesh, int first) {
        const std::vector<Int3> triangles =
            mesh.tets.empty() ? mesh.triangles : boundary_triangles(mesh.tets);
        std::vector<Int2> edges = unique_edges(triangles);
        const std::size_t num_triangle_edges = edges.size();
        if (mesh.tets.empty())
            edges.insert(edges.end(), mesh.segments.begin(), mesh.segments.end());
        std::vector<std::uint8_t> used(mesh.x.size(), 0);
        for (const Int3& t : triangles) {
            model_.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            for (const int v : t.v)
                used[static_cast<std::size_t>(v)] = 1;
        }
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const Int2 edge{edges[e][0] + first, edges[e][1] + first};
            const Vec3d d = model_.x0[static_cast<std::size_t>(edge[1])]
                          - model_.x0[static_cast<std::size_t>(edge[0])];
            model_.edges.push_back(edge);
            model_.edge_rest_sq.push_back(norm_sq(d));
            if (e >= num_triangle_edges) model_.segments.push_back(edge);
            used[static_cast<std::size_t>(edges[e][0])] = 1;
            used[static_cast<std::size_t>(edges[e][1])] = 1;
        }
        if (mesh.tets.empty()) used = referenced_vertices(mesh);
        for (std::size_t v = 0; v < used.size(); ++v)
            if (used[v] != 0)
                model_.surface_vertices.push_back(first + static_cast<int>(v));
    }

    void add_velocity(const Body& body,
                      const std::vector<std::uint8_t>& used,
                      int first) {
        const Vec3d spin =
            (std::numbers::pi / 180.0) * to_vec3(body.angular_velocity_deg);
        const Vec3d center = used_box_center(model_.x0, first, used);
        for (int v = first; v < model_.num_vertices; ++v) {
            const bool moves = model_.obstacle[static_cast<std::size_t>(v)] == 0;
            const Vec3d arm = model_.x0[static_cast<std::size_t>(v)] - center;
            model_.v0.push_back(moves ? to_vec3(body.velocity) + cross(spin, arm)
                                      : Vec3d{0, 0, 0});
        }
    }

    Status add_conditions(std::size_t index,
                          const PlacedBody& placed,
                          const std::string& name) {
        const Body& body = scene_.bodies[index];
        for (std::size_t c = 0; c < body.boundary.size(); ++c) {
            const std::string place =
                fmt::format("{}/boundary/{}", body_place(scene_, index), c);
            Result<ModelCondition> made = make_condition(body.boundary[c], placed, place);
            if (!made) return made.error();
            made.value().body = model_.num_bodies() - 1;
            if (made.value().vertices.empty())
                warn(place, fmt::format("selects no vertex of body \"{}\"", name));
            else
                model_.conditions.push_back(std::move(made.value()));
        }
        return Done{};
    }

    /// Orders tetrahedra by elastic model, stably, so that a SIMD pack holds one model
    /// only.
    void sort_tets() {
        std::vector<int>& order = source_;
        order.resize(model_.tets.size());
        for (std::size_t t = 0; t < order.size(); ++t)
            order[t] = static_cast<int>(t);
        const auto model_of = [&](int t) {
            return elastic_model_[static_cast<std::size_t>(t)];
        };
        std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
            return model_of(a) < model_of(b);
        });
        const auto permute = [&](auto& items) {
            auto sorted = items;
            for (std::size_t k = 0; k < order.size(); ++k)
                sorted[k] = items[static_cast<std::size_t>(order[k])];
            items = std::move(sorted);
        };
        permute(model_.tets);
        permute(model_.dm_inv);
        permute(model_.volume);
        permute(model_.mu);
        permute(model_.lambda);
        model_.model_begin.fill(static_cast<int>(order.size()));
        for (int m = 0; m < kNumElasticModels; ++m)
            model_.model_begin[static_cast<std::size_t>(m)] =
                static_cast<int>(std::count_if(
                    order.begin(), order.end(), [&](int t) { return model_of(t) < m; }));
    }

    void warn(const std::string& where, const std::string& message) {
        warnings_.push_back({where, message});
    }

    const Scene& scene_;
    std::vector<SceneWarning> warnings_;
    Model model_;
    std::vector<std::size_t> source_body_;  // index in scene.bodies of each body
    std::vector<int> elastic_model_;        // per tet, before sorting
    std::vector<int> source_;
};

}  // namespace

std::vector<Vec3d> Model::places() const {
    std::vector<Vec3d> out = x0;
    const auto stray = [&](int v) {
        return std::binary_search(unreferenced.begin(), unreferenced.end(), v);
    };
    int stand_in = 0;
    while (stand_in < num_vertices && stray(stand_in))
        ++stand_in;
    if (stand_in < num_vertices)
        for (const int v : unreferenced)
            out[static_cast<std::size_t>(v)] = x0[static_cast<std::size_t>(stand_in)];
    return out;
}

Result<Model> build_model(const Scene& scene, std::vector<SceneWarning>* warnings) {
    const auto finish = [&](Builder& builder, const Vec3d& origin) {
        if (warnings != nullptr)
            warnings->insert(
                warnings->end(), builder.warnings().begin(), builder.warnings().end());
        return builder.finish(origin);
    };
    Builder builder(scene);
    if (Status placed = builder.place(); !placed) return placed.error();
    const Vec3d origin = local_origin(builder.model());
    if (max_abs(origin) == 0.0) return finish(builder, origin);
    const Scene near_zero = moved_to(origin, scene);
    Builder again(near_zero);
    if (Status placed = again.place(); !placed) return placed.error();
    return finish(again, origin);
}

}  // namespace noli
