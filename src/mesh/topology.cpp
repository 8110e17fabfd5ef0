// SPDX-License-Identifier: Apache-2.0
#include "mesh/topology.hpp"

#include "mesh/faces.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <tuple>

namespace noli {

namespace {

template <class Element>
constexpr int kCorners = sizeof(Element) / sizeof(int);

template <class Element>
std::vector<Int2> sorted_edges(const std::vector<Element>& elements) {
    std::vector<std::pair<int, int>> edges;
    edges.reserve(elements.size() * 6);
    for (const Element& e : elements)
        for (int i = 0; i < kCorners<Element>; ++i)
            for (int j = i + 1; j < kCorners<Element>; ++j)
                edges.emplace_back(std::minmax(e[i], e[j]));
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    std::vector<Int2> out;
    out.reserve(edges.size());
    for (const auto& [a, b] : edges)
        out.push_back({a, b});
    return out;
}

template <class Element>
std::vector<int> sorted_vertices(const std::vector<Element>& elements) {
    std::vector<int> out;
    out.reserve(elements.size() * kCorners<Element>);
    for (const Element& e : elements)
        out.insert(out.end(), e.v, e.v + kCorners<Element>);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

/// Union-find; the root of a set is its smallest member.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t n) : parent_(n) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    int root(int i) {
        while (parent_[static_cast<std::size_t>(i)] != i) {
            int& up = parent_[static_cast<std::size_t>(i)];
            up = parent_[static_cast<std::size_t>(up)];
            i = up;
        }
        return i;
    }

    template <class Element>
    void join(const std::vector<Element>& elements) {
        for (const Element& e : elements)
            for (int k = 1; k < kCorners<Element>; ++k) {
                const auto [lo, hi] = std::minmax({root(e[0]), root(e[k])});
                parent_[static_cast<std::size_t>(hi)] = lo;
            }
    }

  private:
    std::vector<int> parent_;
};

template <class Element>
void renumber(std::vector<Element>& elements, const std::vector<int>& new_index) {
    for (Element& e : elements)
        for (int& v : e.v)
            v = new_index[static_cast<std::size_t>(v)];
}

}  // namespace

/// Sorting by the smallest corner with one counting pass leaves only short runs for
/// std::sort.
std::vector<detail::FaceUse> detail::sorted_faces(const std::vector<Int4>& tets) {
    int num_vertices = 0;
    for (const Int4& t : tets)
        num_vertices = std::max(num_vertices, 1 + *std::max_element(t.v, t.v + 4));
    const auto make_face = [&](std::size_t t, int k) {
        const auto& f = kTetFaces[k];
        int a = tets[t][f[0]], b = tets[t][f[1]], c = tets[t][f[2]];
        bool even = true;
        const auto sort_two = [&even](int& lo, int& hi) {
            if (lo <= hi) return;
            std::swap(lo, hi);
            even = !even;
        };
        sort_two(a, b);
        sort_two(b, c);
        sort_two(a, b);
        return FaceUse{{a, b, c}, static_cast<int>(4 * t) + k, even};
    };
    std::vector<std::size_t> start(static_cast<std::size_t>(num_vertices) + 1, 0);
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int k = 0; k < 4; ++k)
            ++start[static_cast<std::size_t>(make_face(t, k).key[0]) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<FaceUse> faces(4 * tets.size());
    std::vector<std::size_t> fill(start.begin(), start.end() - 1);
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int k = 0; k < 4; ++k) {
            const FaceUse face = make_face(t, k);
            faces[fill[static_cast<std::size_t>(face.key[0])]++] = face;
        }
    for (std::size_t v = 0; v + 1 < start.size(); ++v)
        std::sort(faces.begin() + static_cast<long>(start[v]),
                  faces.begin() + static_cast<long>(start[v + 1]),
                  [](const FaceUse& a, const FaceUse& b) {
                      return std::tie(a.key[1], a.key[2], a.index)
                           < std::tie(b.key[1], b.key[2], b.index);
                  });
    return faces;
}

std::vector<Int3> boundary_triangles(const std::vector<Int4>& tets) {
    std::vector<int> kept;
    detail::for_each_face_group(
        detail::sorted_faces(tets),
        [&](const detail::FaceUse* begin, const detail::FaceUse* end) {
            if (end == begin + 1) kept.push_back(begin->index);
        });
    std::sort(kept.begin(), kept.end());
    std::vector<Int3> out;
    out.reserve(kept.size());
    for (const int index : kept) {
        const Int4& tet = tets[static_cast<std::size_t>(index / 4)];
        const auto& face = kTetFaces[index % 4];
        out.push_back({tet[face[0]], tet[face[1]], tet[face[2]]});
    }
    return out;
}

std::vector<Int2> unique_edges(const std::vector<Int3>& triangles) {
    return sorted_edges(triangles);
}
std::vector<Int2> unique_edges(const std::vector<Int4>& tets) {
    return sorted_edges(tets);
}

