// SPDX-License-Identifier: Apache-2.0
#include "mesh/check.hpp"

#include "mesh/checker.hpp"
#include "mesh/topology.hpp"

#include <cmath>

namespace noli {

namespace detail {

/// The elements that the role uses, on all vertices.
Mesh only_role(Mesh mesh, MeshRole role) {
    if (role != MeshRole::Solid) mesh.tets.clear();
    if (role != MeshRole::Surface) mesh.triangles.clear();
    if (role == MeshRole::Solid || role == MeshRole::Points) mesh.segments.clear();
    if (role == MeshRole::Solid) mesh.points.clear();
    return mesh;
}

void Checker::check_not_empty() {
    const std::size_t counts[] = {
        mesh_.tets.size(), mesh_.triangles.size(), mesh_.segments.size(), mesh_.x.size()};
    if (counts[static_cast<int>(role_)] > 0) return;
    const char* cures[] = {
        "; mesh its inside first, for example with Gmsh or TetGen, or use it as an "
        "obstacle",
        "; export the surface, or use a file with triangles",
        "; add \"s i j\" lines or use a file with edges",
        "; use a file with points"};
    error(
        Kind::Empty,
        {-1, 1},
        fmt::format(
            "has {} vertices, {} tetrahedra, {} triangles and {} segments, expected {}{}",
            counts[3],
            counts[0],
            counts[1],
            counts[2],
            element_name(role_),
            cures[static_cast<int>(role_)]));
}

void Checker::check_finite() {
    Tally bad;
    for (std::size_t i = 0; i < mesh_.x.size(); ++i) {
        const Vec3d& p = mesh_.x[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) bad.add(i);
    }
    if (bad.count == 0) return;
    const Vec3d& p = x(bad.first);
    error(Kind::NonFinite,
          bad,
          fmt::format("has {} vertices that are not finite (first: {} at ({}, {}, {})); "
                      "the program that made "
                      "them failed there: correct or remove them",
                      bad.count,
                      bad.first,
                      p.x,
                      p.y,
                      p.z));
}

template <class Element>
void Checker::check_indices(const std::vector<Element>& elements) {
    Tally outside, repeated;
    int bad_vertex = 0;
    const auto n = static_cast<int>(mesh_.x.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        bool repeats = false;
        for (int i = 0; i < kCorners<Element>; ++i) {
            const int v = elements[e][i];
            if (v < 0 || v >= n) {
                if (outside.count == 0) bad_vertex = v;
                outside.add(e);
                break;
            }
            for (int j = 0; j < i; ++j)
                repeats |= v == elements[e][j];
        }
        if (repeats) repeated.add(e);
    }
    const char* name = name_of<Element>();
    if (outside.count > 0)
        error(Kind::IndexOutOfRange,
              outside,
              fmt::format("{} {} uses vertex {}, expected 0 to {} ({} such elements); "
                          "correct the element or "
                          "write the mesh again",
                          name,
                          outside.first,
                          bad_vertex,
                          n - 1,
                          outside.count));
    if (repeated.count > 0)
        error(Kind::RepeatedVertex,
              repeated,
              fmt::format("{} {} uses a vertex twice ({} such elements); remove "
                          "collapsed elements or mesh again",
                          name,
                          repeated.first,
                          repeated.count));
}

void Checker::check_points() {
    const auto n = static_cast<int>(mesh_.x.size());
    Tally outside;
    for (std::size_t i = 0; i < mesh_.points.size(); ++i)
        if (mesh_.points[i] < 0 || mesh_.points[i] >= n) outside.add(i);
    if (outside.count > 0)
        error(Kind::IndexOutOfRange,
              outside,
              fmt::format("point {} is vertex {}, expected 0 to {}; correct it or write "
                          "the mesh again",
                          outside.first,
                          mesh_.points[static_cast<std::size_t>(outside.first)],
                          n - 1));
}

void Checker::check_duplicate_vertices() {
    const std::vector<int> first = first_equal_vertex(mesh_.x);
    Tally twice;
    for (std::size_t i = 0; i < first.size(); ++i)
        if (first[i] != static_cast<int>(i)) twice.add(i);
    if (twice.count == 0) return;
    const int original = first[static_cast<std::size_t>(twice.first)];
    report(options_.duplicate_vertices_are_errors ? Severity::Error : Severity::Warning,
           Kind::DuplicateVertex,
           twice,
           fmt::format("has {} vertices at the place of another (first: {}, like {}): "
                       "parts that look joined are "
                       "not; merge them if they should be",
                       twice.count,
                       twice.first,
                       original));
}

void Checker::check_unreferenced() {
    const std::vector<std::uint8_t> used = referenced_vertices(only_role(mesh_, role_));
    Tally unused;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i] == 0) unused.add(i);
    const bool drops = role_ == MeshRole::Solid && options_.drop_unreferenced;
    if (unused.count > 0)
        warn(Kind::UnreferencedVertex,
             unused,
             fmt::format("has {} vertices that no {} uses (first: {}); {}",
                         unused.count,
                         role_ == MeshRole::Solid      ? "tetrahedron"
                         : role_ == MeshRole::Surface  ? "triangle"
                         : role_ == MeshRole::Segments ? "segment"
                                                       : "point",
                         unused.first,
                         drops ? "they are dropped and the others renumbered: remove "
                                 "them from the file to keep "
                                 "vertex numbers"
                               : "they have no part in the body and stay where they are: "
                                 "remove them if they were not meant"));
}

