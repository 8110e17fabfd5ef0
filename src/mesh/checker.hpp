// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The work behind check_mesh, in two files: check_solid.cpp and check_surface.cpp hold
/// the checks of elements, check.cpp the rest.

#include "mesh/check.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>
#include <vector>

namespace noli::detail {

using Kind = MeshIssue::Kind;
using Severity = MeshIssue::Severity;

template <class Element>
constexpr int kCorners = sizeof(Element) / sizeof(int);

/// "tetrahedron", "triangle", "segment".
template <class Element>
const char* name_of() {
    constexpr const char* kNames[] = {"segment", "triangle", "tetrahedron"};
    return kNames[kCorners<Element> - 2];
}

/// Counts the items of one kind and remembers the first.
struct Tally {
    int first = -1, count = 0;
    void add(std::size_t index) {
        if (count++ == 0) first = static_cast<int>(index);
    }
};

/// The elements that the role uses, on all vertices.
Mesh only_role(Mesh mesh, MeshRole role);

/// Runs all checks of one mesh; they write to report_.
class Checker {
  public:
    Checker(const Mesh& mesh, MeshRole role, const CheckOptions& options)
        : mesh_(mesh), role_(role), options_(options) {}

    MeshReport run();

  private:
    void report(Severity severity, Kind kind, Tally tally, std::string message) {
        auto& list = severity == Severity::Error ? report_.errors : report_.warnings;
        list.push_back({severity, kind, tally.first, tally.count, std::move(message)});
    }
    void error(Kind kind, Tally tally, std::string message) {
        report(Severity::Error, kind, tally, std::move(message));
    }
    void warn(Kind kind, Tally tally, std::string message) {
        report(Severity::Warning, kind, tally, std::move(message));
    }

    [[nodiscard]] const Vec3d& x(int i) const {
        return mesh_.x[static_cast<std::size_t>(i)];
    }

    void check_not_empty();
    void check_finite();
    template <class Element>
    void check_indices(const std::vector<Element>& elements);
    void check_solid();
    void check_tet_shapes();
    void check_tet_faces();
    void check_surface();
    void check_segments();
    void check_points();
    void check_edges_of(const std::vector<Int3>& surface, const char* whose);
    void check_vertices_of(const std::vector<Int3>& surface, const char* whose);
    template <class Element>
    void check_duplicate_elements(const std::vector<Element>& elements,
                                  Severity severity);
    void check_duplicate_vertices();
    void check_unreferenced();

    const Mesh& mesh_;
    MeshRole role_;
    const CheckOptions& options_;
    MeshReport report_;
};

template <class Element>
void Checker::check_duplicate_elements(const std::vector<Element>& elements,
                                       Severity severity) {
    using Key = std::array<int, static_cast<std::size_t>(kCorners<Element>)>;
    std::vector<std::pair<Key, int>> keys;
    keys.reserve(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        Key key{};
        std::copy(elements[e].v, elements[e].v + kCorners<Element>, key.begin());
        std::sort(key.begin(), key.end());
        keys.emplace_back(key, static_cast<int>(e));
    }
    std::sort(keys.begin(), keys.end());
    Tally twice;
    int first = static_cast<int>(elements.size());
    for (std::size_t k = 1; k < keys.size(); ++k)
        if (keys[k].first == keys[k - 1].first) {
            twice.add(0);
            first = std::min(first, keys[k].second);
        }
    twice.first = first;
    if (twice.count > 0)
        report(severity,
               Kind::DuplicateElement,
               twice,
               fmt::format("has {} doubled elements (first: {} {} has the vertices of an "
                           "earlier one); remove the "
                           "copies",
                           twice.count,
                           name_of<Element>(),
                           twice.first));
}

}  // namespace noli::detail
