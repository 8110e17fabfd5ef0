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

/// The box of a vertex, grown by `gap` (m).
template <class Box>
NOLI_HD inline Box box_around(const Motion& motion, int vertex, double gap) {
    Box box;
    make_empty(box);
    add_vertex(box, motion, vertex, gap);
    return box;
}

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
        plain[v] = box_around<Box>(motion, v, 0.0);
        grown[v] = box_around<Box>(motion, v, gap);
    });
}

}  // namespace noli::detail
