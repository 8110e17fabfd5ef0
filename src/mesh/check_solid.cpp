// SPDX-License-Identifier: Apache-2.0
#include "mesh/checker.hpp"
#include "mesh/faces.hpp"
#include "mesh/topology.hpp"

#include <cmath>

namespace noli::detail {

void Checker::check_tet_shapes() {
    Tally inverted, degenerate, poor;
    double poor_ratio = 0;
    for (std::size_t e = 0; e < mesh_.tets.size(); ++e) {
        const Int4& t = mesh_.tets[e];
        const double shape = relative_volume(x(t[0]), x(t[1]), x(t[2]), x(t[3]));
        if (std::fabs(shape) <= options_.degenerate_below) {
            degenerate.add(e);
        } else if (shape < 0.0) {
            inverted.add(e);
        } else if (const double ratio = radius_ratio(x(t[0]), x(t[1]), x(t[2]), x(t[3]));
                   ratio < options_.poor_below) {
            if (poor.count == 0) poor_ratio = ratio;
            poor.add(e);
        }
    }
    if (degenerate.count > 0) {
        const Int4& t = mesh_.tets[static_cast<std::size_t>(degenerate.first)];
        double longest = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                longest = std::max(longest, norm(x(t[i]) - x(t[j])));
        error(Kind::Degenerate,
              degenerate,
              fmt::format("has {} degenerate tetrahedra (first: {}, volume {:.3g} m^3, "
                          "longest edge {:.3g} m); "
                          "remove flat elements or mesh again with a quality bound",
                          degenerate.count,
                          degenerate.first,
                          tet_volume(x(t[0]), x(t[1]), x(t[2]), x(t[3])),
                          longest));
    }
    if (inverted.count > 0)
        error(Kind::Inverted,
              inverted,
              fmt::format("has {} inverted tetrahedra (first: {}); flip them or set "
                          "\"fix_orientation\": true",
                          inverted.count,
                          inverted.first));
    if (poor.count > 0)
        warn(Kind::PoorShape,
             poor,
             fmt::format("has {} tetrahedra of poor shape (first: {}, radius ratio "
                         "{:.2g}); expect small steps, "
                         "or mesh again with a quality bound",
                         poor.count,
                         poor.first,
                         poor_ratio));
}

/// Faces with more than two tetrahedra, or with two on the same side.
void Checker::check_tet_faces() {
    Tally bad;
    int first = static_cast<int>(mesh_.tets.size());
    detail::for_each_face_group(
        detail::sorted_faces(mesh_.tets),
        [&](const detail::FaceUse* begin, const detail::FaceUse* end) {
            const auto uses = end - begin;
            if (uses < 2 || (uses == 2 && begin[0].even != begin[1].even)) return;
            bad.add(0);
            first = std::min(first, begin->index / 4);
        });
    bad.first = first;
    if (bad.count > 0)
        error(Kind::OverlappingTets,
              bad,
              fmt::format("has {} faces with more than two tetrahedra or with two on one "
                          "side (first at "
                          "tetrahedron {}): elements overlap; remove doubled elements or "
                          "mesh again",
                          bad.count,
                          bad.first));
}

void Checker::check_solid() {
    check_tet_shapes();
    check_duplicate_elements(mesh_.tets, Severity::Error);
    const bool well_turned = report_.ok();
    if (well_turned)
        check_tet_faces();  // says nothing new about doubled or inverted tetrahedra
    const std::vector<Int3> surface = boundary_triangles(mesh_.tets);
    check_edges_of(surface, "its boundary has ");
    check_vertices_of(surface, "its boundary has ");
}

}  // namespace noli::detail
