// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Linear bounding volume hierarchy over points, edges or triangles.
///
/// Primitives are sorted along a Morton curve and cut into leaves of four. Over the
/// leaves stands an implicit complete tree of width four: block j of level k + 1 holds
/// the boxes of blocks 4 j .. 4 j + 3 of level k, and level 0 holds the boxes of the
/// primitives.
///
///     level 2          [ . . . . ]                 one block is the root
///     level 1     [. . . .] [. . . .] ...          a place is a leaf
///     level 0   [....] [....] [....] ...           a block is a leaf, a place is a
///     primitive
///
/// Nothing has to be linked, boxes are merged level by level without atomics, and moving
/// primitives need new boxes only: an old order gives larger boxes, never a wrong result.
/// The boxes of a block lie coordinate by coordinate, so that the CPU tests four at once;
/// measured against a binary tree, the search takes half of the time.

#include "contact/box_block.hpp"
#include "contact/moving_box.hpp"
#include "contact/vertex_boxes.hpp"
#include "core/morton.hpp"
#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"

#include <cstdint>

namespace noli {

inline constexpr int kMaxLevels = 16;

/// Where the levels of a tree lie in its array of blocks.
struct BvhLevels {
    int count;  ///< 0 for an empty tree, else at least 2; the last level is one block
    int offset[kMaxLevels + 1];  ///< level k is blocks offset[k] .. offset[k + 1] - 1

    [[nodiscard]] NOLI_HD int num_blocks(int level) const {
        return count > level ? offset[level + 1] - offset[level] : 0;
    }
};

NOLI_HD inline BvhLevels bvh_levels(int num_primitives) {
    BvhLevels levels{};
    int n = num_primitives;
    while (n > 0) {
        n = (n + kBlockSize - 1) / kBlockSize;
        levels.offset[levels.count + 1] = levels.offset[levels.count] + n;
        ++levels.count;
        if (n == 1 && levels.count > 1) break;
    }
    return levels;
}

/// A tree as kernels see it.
template <class Box, class Ids>
struct BvhView {
    View<const int> order;             ///< primitive at each place of the sorted sequence
    View<const IdBlock<Ids>> ids;      ///< vertex ids of the primitives of each leaf
    View<const BoxBlock<Box>> blocks;  ///< all levels
    BvhLevels levels;

    [[nodiscard]] NOLI_HD const BoxBlock<Box>& block(int level, int j) const {
        return blocks[levels.offset[level] + j];
    }
};

/// Box of all that block j of a level holds.
template <class Box, class Ids>
NOLI_HD inline Box box_of_block(const BvhView<Box, Ids>& tree, int level, int j) {
    if (level + 1 < tree.levels.count)
        return load(tree.block(level + 1, j / kBlockSize), j % kBlockSize);
    Box box;
    make_empty(box);
    for (int place = 0; place < kBlockSize; ++place)
        merge_into(box, load(tree.block(level, j), place));
    return box;
}

/// Calls visit(j) for every block j >= first of level kLevel whose box overlaps `query`.
template <bool kOnDevice, int kLevel, class Box, class Ids, class Visit>
NOLI_HD inline void visit_blocks(const BvhView<Box, Ids>& tree,
                                 const Box& query,
                                 int first,
                                 const Visit& visit) {
    if (tree.levels.count == 0) return;
    if (tree.levels.count == kLevel + 1) return visit(0);
    // A block pushes at most three more entries than it takes.
    int stack[(kBlockSize - 1) * kMaxLevels];
    int size = 0;
    int level = tree.levels.count - 1;
    int j = 0;
    while (true) {
        unsigned bits = overlap_bits<kOnDevice>(query, tree.block(level, j));
        const int skipped = (first >> (2 * (level - 1 - kLevel))) - kBlockSize * j;
        if (skipped > 0) bits &= ~0U << skipped;
        for (; bits != 0; bits &= bits - 1) {
            const int child = kBlockSize * j + lowest_bit(bits);
            if (level == kLevel + 1)
                visit(child);
            else
                stack[size++] = child * kMaxLevels + level - 1;
        }
        if (size == 0) return;
        --size;
        level = stack[size] % kMaxLevels;
        j = stack[size] / kMaxLevels;
    }
}

/// Mean of the vertices of a primitive.
template <class Ids>
NOLI_HD inline Vec3d centre_of(View<const Vec3d> x, const Ids& ids) {
    Vec3d sum = x[corner(ids, 0)];
    for (int k = 1; k < kNumCorners<Ids>; ++k)
        sum += x[corner(ids, k)];
    return (1.0 / kNumCorners<Ids>)*sum;
}

namespace detail {

/// Grid around the points x[vertices].
template <class Exec>
MortonGrid grid_around(Exec& exec, View<const int> vertices, View<const Vec3d> x) {
    Later low[3];
    Later high[3];
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = exec.min_later("contact/grid_low", vertices.size, [=] NOLI_HD(int i) {
            return x[vertices[i]][axis];
        });
        high[axis] = exec.max_later("contact/grid_high",
                                    vertices.size,
                                    [=] NOLI_HD(int i) { return x[vertices[i]][axis]; });
    }
    Vec3d lo{};
    double extent = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = exec.value(low[axis]);
        extent = std::fmax(extent, exec.value(high[axis]) - lo[axis]);
    }
    return {lo, extent > 0.0 ? kMortonCells / extent : 0.0};
}

