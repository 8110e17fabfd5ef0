// SPDX-License-Identifier: Apache-2.0
#include "output/surface.hpp"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>

namespace noli {

namespace {

template <class T>
void put(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A body's name as an OBJ object name: no blanks.
std::string obj_name(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '\n'; }, '_');
    return name;
}

}  // namespace

SurfaceWriter::SurfaceWriter(const FrameMesh& mesh)
    : body_names_(mesh.body_names.begin(), mesh.body_names.end()) {
    std::vector<int> place(mesh.body_of_vertex.size(), -1);
    const auto use = [&place](const auto& cell) {
        for (const int v : cell)
            place[static_cast<size_t>(v)] = 0;
    };
    const std::vector<int> points = lone_points(mesh);
    std::for_each(mesh.triangles.begin(), mesh.triangles.end(), use);
    std::for_each(mesh.segments.begin(), mesh.segments.end(), use);
    use(points);
    for (size_t v = 0; v < place.size(); ++v) {
        if (place[v] < 0) continue;
        place[v] = static_cast<int>(vertices_.size());
        vertices_.push_back(static_cast<int>(v));
        body_.push_back(mesh.body_of_vertex[v]);
    }
    const auto moved = [&place](int v) { return place[static_cast<size_t>(v)]; };
    for (const auto& t : mesh.triangles)
        triangles_.push_back({moved(t[0]), moved(t[1]), moved(t[2])});
    for (const auto& s : mesh.segments)
        segments_.push_back({moved(s[0]), moved(s[1])});
    std::transform(points.begin(), points.end(), std::back_inserter(points_), moved);
    // An OBJ object ends where the next begins, so cells of one body must stand together.
    const auto body_order = [this](const auto& a, const auto& b) {
        return body_[static_cast<size_t>(a[0])] < body_[static_cast<size_t>(b[0])];
    };
    std::stable_sort(triangles_.begin(), triangles_.end(), body_order);
    std::stable_sort(segments_.begin(), segments_.end(), body_order);
}

std::string SurfaceWriter::encode_obj(const Frame& frame) const {
    fmt::memory_buffer out;
    const auto to = std::back_inserter(out);
    fmt::format_to(to, "# step {} time {:.17g}\n", frame.step, frame.time);
    for (const int v : vertices_) {
        const Vector3& x = frame.positions[static_cast<size_t>(v)];
        fmt::format_to(to, "v {:.17g} {:.17g} {:.17g}\n", x[0], x[1], x[2]);
    }
    auto triangle = triangles_.begin();
    auto segment = segments_.begin();
    auto point = points_.begin();
    for (size_t body = 0; body < body_names_.size(); ++body) {
        const auto is_here = [&](int v) {
            return body_[static_cast<size_t>(v)] == static_cast<int>(body);
        };
        fmt::format_to(to, "o {}\n", obj_name(body_names_[body]));
        for (; triangle != triangles_.end() && is_here((*triangle)[0]); ++triangle) {
            const auto [a, b, c] = *triangle;
            fmt::format_to(to, "f {} {} {}\n", a + 1, b + 1, c + 1);
        }
        for (; segment != segments_.end() && is_here((*segment)[0]); ++segment)
            fmt::format_to(to, "l {} {}\n", (*segment)[0] + 1, (*segment)[1] + 1);
        for (; point != points_.end() && is_here(*point); ++point)
            fmt::format_to(to, "p {}\n", *point + 1);
    }
    return fmt::to_string(out);
}

std::string SurfaceWriter::encode_ply(const Frame& frame) const {
    const bool has_velocity = frame.velocities.size() == frame.positions.size();
    std::string out = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment step {} time {:.17g}\n"
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
        frame.step,
        frame.time,
        vertices_.size());
    if (has_velocity)
        out += "property double vx\nproperty double vy\nproperty double vz\n";
    out += fmt::format(
        "property int body_id\nelement face {}\nproperty list uchar int vertex_indices\n",
        triangles_.size());
    // Some readers know no edges, so they are only named where there are any.
    if (!segments_.empty())
        out +=
            fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n",
                        segments_.size());
    out += "end_header\n";
    for (size_t i = 0; i < vertices_.size(); ++i) {
        const auto v = static_cast<size_t>(vertices_[i]);
        for (const double coordinate : frame.positions[v])
            put(out, coordinate);
        if (has_velocity)
            for (const double component : frame.velocities[v])
                put(out, component);
        put(out, static_cast<std::int32_t>(body_[i]));
    }
    for (const auto& triangle : triangles_) {
        put(out, std::uint8_t{3});
        for (const int v : triangle)
            put(out, static_cast<std::int32_t>(v));
    }
    for (const auto& segment : segments_)
        for (const int v : segment)
            put(out, static_cast<std::int32_t>(v));
    return out;
}

}  // namespace noli
