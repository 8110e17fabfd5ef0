// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Boxes of the vertices of a mesh, of which those of edges and triangles are made.

#include "contact/moving_box.hpp"
#include "core/view.hpp"

namespace noli::detail {

/// Boxes that are computed where they are needed, grown by `gap` (m) on all sides.
template <class Box>
struct MotionBoxes {
    Motion motion;
    double gap;

    NOLI_HD void add_to(Box& box, int vertex) const {
        add_vertex(box, motion, vertex, gap);
    }
};

/// Boxes in an array (num_vertices).
template <class Box>
struct KnownBoxes {
    View<const Box> boxes;

    NOLI_HD void add_to(Box& box, int vertex) const { merge_into(box, boxes[vertex]); }
};

/// Of the surface's vertices: plain[v] as they are, grown[v] by `gap` (m).
template <class Exec, class Box>
void vertex_boxes(Exec& exec,
                  View<const int> vertices,
                  Motion motion,
                  double gap,
                  View<Box> plain,
                  View<Box> grown) {
    exec.for_each("contact/vertex_boxes", vertices.size, [=] NOLI_HD(int i) {
        const int v = vertices[i];
        make_empty(plain[v]);
        make_empty(grown[v]);
        add_vertex(plain[v], motion, v, 0.0);
        add_vertex(grown[v], motion, v, gap);
    });
}

}  // namespace noli::detail
