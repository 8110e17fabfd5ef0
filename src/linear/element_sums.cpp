// SPDX-License-Identifier: Apache-2.0
#include "linear/element_sums.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <cstddef>

namespace noli {

namespace {

using detail::at;

/// Upper block of the matrix that each upper block of each element adds to.
std::vector<int> upper_of_element_blocks(const BlockPattern& pattern) {
    std::vector<int> upper_of(pattern.gather.size());
    for (int u = 0; u < pattern.num_upper(); ++u)
        for (int g = pattern.gather_begin[at(u)]; g < pattern.gather_begin[at(u + 1)];
             ++g) {
            const Contribution c = Contribution::unpack(pattern.gather[at(g)]);
            upper_of[at(kBlocksPerElement * c.element + c.slot)] = u;
        }
    return upper_of;
}

/// First and last block of elements that touches an upper block of the matrix.
struct Touched {
    int first = -1, last = -1;
};

class Builder {
  public:
    Builder(const ElementPartition& partition, const BlockPattern& pattern)
        : partition_(partition),
          pattern_(pattern),
          upper_of_(upper_of_element_blocks(pattern)),
          touched_(at(pattern.num_upper())),
          sum_of_(at(pattern.num_upper())) {}

    ElementSums build() {
        for (int b = 0; b < partition_.num_blocks(); ++b)
            for_each_upper(b, [&](int /*entry*/, int /*slot*/, int u) {
                Touched& t = touched_[at(u)];
                if (t.first < 0) t.first = b;
                t.last = b;
            });
        out_.group_begin.push_back(0);
        out_.kind_begin.push_back(0);
        for (int b = 0; b < partition_.num_blocks(); ++b) {
            add_targets(b);
            add_slots(b);
        }
        for (int u = 0; u < pattern_.num_upper(); ++u)
            if (touched_[at(u)].first < 0) out_.untouched.push_back(row_of(u));
        return std::move(out_);
    }

  private:
    /// f(entry of the block, slot, upper block)
    template <class F>
    void for_each_upper(int block, const F& f) {
        const int begin = partition_.block_begin[at(block)];
        const int end = partition_.block_begin[at(block + 1)];
        for (int k = begin; k < end; ++k)
            for (int slot = 0; slot < kBlocksPerElement; ++slot)
                f(k - begin,
                  slot,
                  upper_of_[at(kBlocksPerElement * partition_.element[at(k)] + slot)]);
    }

    [[nodiscard]] bool on_diagonal(int u) const {
        return pattern_.upper[at(u)] == pattern_.lower[at(u)];
    }
    /// Of a diagonal block.
    [[nodiscard]] int row_of(int u) const {
        return pattern_.col[at(pattern_.upper[at(u)])];
    }

    [[nodiscard]] int kind_of(int u, int block) const {
        return (touched_[at(u)].first == block ? 0 : sum_kind::kAdds)
             + (touched_[at(u)].last == block ? 0 : sum_kind::kStays)
             + (on_diagonal(u) ? 0 : sum_kind::kOffDiagonal);
    }

    void add_targets(int block) {
        std::vector<Int2> sums;  // (kind, upper)
        for_each_upper(block, [&](int /*entry*/, int /*slot*/, int u) {
            sums.push_back({{kind_of(u, block), u}});
        });
        std::sort(sums.begin(), sums.end(), [](const Int2& a, const Int2& b) {
            return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1];
        });
        sums.erase(std::unique(sums.begin(), sums.end()), sums.end());
        std::size_t next = 0;
        for (int kind = 0; kind < sum_kind::kCount; ++kind) {
            for (; next < sums.size() && sums[next][0] == kind; ++next) {
                const int u = sums[next][1];
                sum_of_[at(u)] = static_cast<std::uint16_t>(next);
                out_.target.push_back(
                    {pattern_.upper[at(u)],
                     on_diagonal(u) ? row_of(u) : pattern_.lower[at(u)]});
            }
            out_.kind_begin.push_back(static_cast<int>(out_.target.size()));
        }
    }

    void add_slots(int block) {
        const int count =
            partition_.block_begin[at(block + 1)] - partition_.block_begin[at(block)];
        const int groups = (count + kElementGroup - 1) / kElementGroup;
        const std::size_t first = out_.slot.size();
        out_.slot.resize(first + at(groups * kElementGroup * kBlocksPerElement), 0);
        for_each_upper(block, [&](int entry, int slot, int u) {
            out_.slot[first + at(kBlocksPerElement * entry + slot)] = sum_of_[at(u)];
        });
        out_.group_begin.push_back(out_.group_begin.back() + groups);
    }

    const ElementPartition& partition_;
    const BlockPattern& pattern_;
    std::vector<int> upper_of_;
    std::vector<Touched> touched_;
    std::vector<std::uint16_t> sum_of_;  ///< per upper block, of the block at work
    ElementSums out_;
};

}  // namespace

ElementSums build_element_sums(const ElementPartition& partition,
                               const BlockPattern& pattern) {
    return Builder(partition, pattern).build();
}

}  // namespace noli
