// SPDX-License-Identifier: Apache-2.0
#include "linear/element_partition.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace noli {

namespace {

using detail::at;

/// Blocks along the curve, not yet coloured: colour_begin stays empty.
ElementPartition cut_blocks(std::span<const int> range_begin,
                            std::span<const int> order,
                            int size) {
    ElementPartition cut;
    for (std::size_t r = 0; r + 1 < range_begin.size(); ++r) {
        int taken = 0;
        for (const int e : order) {
            if (e < range_begin[r] || e >= range_begin[r + 1]) continue;
            if (taken++ % size == 0) {
                cut.block_begin.push_back(static_cast<int>(cut.element.size()));
                cut.block_range.push_back(static_cast<int>(r));
            }
            cut.element.push_back(e);
        }
    }
    cut.block_begin.push_back(static_cast<int>(cut.element.size()));
    return cut;
}

/// The least used colour that no block before this one has at a common vertex.
class Colouring {
  public:
    explicit Colouring(int num_vertices) : at_vertex_(at(num_vertices)) {}

    int add(int block,
            std::span<const int> block_elements,
            std::span<const Int4> elements) {
        for (const int e : block_elements)
            for (const int v : elements[at(e)].v)
                for (const int c : at_vertex_[at(v)])
                    taken_by_[at(c)] = block;
        int best = -1;
        for (int c = 0; c < static_cast<int>(used_.size()); ++c)
            if (taken_by_[at(c)] != block && (best < 0 || used_[at(c)] < used_[at(best)]))
                best = c;
        if (best < 0) {
            best = static_cast<int>(used_.size());
            used_.push_back(0);
            taken_by_.push_back(-1);
        }
        ++used_[at(best)];
        for (const int e : block_elements)
            for (const int v : elements[at(e)].v) {
                std::vector<int>& colours = at_vertex_[at(v)];
                if (colours.empty() || colours.back() != best) colours.push_back(best);
            }
        return best;
    }

  private:
    std::vector<std::vector<int>> at_vertex_;  ///< colours of the blocks there
    std::vector<int> used_;                    ///< per colour: number of blocks
    std::vector<int> taken_by_;  ///< per colour: last block with a neighbour of it
};

}  // namespace

ElementPartition partition_elements(int num_vertices,
                                    std::span<const Int4> elements,
                                    std::span<const int> range_begin,
                                    std::span<const int> order,
                                    int size) {
    const ElementPartition cut = cut_blocks(range_begin, order, size);
    const auto elements_of = [&cut](int b) {
        return std::span(cut.element)
            .subspan(at(cut.block_begin[at(b)]),
                     at(cut.block_begin[at(b + 1)] - cut.block_begin[at(b)]));
    };
    Colouring colouring(num_vertices);
    std::vector<int> colour(at(cut.num_blocks()));
    for (int b = 0; b < cut.num_blocks(); ++b)
        colour[at(b)] = colouring.add(b, elements_of(b), elements);

    std::vector<int> sorted(colour.size());
    std::iota(sorted.begin(), sorted.end(), 0);
    std::stable_sort(sorted.begin(), sorted.end(), [&colour](int a, int b) {
        return colour[at(a)] < colour[at(b)];
    });
    ElementPartition out;
    out.block_begin.push_back(0);
    for (const int b : sorted) {
        if (colour[at(b)] == static_cast<int>(out.colour_begin.size()))
            out.colour_begin.push_back(out.num_blocks());
        const std::span<const int> mine = elements_of(b);
        out.element.insert(out.element.end(), mine.begin(), mine.end());
        out.block_begin.push_back(static_cast<int>(out.element.size()));
        out.block_range.push_back(cut.block_range[at(b)]);
    }
    out.colour_begin.push_back(out.num_blocks());
    return out;
}

}  // namespace noli
