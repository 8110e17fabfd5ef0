// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Exact solves on banks of 32 vertices that follow each other along a Morton curve: the
/// local part of a two-level Schwarz preconditioner, for devices. What couples one bank
/// to another is left out, contacts too.
///
/// A bank is a dense 96x96 inverse, 74 kB: twice the memory of the block matrix. Kept in
/// double, because a bank in stiff contact spans more magnitudes than a float inverse
/// can hold.
///
/// Source: MATH 10 (banks); block Jacobi as additive Schwarz, [Saad2003] 14.3.

#include "linear/block_inverse.hpp"
#include "linear/operator_rows.hpp"
#include "linear/pcg_state.hpp"

#include <numeric>
#include <span>
#include <vector>

namespace noli {

inline constexpr int kBankVertices = 32;
inline constexpr int kBankSize = 3 * kBankVertices;

namespace detail {

/// Adds what one vertex contributes to one row of its bank.
struct BankRowVisit {
    View<const int> place;
    int bank;
    double* row;

    NOLI_HD void operator()(int j, const Vec3d& add) const {
        if (place[j] / kBankVertices != bank) return;
        const int first = 3 * (place[j] % kBankVertices);
        for (int c = 0; c < 3; ++c)
            row[first + c] += add[c];
    }
};

/// The rows of the bank matrices; 0 for fixed vertices and for places without a vertex.
template <class Exec>
void bank_rows(Exec& exec,
               OperatorRows op,
               View<const int> vertex_at,
               View<const int> place,
               DenseMatrices banks) {
    exec.for_each(
        "linear/bank_rows",
        banks.count * banks.size,
        [=] NOLI_HD(int index) {
            double* row = &banks.at(index / banks.size, index % banks.size, 0);
            for (int c = 0; c < banks.size; ++c)
                row[c] = 0.0;
            const int p = index / 3;
            if (p >= vertex_at.size || op.fixed[vertex_at[p]] != 0) return;
            Vec3d unit{0, 0, 0};
            unit[index % 3] = 1.0;
            BankRowVisit visit{place, p / kBankVertices, row};
            op.visit_row(vertex_at[p], unit, visit);
        },
        32);
}

/// z = bank inverses times r
template <class Exec>
void apply_banks(Exec& exec,
                 View<const PcgState> state,
                 DenseMatrices inverse,
                 View<const int> vertex_at,
                 View<const Vec3d> r,
                 View<Vec3d> z) {
    exec.for_each(
        "linear/apply_banks",
        3 * vertex_at.size,
        [=] NOLI_HD(int index) {
            if (state[0].skip) return;
            const int p = index / 3;
            const int bank = p / kBankVertices;
            const int row = index % kBankSize;
            const int first = bank * kBankVertices;
            const int left = vertex_at.size - first;
            const int count = left < kBankVertices ? left : kBankVertices;
            double sum = 0.0;
            for (int k = 0; k < count; ++k) {
                const Vec3d& at = r[vertex_at[first + k]];
                for (int c = 0; c < 3; ++c)
                    sum += inverse.at(bank, 3 * k + c, row) * at[c];
            }
            z[vertex_at[p]][index % 3] = sum;
        },
        32);
}

}  // namespace detail

template <class Exec>
class SchwarzBanks {
  public:
    /// Banks are cut from this order of all vertices; empty: their own.
    void set_order(std::span<const int> order) {
        host_order_.assign(order.begin(), order.end());
        is_uploaded_ = false;
    }

    void build(Exec& exec, const OperatorRows& op) {
        if (!is_uploaded_ || vertex_at_.size() != op.fixed.size)
            upload(exec, op.fixed.size);
        is_uploaded_ = true;
        detail::bank_rows(exec,
                          op,
                          View<const int>(vertex_at_.view()),
                          View<const int>(place_.view()),
                          inverse_.matrices());
        inverse_.invert(exec);
    }

    void apply(Exec& exec,
               View<const PcgState> state,
               View<const Vec3d> r,
               View<Vec3d> z) {
        detail::apply_banks(
            exec, state, inverse_.matrices(), View<const int>(vertex_at_.view()), r, z);
    }

  private:
    void upload(Exec& exec, int num_vertices) {
        const auto n = static_cast<std::size_t>(num_vertices);
        if (host_order_.size() != n) {
            host_order_.resize(n);
            std::iota(host_order_.begin(), host_order_.end(), 0);
        }
        std::vector<int> place(n);
        for (std::size_t p = 0; p < n; ++p)
            place[static_cast<std::size_t>(host_order_[p])] = static_cast<int>(p);
        exec.upload(host_order_, vertex_at_);
        exec.upload(place, place_);
        inverse_.resize((num_vertices + kBankVertices - 1) / kBankVertices, kBankSize);
    }

    std::vector<int> host_order_;
    bool is_uploaded_ = false;
    typename Exec::template Buffer<int> vertex_at_, place_;
    BlockInverse<Exec> inverse_;
};

}  // namespace noli
