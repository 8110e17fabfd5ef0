// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A prism between triangles a and b (a[i] joined to b[i]) as three tetrahedra. Each quad
/// between the columns i and j is cut by the diagonal from a of the lower rank to b of
/// the higher one: neighbours that rank shared columns alike agree on every face.

#include "mesh/mesh.hpp"

#include <utility>

namespace noli::detail {

/// order: the columns by rising rank. A column may be a single vertex (a[i] == b[i]);
/// flat tetrahedra are left out. The orientation is the caller's business.
inline void split_prism(const int (&a)[3],
                        const int (&b)[3],
                        const int (&order)[3],
                        std::vector<Int4>& out) {
    const int r0 = order[0], r1 = order[1], r2 = order[2];
    if (a[r2] != b[r2]) out.push_back({a[r0], a[r1], a[r2], b[r2]});
    if (a[r1] != b[r1]) out.push_back({a[r0], a[r1], b[r1], b[r2]});
    if (a[r0] != b[r0]) out.push_back({a[r0], b[r0], b[r1], b[r2]});
}

/// Exchanges two corners of each tetrahedron with negative volume.
inline void orient_positive(Mesh& mesh) {
    for (Int4& t : mesh.tets) {
        const auto at = [&](int k) { return mesh.x[static_cast<std::size_t>(t[k])]; };
        if (dot(cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0)) < 0.0)
            std::swap(t[2], t[3]);
    }
}

}  // namespace noli::detail