/// codes[i] = Morton code of the centre of primitive i, order[i] = i.
template <class Exec, class Ids>
void morton_codes(Exec& exec,
                  View<const Ids> ids,
                  MortonGrid grid,
                  View<const Vec3d> x,
                  View<std::uint64_t> codes,
                  View<int> order) {
    exec.for_each("contact/morton_codes", ids.size, [=] NOLI_HD(int i) {
        codes[i] = grid.code(centre_of(x, ids[i]));
        order[i] = i;
    });
}

/// Vertex ids of the primitives in sorted order, -1 in places without a primitive.
template <class Exec, class Ids>
void gather_ids(Exec& exec,
                View<const Ids> ids,
                View<const int> order,
                View<IdBlock<Ids>> blocks) {
    exec.for_each("contact/gather_ids", blocks.size, [=] NOLI_HD(int j) {
        for (int place = 0; place < kBlockSize; ++place) {
            const int i = j * kBlockSize + place;
            for (int k = 0; k < kNumCorners<Ids>; ++k)
                blocks[j].v[k][place] = i < order.size ? corner(ids[order[i]], k) : -1;
        }
    });
}

/// Level 0: boxes of the primitives, each the union of those of its vertices.
template <class Exec, class Ids, class Box, class VertexBoxes>
void primitive_boxes(Exec& exec,
                     View<const IdBlock<Ids>> ids,
                     VertexBoxes vertices,
                     View<BoxBlock<Box>> blocks) {
    exec.for_each("contact/primitive_boxes", ids.size, [=] NOLI_HD(int j) {
        for (int place = 0; place < kBlockSize; ++place) {
            Box box;
            make_empty(box);
            for (int k = 0; k < kNumCorners<Ids> && ids[j].v[0][place] >= 0; ++k)
                vertices.add_to(box, ids[j].v[k][place]);
            store(blocks[j], place, box);
        }
    });
}

/// One level: place p of block j gets the union of block 4 j + p of the level below.
template <class Exec, class Box>
void merge_level(Exec& exec, View<const BoxBlock<Box>> below, View<BoxBlock<Box>> level) {
    exec.for_each("contact/merge_level", level.size, [=] NOLI_HD(int j) {
        for (int place = 0; place < kBlockSize; ++place) {
            Box box;
            make_empty(box);
            const int child = j * kBlockSize + place;
            for (int k = 0; k < kBlockSize && child < below.size; ++k)
                merge_into(box, load(below[child], k));
            store(level[j], place, box);
        }
    });
}

}  // namespace detail

/// Sorted order of primitives; boxes are kept apart (BvhBoxes), so that static and moving
/// queries share it.
template <class Exec, class Ids>
class BvhOrder {
  public:
    /// Sorts anew by the primitives' present places.
    void sort(Exec& exec,
              View<const Ids> ids,
              const MortonGrid& grid,
              View<const Vec3d> x) {
        codes_.resize(ids.size);
        order_.resize(ids.size);
        ids_.resize((ids.size + kBlockSize - 1) / kBlockSize);
        detail::morton_codes(exec, ids, grid, x, codes_.view(), order_.view());
        exec.sort_by_key("contact/sort_codes", codes_.view(), order_.view());
        detail::gather_ids(exec, ids, View<const int>(order_.view()), ids_.view());
    }
    [[nodiscard]] View<const int> order() const { return order_.view(); }
    [[nodiscard]] View<const IdBlock<Ids>> ids() const { return ids_.view(); }

  private:
    typename Exec::template Buffer<std::uint64_t> codes_;
    typename Exec::template Buffer<int> order_;
    typename Exec::template Buffer<IdBlock<Ids>> ids_;
};

/// The boxes of a tree, for one kind of box.
template <class Exec, class Box, class Ids>
class BvhBoxes {
  public:
    /// Computes all boxes from those of the vertices (MotionBoxes, KnownBoxes).
    template <class VertexBoxes>
    void refit(Exec& exec,
               const BvhOrder<Exec, Ids>& order,
               const VertexBoxes& vertices) {
        levels_ = bvh_levels(order.order().size);
        blocks_.resize(levels_.offset[levels_.count]);
        detail::primitive_boxes<Exec, Ids, Box>(exec, order.ids(), vertices, level(0));
        merge_levels(exec);
    }
    /// The blocks of level 0, to be changed; call merge_levels after that.
    View<BoxBlock<Box>> leaves() { return level(0); }
    void merge_levels(Exec& exec) {
        for (int k = 1; k < levels_.count; ++k)
            detail::merge_level<Exec, Box>(exec, level(k - 1), level(k));
    }
    [[nodiscard]] BvhView<Box, Ids> view(const BvhOrder<Exec, Ids>& order) const {
        return {order.order(), order.ids(), blocks_.view(), levels_};
    }

  private:
    View<BoxBlock<Box>> level(int k) {
        const int begin = levels_.offset[k];
        return {blocks_.view().data + begin, levels_.offset[k + 1] - begin};
    }

    BvhLevels levels_{};
    typename Exec::template Buffer<BoxBlock<Box>> blocks_;
};

}  // namespace noli
