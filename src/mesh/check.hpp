// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is wrong with a mesh before a simulation starts: errors that make it unusable,
/// and warnings.

#include "noli/result.hpp"

#include "mesh/mesh.hpp"
#include "mesh/quality.hpp"

#include <string>
#include <vector>

namespace noli {

struct CheckOptions {
    /// checked() turns inverted tetrahedra by exchanging their last two corners.
    bool fix_orientation = false;
    /// checked() drops vertices without a tetrahedron from solids. Other roles keep
    /// theirs: files of moving vertices count them.
    bool drop_unreferenced = true;
    /// Vertices with equal coordinates are errors instead of warnings.
    bool duplicate_vertices_are_errors = false;
    /// Edges with more than two surface triangles are warnings instead of errors.
    bool allow_non_manifold = false;
    /// Tetrahedra with |relative_volume| (and triangles with a radius ratio) at or below
    /// this are degenerate; dimensionless, > 0.
    double degenerate_below = 1e-10;
    /// Elements with a radius ratio below this get a warning; dimensionless, >= 0.
    double poor_below = 1e-3;
};

struct MeshIssue {
    enum class Severity { Error, Warning };
    enum class Kind {
        Empty,
        NonFinite,
        IndexOutOfRange,
        RepeatedVertex,  ///< an element that uses a vertex twice
        Inverted,
        Degenerate,
        PoorShape,
        DuplicateVertex,
        UnreferencedVertex,
        DuplicateElement,
        OverlappingTets,    ///< a face with more than two tetrahedra, or with two on one
                            ///< side
        NonManifoldEdge,    ///< more than two surface triangles at an edge
        NonManifoldVertex,  ///< surface triangles that meet in a vertex only
        InconsistentOrientation,  ///< neighbouring triangles that turn against each other
    };
    Severity severity;
    Kind kind;
    int first;  ///< index (from 0) of the first bad element or vertex; -1 for Empty
    int count;  ///< how many there are
    std::string message;  ///< what was found, with numbers, and a cure
};

struct MeshReport {
    std::vector<MeshIssue> errors, warnings;
    MeshQuality quality;             ///< all zero when the errors forbid computing it
    std::vector<int> kept_vertices;  ///< old index of each vertex if checked() dropped
                                     ///< some, else empty

    [[nodiscard]] bool ok() const { return errors.empty(); }
};

/// Everything that is wrong with the elements that `role` uses. Changes nothing.
MeshReport check_mesh(const Mesh& mesh, MeshRole role, const CheckOptions& options = {});

/// The mesh ready for use: only the elements of the role, with the fixes that the options
/// ask for; or the first error under the name of the file. Everything that was found goes
/// to `report` if given.
Result<Mesh> checked(Mesh mesh,
                     const std::string& file,
                     MeshRole role,
                     const CheckOptions& options = {},
                     MeshReport* report = nullptr);

}  // namespace noli
