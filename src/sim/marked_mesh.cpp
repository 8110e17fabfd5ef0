// SPDX-License-Identifier: Apache-2.0
#include "sim/marked_mesh.hpp"

#include "model/origin.hpp"
#include "output/file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <set>

namespace noli {

namespace {

/// Vertices of the edges that pierce something: their triangles are red too.
std::set<std::array<int, 2>> piercing_edges(const VerifyReport& found) {
    std::set<std::array<int, 2>> edges;
    for (const ExactIntersection& hit : found.intersections)
        edges.insert(
            {std::min(hit.edge[0], hit.edge[1]), std::max(hit.edge[0], hit.edge[1])});
    return edges;
}

/// Vertices beyond half-spaces or containers.
std::set<int> vertices_beyond(const VerifyReport& found) {
    std::set<int> vertices;
    for (const BeyondWall& at : found.beyond_walls)
        vertices.insert(at.vertices.begin(), at.vertices.end());
    return vertices;
}

bool has_vertex(const std::set<int>& vertices, const Int3& t) {
    return vertices.count(t[0]) + vertices.count(t[1]) + vertices.count(t[2]) > 0;
}

bool has_edge(const std::set<std::array<int, 2>>& edges, const Int3& t) {
    for (int k = 0; k < 3; ++k) {
        const int a = t[k];
        const int b = t[(k + 1) % 3];
        if (edges.count({std::min(a, b), std::max(a, b)}) > 0) return true;
    }
    return false;
}

}  // namespace

Status write_marked_mesh(const std::string& path,
                         const Model& model,
                         const VerifyReport& found) {
    const std::set<std::array<int, 2>> edges = piercing_edges(found);
    const std::set<int> beyond = vertices_beyond(found);
    std::set<std::array<int, 3>> pierced;
    for (const ExactIntersection& hit : found.intersections)
        pierced.insert(hit.triangle);

    std::string text = fmt::format(
        "ply\nformat ascii 1.0\ncomment red: triangles that intersect\nelement vertex "
        "{}\n"
        "property double x\nproperty double y\nproperty double z\nelement face {}\n"
        "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar "
        "green\n"
        "property uchar blue\nend_header\n",
        model.x0.size(),
        model.triangles.size());
    for (const Vec3d& local : model.x0) {
        const Vec3d p = in_world(model, local);
        fmt::format_to(std::back_inserter(text), "{} {} {}\n", p.x, p.y, p.z);
    }
    for (const Int3& t : model.triangles) {
        const bool red = pierced.count({t[0], t[1], t[2]}) > 0 || has_edge(edges, t)
                      || has_vertex(beyond, t);
        fmt::format_to(std::back_inserter(text),
                       "3 {} {} {} {}\n",
                       t[0],
                       t[1],
                       t[2],
                       red ? "220 30 30" : "190 190 190");
    }
    return write_file(path, text);
}

}  // namespace noli
