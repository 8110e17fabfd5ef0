# SPDX-License-Identifier: Apache-2.0
"""Scenes of any size from the program's own shape generators.

mat_twist: one mat of 1 m x 1 m x 5 cm, held at two ends that turn against each other. More tetrahedra
make it finer: the systems get worse conditioned.
falling_blocks: a pile of 10 cm blocks, four layers, each block above four others, falling on a floor. More
tetrahedra make more blocks of the same mesh: contacts grow with them.
"""
import math

END_TURN = 720.0  # degrees per second: the mat touches itself within 15 steps
LAYERS = 4       # of the pile
BLOCK = 0.1      # m
DHAT = 5e-4      # m, of the pile


def mat_cells(tets):
    """(cells along an edge, layers) of the mat whose cells are the nearest to cubes."""
    def side(layers):
        return max(2, round(math.sqrt(tets / (6 * layers))))
    layers = min(range(1, 40), key=lambda k: abs(math.log(k / (0.05 * side(k)))))
    return side(layers), layers


def mat_twist(tets, young=2e4, poisson=0.4):
    cells, layers = mat_cells(tets)
    end = 0.5 / cells

    def turning(low, high, speed):
        return {"kind": "velocity", "select": {"box": [[low, -0.1, -0.1], [high, 1.1, 1.1]]},
                "angular_deg": [speed, 0, 0], "center": [0, 0, 0]}

    return {
        "format_version": 1, "name": "mat_twist", "duration": 4, "dt": 0.02, "gravity": [0, 0, 0],
        "length_scale": 1.0,
        "bodies": [{
            "name": "mat",
            "mesh": {"generator": "slab", "width": 1, "depth": 1, "thickness": 0.05,
                     "cells": [cells, cells], "layers": layers, "tets_per_cell": 6},
            "material": {"young": young, "poisson": poisson},
            "boundary": [turning(-0.1, end, -END_TURN), turning(1.0 - end, 1.1, END_TURN)]}]}


def pile_grid(tets):
    """(cells along a block's edge, blocks along x, blocks along z) of the pile."""
    cells = min(8, max(1, round((tets / (5 * LAYERS)) ** (1 / 3))))
    columns = max(1, round(tets / (5 * cells ** 3 * LAYERS)))
    along_x = math.isqrt(columns)
    return cells, along_x, round(columns / along_x)


def falling_blocks(tets, young=1e5, poisson=0.4):
    cells, along_x, along_z = pile_grid(tets)
    spacing = 1.2 * BLOCK
    bodies = []
    for layer in range(LAYERS):
        shift = 0.5 * spacing * (layer % 2)
        bodies.append({
            "name": f"layer{layer}",
            "mesh": {"generator": "box", "size": [BLOCK] * 3, "cells": [cells] * 3},
            "transform": {"rotate_deg": [0, 5 if layer % 2 else -5, 0],
                          "translate": [shift, 1.5 * DHAT + 0.5 * BLOCK + layer * (BLOCK + 0.8 * DHAT), shift]},
            "material": {"young": young, "poisson": poisson}, "velocity": [0, -0.3, 0], "friction": 0.3,
            "grid": {"count": [along_x, 1, along_z], "spacing": [spacing, 0, spacing]}})
    return {"format_version": 1, "name": "falling_blocks", "duration": 1, "dt": 0.005, "length_scale": 0.5,
            "bodies": bodies, "half_spaces": [{"name": "floor", "friction": 0.3}],
            "contact": {"dhat": DHAT, "dhat_absolute": True}}


FAMILIES = {"mat_twist": mat_twist, "falling_blocks": falling_blocks}
STIFF = {"young": 1e7, "poisson": 0.49}