MeshReport Checker::run() {
    check_not_empty();
    check_finite();
    switch (role_) {
        case MeshRole::Solid:
            check_indices(mesh_.tets);
            break;
        case MeshRole::Surface:
            check_indices(mesh_.triangles);
            check_indices(mesh_.segments);
            break;
        case MeshRole::Segments:
            check_indices(mesh_.segments);
            break;
        case MeshRole::Points:
            break;
    }
    if (role_ != MeshRole::Solid) check_points();
    if (!report_.ok())
        return std::move(report_);  // the rest would read out of bounds or NaN
    if (role_ == MeshRole::Solid) check_solid();
    if (role_ == MeshRole::Surface) check_surface();
    if (role_ == MeshRole::Surface || role_ == MeshRole::Segments) check_segments();
    check_duplicate_vertices();
    check_unreferenced();
    report_.quality = mesh_quality(only_role(mesh_, role_));
    return std::move(report_);
}

}  // namespace detail

namespace {

void flip_inverted(Mesh& mesh) {
    const auto n = static_cast<int>(mesh.x.size());
    for (Int4& t : mesh.tets) {
        const bool in_range =
            std::all_of(t.v, t.v + 4, [n](int v) { return v >= 0 && v < n; });
        if (!in_range) continue;
        const auto at = [&](int k) { return mesh.x[static_cast<std::size_t>(t[k])]; };
        if (tet_volume(at(0), at(1), at(2), at(3)) < 0.0) std::swap(t[2], t[3]);
    }
}

}  // namespace

MeshReport check_mesh(const Mesh& mesh, MeshRole role, const CheckOptions& options) {
    return detail::Checker(mesh, role, options).run();
}

Result<Mesh> checked(Mesh mesh,
                     const std::string& file,
                     MeshRole role,
                     const CheckOptions& options,
                     MeshReport* report) {
    if (options.fix_orientation && role == MeshRole::Solid) flip_inverted(mesh);
    MeshReport found = check_mesh(mesh, role, options);
    mesh = detail::only_role(std::move(mesh), role);
    const std::size_t num_errors = found.errors.size();
    Error error{
        Error::Code::BadMesh, file, num_errors > 0 ? found.errors.front().message : ""};
    if (num_errors > 1)
        error.message += fmt::format(" (and {} more kinds of error)", num_errors - 1);
    if (num_errors == 0 && role == MeshRole::Solid && options.drop_unreferenced) {
        const std::size_t before = mesh.x.size();
        found.kept_vertices = drop_unreferenced_vertices(mesh);
        if (found.kept_vertices.size() == before) found.kept_vertices.clear();
    }
    if (report != nullptr) *report = std::move(found);
    if (num_errors > 0) return error;
    return mesh;
}

}  // namespace noli
