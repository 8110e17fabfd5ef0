// SPDX-License-Identifier: Apache-2.0
#include "sim/beyond_walls.hpp"

#include "model/origin.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <utility>

namespace noli {

namespace {

std::string describe_place(const Vector3& at) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", at[0], at[1], at[2]);
}

/// What puts the vertices back where they may be.
std::string cure(const Model& model, const Wall& wall, double depth) {
    // By how much more than the depth a gap is one at which nothing pushes.
    const double shift = depth + model.dhat + model.min_separation;
    if (wall.shape != WallShape::HalfSpace)
        return fmt::format(
            "move or shrink the body, or make the radius larger by {:.3g} m", shift);
    return fmt::format("move the body by {:.3g} m along {}, or the half-space back",
                       shift,
                       describe_place({wall.normal.x, wall.normal.y, wall.normal.z}));
}

std::string describe(const Model& model, const BeyondWall& found, const Wall& wall) {
    const bool plane = wall.shape == WallShape::HalfSpace;
    const std::string who =
        found.vertices.size() == 1
            ? fmt::format("vertex {} of \"{}\" is", found.deepest, found.body)
            : fmt::format("{} vertices of \"{}\" are", found.vertices.size(), found.body);
    const std::string which =
        found.vertices.size() == 1 ? "" : fmt::format("vertex {} ", found.deepest);
    return fmt::format("{} {} {}: {}at {}, {:.6g} m deep; {}",
                       who,
                       plane ? "behind" : "outside of",
                       found.wall,
                       which.empty() ? "" : "the deepest is " + which,
                       describe_place(found.place),
                       found.depth,
                       cure(model, wall, found.depth));
}

}  // namespace

std::vector<BeyondWall> beyond_walls(const Model& model,
                                     const std::vector<VertexBehindWall>& hits,
                                     const std::vector<Vec3d>& x) {
    std::map<std::pair<int, int>, BeyondWall> found;
    for (const VertexBehindWall& hit : hits) {
        const int body = model.body[static_cast<std::size_t>(hit.vertex)];
        BeyondWall& at = found[{body, hit.wall}];
        const double depth = std::max(0.0, -hit.distance);
        if (at.vertices.empty() || depth > at.depth) {
            const Vec3d place = in_world(model, x[static_cast<std::size_t>(hit.vertex)]);
            at.deepest = hit.vertex;
            at.depth = depth;
            at.place = {place.x, place.y, place.z};
        }
        at.vertices.push_back(hit.vertex);
    }
    std::vector<BeyondWall> out;
    for (auto& [who, at] : found) {
        at.body = model.body_names[static_cast<std::size_t>(who.first)];
        at.wall = describe_wall(model, who.second);
        at.message =
            describe(model, at, model.walls[static_cast<std::size_t>(who.second)].wall);
        out.push_back(std::move(at));
    }
    return out;
}

std::string describe_beyond_walls(const std::vector<BeyondWall>& found) {
    if (found.empty()) return "";
    std::string message = found.front().message;
    if (found.size() > 1)
        message += fmt::format(" (and {} more bodies at walls)", found.size() - 1);
    return message;
}

std::string describe_too_close(const Model& model, const MinGap& pair) {
    const auto body = [&](int v) {
        return model.body_names[static_cast<std::size_t>(
            model.body[static_cast<std::size_t>(v)])];
    };
    using Kind = MinGap::Kind;
    const Int4& v = pair.vertices;
    const bool edges = pair.kind == Kind::EdgeEdge || pair.kind == Kind::Mollified;
    const std::string other = pair.kind == Kind::Wall
                                ? describe_wall(model, v[1])
                                : fmt::format("\"{}\"", body(v[edges ? 2 : 1]));
    return fmt::format(
        "\"{}\" at vertex {} and {} are {:.6g} m apart, expected more than "
        "contact/min_separation = {:g} m; move them apart or reduce it",
        body(v[0]),
        v[0],
        other,
        pair.gap,
        model.min_separation);
}

}  // namespace noli
