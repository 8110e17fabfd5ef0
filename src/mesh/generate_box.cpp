// SPDX-License-Identifier: Apache-2.0
#include "mesh/generate.hpp"
#include "mesh/parameters.hpp"

namespace noli {

namespace {

// Corner c of a cell has the bits x, y, z.
constexpr int kSix[6][4] = {
    {0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
// A regular tetrahedron inside and four corners; odd cells are mirrored in x so that
// faces agree.
constexpr int kFive[5][4] = {
    {1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}};

void split_cell(const int (&corner)[8],
                CellSplit split,
                bool odd,
                std::vector<Int4>& tets) {
    if (split == CellSplit::Six) {
        for (const auto& t : kSix)
            tets.push_back({corner[t[0]], corner[t[1]], corner[t[2]], corner[t[3]]});
        return;
    }
    for (const auto& t : kFive) {
        if (odd)  // the mirror image turns the element; exchanging two corners turns it
                  // back
            tets.push_back(
                {corner[t[0] ^ 1], corner[t[1] ^ 1], corner[t[3] ^ 1], corner[t[2] ^ 1]});
        else
            tets.push_back({corner[t[0]], corner[t[1]], corner[t[2]], corner[t[3]]});
    }
}

Mesh box_grid(const BoxParams& p) {
    Mesh mesh;
    const auto vertex = [&](int i, int j, int k) {
        return (k * (p.ny + 1) + j) * (p.nx + 1) + i;
    };
    for (int k = 0; k <= p.nz; ++k)
        for (int j = 0; j <= p.ny; ++j)
            for (int i = 0; i <= p.nx; ++i)
                mesh.x.push_back({p.size.x * (static_cast<double>(i) / p.nx - 0.5),
                                  p.size.y * (static_cast<double>(j) / p.ny - 0.5),
                                  p.size.z * (static_cast<double>(k) / p.nz - 0.5)});
    for (int k = 0; k < p.nz; ++k)
        for (int j = 0; j < p.ny; ++j)
            for (int i = 0; i < p.nx; ++i) {
                int corner[8];
                for (int c = 0; c < 8; ++c)
                    corner[c] = vertex(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
                split_cell(corner, p.split, (i + j + k) % 2 == 1, mesh.tets);
            }
    return mesh;
}

}  // namespace

Result<Mesh> make_box(const BoxParams& p) {
    detail::ParameterCheck check("box");
    for (int k = 0; k < 3; ++k)
        check.above("size", p.size[k], 0.0);
    check.range("nx", p.nx, 1, 1e6).range("ny", p.ny, 1, 1e6).range("nz", p.nz, 1, 1e6);
    check.elements(6.0 * p.nx * p.ny * p.nz, kMaxGeneratedElements);
    if (check.error()) return *check.error();
    return box_grid(p);
}

Result<Mesh> make_slab(const SlabParams& p) {
    detail::ParameterCheck check("slab");
    check.above("width", p.width, 0.0)
        .above("depth", p.depth, 0.0)
        .above("thickness", p.thickness, 0.0);
    check.range("nx", p.nx, 1, 1e6)
        .range("nz", p.nz, 1, 1e6)
        .range("layers", p.layers, 1, 1e6);
    check.elements(6.0 * p.nx * p.nz * p.layers, kMaxGeneratedElements);
    if (check.error()) return *check.error();
    return box_grid({{p.width, p.thickness, p.depth}, p.nx, p.layers, p.nz, p.split});
}

}  // namespace noli
