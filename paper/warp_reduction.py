# SPDX-License-Identifier: Apache-2.0
"""Alg. 1 of the supplement (segmented warp reduction of block-matrix products), lane by lane, in the
printed and the corrected reading."""
import numpy as np

WARP = 32


def boundaries(local, first_entry, m):
    """is_boundary of every thread of one block; local: index in the block, first_entry: e_id of its first
    thread."""
    offset = m - first_entry
    block_row = (local - offset + m) // m
    l_id = np.where(block_row == 0, local, (local - offset) % m)
    return (l_id == 0) | (local % WARP == 0)


def reduce_warp(r, boundary, m):
    """The shuffle loop: sums each segment of a warp's 32 values into its first lane."""
    lane = np.arange(WARP)
    after = [next((k for k in range(i + 1, WARP) if boundary[k]), WARP) for i in lane]
    interval = np.minimum(np.array(after) - lane - 1, WARP - 1 - lane)
    step = 1
    while step < m:
        neighbour = np.concatenate([r[step:], r[WARP - step:]])  # lanes past the end read their own
        r = r + np.where(interval >= step, neighbour, 0.0)
        step *= 2
    return r


def product(matrices, vectors, reading, block=64):
    """Products of m x m matrices and vectors as Alg. 1 computes them; reads outside count as zero."""
    count, m, _ = matrices.shape
    out = np.zeros((count, m))
    total = count * m * m
    for start in range(0, total, block):
        local = np.arange(block)
        index = local if reading == "block index" else start + local
        row = index * m * m // m if reading == "printed row" else index % (m * m) // m
        H_id, col = index // (m * m), index % m
        active = (start + local < total) & (row < m)
        r = np.zeros(block)
        r[active] = matrices[H_id[active], row[active], col[active]] * vectors[H_id[active], col[active]]
        first = boundaries(local, start % m if reading != "block index" else 0, m)
        for warp in range(0, block, WARP):
            lanes = slice(warp, warp + WARP)
            r[lanes] = reduce_warp(r[lanes], first[lanes], m)
        write = active & first
        np.add.at(out, (H_id[write], row[write]), r[write])
    return out


def product_error(rng, reading):
    """Largest relative error over m = 6, 9, 12 and a partial last warp."""
    worst = 0.0
    for m in (6, 9, 12):
        matrices, vectors = rng.normal(size=(7, m, m)), rng.normal(size=(7, m))
        exact = np.einsum("kij,kj->ki", matrices, vectors)
        got = product(matrices, vectors, reading)
        worst = max(worst, np.linalg.norm(got - exact) / np.linalg.norm(exact))
    return worst