std::vector<int> used_vertices(const std::vector<Int4>& tets) {
    return sorted_vertices(tets);
}
std::vector<int> used_vertices(const std::vector<Int3>& triangles) {
    return sorted_vertices(triangles);
}
std::vector<int> used_vertices(const std::vector<Int2>& segments) {
    return sorted_vertices(segments);
}

std::vector<std::uint8_t> referenced_vertices(const Mesh& mesh) {
    const MeshRole role = natural_role(mesh);
    const bool cloud = role == MeshRole::Points && mesh.points.empty();
    std::vector<std::uint8_t> used(mesh.x.size(), cloud ? 1 : 0);
    const auto mark = [&](const auto& elements) {
        for (const auto& e : elements)
            for (const int v : e.v)
                used[static_cast<std::size_t>(v)] = 1;
    };
    mark(mesh.tets);
    if (role == MeshRole::Solid) return used;
    mark(mesh.triangles);
    mark(mesh.segments);
    for (const int v : mesh.points)
        used[static_cast<std::size_t>(v)] = 1;
    return used;
}

std::vector<Int2> loose_segments(const Mesh& mesh) {
    std::vector<std::pair<int, int>> edges;
    for (const Int2& e : unique_edges(mesh.triangles))
        edges.emplace_back(e[0], e[1]);  // sorted, the smaller end first
    std::vector<Int2> loose;
    std::copy_if(mesh.segments.begin(),
                 mesh.segments.end(),
                 std::back_inserter(loose),
                 [&](const Int2& s) {
                     const std::pair<int, int> ends = std::minmax(s[0], s[1]);
                     return !std::binary_search(edges.begin(), edges.end(), ends);
                 });
    return loose;
}

std::vector<int> first_equal_vertex(const std::vector<Vec3d>& x) {
    std::vector<int> order(x.size());
    std::iota(order.begin(), order.end(), 0);
    const auto at = [&](int i) -> const Vec3d& { return x[static_cast<std::size_t>(i)]; };
    std::sort(order.begin(), order.end(), [&](int i, int j) {
        const Vec3d &a = at(i), &b = at(j);
        return std::tie(a.x, a.y, a.z, i) < std::tie(b.x, b.y, b.z, j);
    });
    std::vector<int> first(x.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        const Vec3d& a = at(order[k]);
        const bool same = k > 0 && a.x == at(order[k - 1]).x && a.y == at(order[k - 1]).y
                       && a.z == at(order[k - 1]).z;
        first[static_cast<std::size_t>(order[k])] =
            same ? first[static_cast<std::size_t>(order[k - 1])] : order[k];
    }
    return first;
}

Components connected_components(const Mesh& mesh) {
    DisjointSets sets(mesh.x.size());
    sets.join(mesh.tets);
    sets.join(mesh.triangles);
    sets.join(mesh.segments);
    Components out;
    out.of_vertex.resize(mesh.x.size());
    for (std::size_t i = 0; i < mesh.x.size(); ++i) {
        const int root = sets.root(static_cast<int>(i));  // <= i, so already numbered
        out.of_vertex[i] = root == static_cast<int>(i)
                             ? out.count++
                             : out.of_vertex[static_cast<std::size_t>(root)];
    }
    return out;
}

std::vector<double> tet_volumes(const Mesh& mesh) {
    std::vector<double> out;
    out.reserve(mesh.tets.size());
    const auto at = [&](int i) -> const Vec3d& {
        return mesh.x[static_cast<std::size_t>(i)];
    };
    for (const Int4& t : mesh.tets)
        out.push_back(tet_volume(at(t[0]), at(t[1]), at(t[2]), at(t[3])));
    return out;
}

std::vector<int> drop_unreferenced_vertices(Mesh& mesh) {
    std::vector<int> new_index(mesh.x.size(), -1);
    const auto mark = [&](const auto& elements) {
        for (const auto& e : elements)
            for (const int v : e.v)
                new_index[static_cast<std::size_t>(v)] = 0;
    };
    mark(mesh.tets);
    mark(mesh.triangles);
    mark(mesh.segments);
    for (const int v : mesh.points)
        new_index[static_cast<std::size_t>(v)] = 0;
    std::vector<int> kept;
    for (std::size_t i = 0; i < mesh.x.size(); ++i) {
        if (new_index[i] < 0) continue;
        new_index[i] = static_cast<int>(kept.size());
        mesh.x[kept.size()] = mesh.x[i];
        kept.push_back(static_cast<int>(i));
    }
    mesh.x.resize(kept.size());
    renumber(mesh.tets, new_index);
    renumber(mesh.triangles, new_index);
    renumber(mesh.segments, new_index);
    for (int& v : mesh.points)
        v = new_index[static_cast<std::size_t>(v)];
    return kept;
}

}  // namespace noli
