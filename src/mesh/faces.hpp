// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The faces of tetrahedra, grouped so that equal ones are neighbours.

#include "mesh/mesh.hpp"

#include <array>
#include <vector>

namespace noli::detail {

struct FaceUse {
    std::array<int, 3> key;  ///< corners, sorted
    int index;               ///< 4 tetrahedron + local face (kTetFaces)
    bool even;               ///< seen from outside, the corners turn like the key
};

/// All faces of all tetrahedra, sorted by (key, index).
std::vector<FaceUse> sorted_faces(const std::vector<Int4>& tets);

/// Calls f(begin, end) for each run of faces with equal keys.
template <class F>
void for_each_face_group(const std::vector<FaceUse>& faces, F f) {
    for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
        for (end = i + 1; end < faces.size() && faces[end].key == faces[i].key;)
            ++end;
        f(faces.data() + i, faces.data() + end);
    }
}

}  // namespace noli::detail
