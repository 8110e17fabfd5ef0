// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Gmsh numbers nodes as it likes: dense numbers are looked up in a table, others by
/// bisection.

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace noli::detail {

/// Node numbers of the file -> indices into Mesh::x.
class TagTable {
  public:
    /// Returns the position of a tag that occurs twice, or -1.
    int build(const std::vector<std::int64_t>& tags) {
        if (tags.empty()) return -1;
        const auto [lo, hi] = std::minmax_element(tags.begin(), tags.end());
        first_ = *lo;
        const std::uint64_t range =
            static_cast<std::uint64_t>(*hi) - static_cast<std::uint64_t>(*lo);
        return range < 4 * tags.size() + 1024 ? build_dense(tags, range + 1)
                                              : build_sparse(tags);
    }

    /// Index of a tag, or -1.
    [[nodiscard]] int find(std::int64_t tag) const {
        if (!dense_.empty()) {
            const std::uint64_t k =
                static_cast<std::uint64_t>(tag) - static_cast<std::uint64_t>(first_);
            return k < dense_.size() ? dense_[k] : -1;
        }
        const auto it =
            std::lower_bound(sparse_.begin(), sparse_.end(), std::pair{tag, 0});
        return it != sparse_.end() && it->first == tag ? it->second : -1;
    }

  private:
    int build_dense(const std::vector<std::int64_t>& tags, std::uint64_t range) {
        dense_.assign(range, -1);
        for (std::size_t i = 0; i < tags.size(); ++i) {
            int& slot = dense_[static_cast<std::uint64_t>(tags[i] - first_)];
            if (slot >= 0) return static_cast<int>(i);
            slot = static_cast<int>(i);
        }
        return -1;
    }

    int build_sparse(const std::vector<std::int64_t>& tags) {
        for (std::size_t i = 0; i < tags.size(); ++i)
            sparse_.emplace_back(tags[i], static_cast<int>(i));
        std::sort(sparse_.begin(), sparse_.end());
        for (std::size_t i = 1; i < sparse_.size(); ++i)
            if (sparse_[i].first == sparse_[i - 1].first) return sparse_[i].second;
        return -1;
    }

    std::int64_t first_ = 0;
    std::vector<int> dense_;
    std::vector<std::pair<std::int64_t, int>> sparse_;
};

}  // namespace noli::detail
