// SPDX-License-Identifier: Apache-2.0
#include "linear/row_colours.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <numeric>

namespace noli {

namespace {

constexpr int kBlocksPerGroup = 4;

using detail::at;

/// Per block: the blocks before it that terms couple it to, in any order.
struct TermNeighbours {
    std::vector<int> begin;  ///< num_blocks + 1
    std::vector<int> block;

    [[nodiscard]] std::span<const int> of(int b) const {
        return {block.data() + begin[at(b)], block.data() + begin[at(b) + 1]};
    }
};

/// Calls visit(later, earlier) for the pairs of different blocks that terms couple.
template <class Visit>
void visit_term_couplings(const OperatorView& op,
                          const RowBlocksOfMatrix& blocks,
                          const Visit& visit) {
    for (const Int4& term : op.vertices) {
        int of[4];
        for (int s = 0; s < 4; ++s)
            of[s] = term[s] < 0 ? -1 : blocks.block_of(term[s]);
        for (int s = 1; s < 4; ++s)
            for (int k = 0; k < s; ++k)
                if (of[s] >= 0 && of[k] >= 0 && of[s] != of[k])
                    visit(std::max(of[s], of[k]), std::min(of[s], of[k]));
    }
}

TermNeighbours neighbours_by_terms(const OperatorView& op,
                                   const RowBlocksOfMatrix& blocks) {
    TermNeighbours out;
    out.begin.assign(at(blocks.num_blocks()) + 1, 0);
    visit_term_couplings(
        op, blocks, [&out](int later, int) { ++out.begin[at(later) + 1]; });
    std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
    out.block.resize(at(out.begin.back()));
    std::vector<int> next(out.begin.begin(), out.begin.end() - 1);
    visit_term_couplings(op, blocks, [&](int later, int earlier) {
        out.block[at(next[at(later)]++)] = earlier;
    });
    return out;
}

/// Gives things one after the other the first colour that none of those has that they
/// have met.
class Greedy {
  public:
    /// `thing` has met one of that colour.
    void meet(int thing, int colour) { met_by_[at(colour)] = thing; }
    int first_free(int thing) {
        const auto first = std::find_if(
            met_by_.begin(), met_by_.end(), [thing](int t) { return t != thing; });
        const auto colour = static_cast<int>(first - met_by_.begin());
        if (first == met_by_.end()) met_by_.push_back(-1);
        return colour;
    }

  private:
    std::vector<int> met_by_;  ///< per colour: the last that met it
};

/// Colours of regions of consecutive blocks, and of the blocks within their regions.
struct Colours {
    int blocks_per_region;
    std::vector<int> of_region;
    std::vector<int> of_block;  ///< differ for coupled blocks of one region only

