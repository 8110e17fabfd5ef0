// SPDX-License-Identifier: Apache-2.0
#include "output/frame.hpp"

#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace noli {

std::vector<bool> elastic_bodies(const FrameMesh& mesh) {
    std::vector<bool> elastic(mesh.body_names.size(), false);
    for (const auto& tet : mesh.tets)
        elastic[static_cast<size_t>(mesh.body_of_vertex[static_cast<size_t>(tet[0])])] =
            true;
    return elastic;
}

std::vector<int> lone_points(const FrameMesh& mesh) {
    std::vector<bool> used(mesh.body_of_vertex.size(), false);
    for (const auto& triangle : mesh.triangles)
        for (const int v : triangle)
            used[static_cast<size_t>(v)] = true;
    for (const auto& segment : mesh.segments)
        for (const int v : segment)
            used[static_cast<size_t>(v)] = true;
    for (const int v : mesh.unreferenced)
        used[static_cast<size_t>(v)] = true;
    const std::vector<bool> elastic = elastic_bodies(mesh);
    std::vector<int> points;
    for (size_t v = 0; v < used.size(); ++v) {
        const auto body = static_cast<size_t>(mesh.body_of_vertex[v]);
        if (!used[v] && !elastic[body]) points.push_back(static_cast<int>(v));
    }
    return points;
}

std::string frame_file_name(int step, const std::string& extension) {
    return fmt::format("frame_{:06}.{}", step, extension);
}

int step_of_frame_file(const std::string& name) {
    constexpr std::string_view kPrefix = "frame_";
    const size_t dot = name.find('.');
    if (!name.starts_with(kPrefix) || dot == std::string::npos) return -1;
    int step = -1;
    const char* end = name.data() + dot;
    const auto parsed = std::from_chars(name.data() + kPrefix.size(), end, step);
    return parsed.ec == std::errc() && parsed.ptr == end ? step : -1;
}

}  // namespace noli
