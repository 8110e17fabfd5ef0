// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The whole operator A = D + L + Lᵀ, D its 3x3 diagonal blocks, scaled by D = C Cᵀ:
///
///     A' = C⁻¹ A C⁻ᵀ = I + L' + L'ᵀ
///
/// in the row order of ColouredOperator, with the blocks of both triangles stored in
/// single precision where that does no harm. CPU only.

#include "exec/buffer.hpp"
#include "linear/coloured_operator.hpp"
#include "linear/sweeps.hpp"

#include <atomic>
#include <cmath>
#include <span>
#include <vector>

namespace noli {

/// L' and L'ᵀ: column-major blocks, padded by one number. Block p of a row of L' has
/// number p - row, see ColouredOperator::lower.
template <class Number>
struct Triangles {
    HostBuffer<Number> lower, upper;

    void resize(std::size_t num_blocks) {
        const int count = 9 * static_cast<int>(num_blocks);
        for (HostBuffer<Number>* blocks : {&lower, &upper}) {
            blocks->resize(count + 1);  // loads of four reach one past the last
            blocks->view()[count] = 0;
        }
    }
};

class ScaledOperator {
  public:
    static constexpr RowCut kRowCut{.rows_per_block = 16};

    enum class Built {
        NotPositive,  ///< a diagonal block is not positive
        NewValues,
        NewPattern,
    };

    explicit ScaledOperator(const RowCut& cut = kRowCut) : rows_(cut) {}

    /// See ColouredOperator::set_order.
    void set_order(std::span<const int> order) { rows_.set_order(order); }

    /// In:   inertia  (num_rows) multiple of the identity in each row, or empty: where it
    ///                is a large enough share of the diagonal everywhere, blocks are
    ///                stored in single precision
    template <class Exec>
    Built build(Exec& exec,
                const BlockMatrix<Exec>& matrix,
                const LowRankTerms<Exec>& terms,
                View<const std::uint8_t> fixed,
                View<const double> inertia) {
        OperatorCopy copy;
        const OperatorView op = view_operator(exec, matrix, terms, copy);
        const bool changed = rows_.update_pattern(exec, op, fixed);
        scale_.resize(static_cast<std::size_t>(rows_.num_rows()));
        diagonal_.resize(matrix.num_rows());
        matrix.diagonal_blocks(exec, diagonal_.view());
        terms.add_diagonal(exec, diagonal_.view());
        const View<const Mat3d> diagonal = diagonal_.view();
        std::atomic<bool> positive = true;
        const double least =
            exec.min("linear/gs_scale", rows_.num_rows(), [&, this](int k) {
                const int i = rows_.rows().nearby[static_cast<std::size_t>(k)];
                if (!scale_row(i, diagonal))
                    positive.store(false, std::memory_order_relaxed);
                return inertia_share(i, diagonal, inertia);
            });
        choose_precision(inertia.size > 0 ? least : 0.0);
        rows_.for_rows_nearby(exec, [&, this](int row, int ahead) {
            fetch_row(op, ahead);
            fill_row(op, row);
        });
        if (!positive) return Built::NotPositive;
        return changed ? Built::NewPattern : Built::NewValues;
    }

    [[nodiscard]] const ColouredOperator& rows() const { return rows_; }
    /// C⁻¹ per row.
    [[nodiscard]] const InverseFactor* scale() const { return scale_.data(); }
    [[nodiscard]] bool single() const { return single_; }

    /// f(triangles) with the blocks in the precision that they are stored in.
    template <class F>
    auto with_triangles(const F& f) const {
        return single_ ? f(single_blocks_) : f(double_blocks_);
    }

    [[nodiscard]] int vertex(int row) const {
        return rows_.numbering().vertex[static_cast<std::size_t>(row)];
    }

  private:
    /// Single precision stores blocks with an error of 6e-8 of the diagonal ones. A
    /// motion that strains nothing sees inertia alone: where that is at least this share
    /// of the diagonal, it is met to 0.1 % or better.
    static constexpr double kSinglePrecisionInertia = 1e-4;

    bool scale_row(int row, View<const Mat3d> diagonal);
    [[nodiscard]] double inertia_share(int row,
                                       View<const Mat3d> diagonal,
                                       View<const double> inertia) const;
    void choose_precision(double least_inertia);
    /// Asks for the blocks that fill_row needs.
    void fetch_row(const OperatorView& op, int row) const;
    void fill_row(const OperatorView& op, int row);
    template <class Number>
    void scale_row_blocks(Triangles<Number>& to, int row, const Mat3d* blocks);

    ColouredOperator rows_;
    HostBuffer<Mat3d> diagonal_;
    std::vector<InverseFactor> scale_;
    Triangles<double> double_blocks_;
    Triangles<float> single_blocks_;
    bool single_ = false;
};

}  // namespace noli