    [[nodiscard]] int region_of(int block) const { return block / blocks_per_region; }
};

Colours colour_regions(const OperatorView& op,
                       const RowBlocksOfMatrix& blocks,
                       int blocks_per_region) {
    const TermNeighbours by_terms = neighbours_by_terms(op, blocks);
    const int num_blocks = blocks.num_blocks();
    Colours out{blocks_per_region, {}, std::vector<int>(at(num_blocks), -1)};
    Greedy regions;
    Greedy inside;
    for (int b = 0; b < num_blocks; ++b) {
        const int region = out.region_of(b);
        const auto meet = [&](int earlier) {
            const int other = out.region_of(earlier);
            if (other == region)
                inside.meet(b, out.of_block[at(earlier)]);
            else
                regions.meet(region, out.of_region[at(other)]);
        };
        for (int k = blocks.begin[at(b)]; k < blocks.begin[at(b) + 1]; ++k)
            meet(blocks.neighbour[at(k)]);
        for (const int earlier : by_terms.of(b))
            meet(earlier);
        out.of_block[at(b)] = inside.first_free(b);
        if (b + 1 == num_blocks || out.region_of(b + 1) != region)
            out.of_region.push_back(regions.first_free(region));
    }
    return out;
}

/// Number of groups that so many blocks of a colour make: even, so that two threads get
/// the same share of them.
std::size_t count_groups(std::size_t num_blocks) {
    const std::size_t groups = (num_blocks + kBlocksPerGroup - 1) / kBlocksPerGroup;
    return num_blocks > 1 ? groups + groups % 2 : groups;
}

/// Numbers the rows of some blocks that are not coupled, interleaved.
void append_rows(std::span<const int> list,
                 const RowBlocksOfMatrix& blocks,
                 Numbering& numbering) {
    const int rows_per_block = blocks.cut.rows_per_block;
    for (int k = 0; k < rows_per_block; ++k)
        for (const int b : list) {
            const int i = b * rows_per_block + k;
            if (i >= blocks.num_rows()) continue;
            const int v = blocks.free.vertex[at(i)];
            numbering.rank[at(v)] = static_cast<int>(numbering.vertex.size());
            numbering.vertex.push_back(v);
        }
}

void end_group(ColouredRows& out) {
    out.group_begin.push_back(static_cast<int>(out.numbering.vertex.size()));
}

/// Groups of a colour of single blocks.
void append_groups(std::span<const int> of_colour,
                   const RowBlocksOfMatrix& blocks,
                   ColouredRows& out) {
    const std::size_t groups = count_groups(of_colour.size());
    for (std::size_t g = 0; g < groups; ++g) {
        const std::size_t begin = of_colour.size() * g / groups;
        const std::size_t end = of_colour.size() * (g + 1) / groups;
        append_rows(of_colour.subspan(begin, end - begin), blocks, out.numbering);
        end_group(out);
    }
}

/// A region as a group.
void append_region(int region,
                   const Colours& colours,
                   const RowBlocksOfMatrix& blocks,
                   ColouredRows& out) {
    const int first = region * colours.blocks_per_region;
    const int end = std::min(first + colours.blocks_per_region, blocks.num_blocks());
    std::vector<int> list(at(end - first));
    std::iota(list.begin(), list.end(), first);
    const auto colour_of = [&colours](int b) { return colours.of_block[at(b)]; };
    std::stable_sort(list.begin(), list.end(), [&](int a, int b) {
        return colour_of(a) < colour_of(b);
    });
    for (auto from = list.begin(); from != list.end();) {
        const auto to = std::find_if(
            from, list.end(), [&](int b) { return colour_of(b) != colour_of(*from); });
        append_rows({from, to}, blocks, out.numbering);
        from = to;
    }
    end_group(out);
}

}  // namespace

RowBlocksOfMatrix cut_rows(const OperatorView& op,
                           View<const std::uint8_t> fixed,
                           std::span<const int> order,
                           const RowCut& cut) {
    RowBlocksOfMatrix out{
        .free = number_free_vertices({fixed.data, at(fixed.size)}, order),
        .cut = cut,
        .begin = {0},
        .neighbour = {}};
    const int num_rows = out.num_rows();
    const int size = cut.rows_per_block;
    std::vector<int> seen_by(at((num_rows + size - 1) / size), -1);
    for (int b = 0; b < static_cast<int>(seen_by.size()); ++b) {
        const int end = std::min(num_rows, (b + 1) * size);
        for (int i = b * size; i < end; ++i) {
            const int v = out.free.vertex[at(i)];
            for (int k = op.row_begin[v]; k < op.row_begin[v + 1]; ++k) {
                const int other = out.block_of(op.col[k]);
                if (other < 0 || other >= b || seen_by[at(other)] == b) continue;
                seen_by[at(other)] = b;
                out.neighbour.push_back(other);
            }
        }
        out.begin.push_back(static_cast<int>(out.neighbour.size()));
    }
    return out;
}

ColouredRows colour_rows(const OperatorView& op, const RowBlocksOfMatrix& blocks) {
    const bool in_regions = blocks.in_regions();
    const Colours colours =
        colour_regions(op, blocks, in_regions ? blocks.cut.blocks_per_region : 1);
    std::vector<std::vector<int>> regions_of;  // per colour
    for (int r = 0; r < static_cast<int>(colours.of_region.size()); ++r) {
        const std::size_t colour = at(colours.of_region[at(r)]);
        if (colour >= regions_of.size()) regions_of.resize(colour + 1);
        regions_of[colour].push_back(r);
    }

    ColouredRows out;
    out.numbering.rank.assign(blocks.free.rank.size(), -1);
    out.numbering.vertex.reserve(blocks.free.vertex.size());
    out.group_begin.push_back(0);
    for (const std::vector<int>& of_colour : regions_of) {
        out.colour_begin.push_back(static_cast<int>(out.group_begin.size()) - 1);
        if (in_regions) {
            for (const int region : of_colour)
                append_region(region, colours, blocks, out);
        } else {
            append_groups(of_colour, blocks, out);
        }
    }
    out.colour_begin.push_back(static_cast<int>(out.group_begin.size()) - 1);
    out.nearby.reserve(blocks.free.vertex.size());
    for (const int v : blocks.free.vertex)
        out.nearby.push_back(out.numbering.rank[at(v)]);
    return out;
}

}  // namespace noli
