// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Symmetric matrix of 3x3 blocks with a fixed pattern: inertia + elasticity + boundary
/// terms. Both triangles are stored, so that a product reads the blocks once, in order,
/// and writes each row once.

#include "exec/later.hpp"
#include "linear/block_pattern.hpp"
#include "linear/block_row.hpp"

namespace noli {

namespace detail {

/// values[upper] = sum of the block's contributions (+ diagonal * identity), and its
/// transpose.
template <class Exec>
void assemble_blocks(Exec& exec,
                     View<const int> upper,
                     View<const int> lower,
                     View<const int> gather_begin,
                     View<const int> gather,
                     View<const int> col,
                     View<const double> element_blocks,
                     View<const double> diagonal,
                     View<Mat3d> values) {
    exec.for_each("linear/assemble_blocks", upper.size, [=] NOLI_HD(int u) {
        Mat3d sum = zero3();
        for (int g = gather_begin[u]; g < gather_begin[u + 1]; ++g) {
            const Contribution c = Contribution::unpack(gather[g]);
            const double* block =
                &element_blocks[kDoublesPerElement * c.element + 9 * c.slot];
            for (int row = 0; row < 3; ++row)
                for (int k = 0; k < 3; ++k)
                    sum(row, k) += c.transposed ? block[3 * k + row] : block[3 * row + k];
        }
        if (upper[u] == lower[u]) {
            const double d = diagonal[col[upper[u]]];
            for (int k = 0; k < 9; k += 4)
                sum.a[k] += d;
        } else {
            values[lower[u]] = transpose(sum);
        }
        values[upper[u]] = sum;
    });
}

template <class Exec>
void scatter_upper(Exec& exec,
                   View<const int> upper,
                   View<const int> lower,
                   View<const Mat3d> from,
                   View<Mat3d> values) {
    exec.for_each("linear/scatter_upper", upper.size, [=] NOLI_HD(int u) {
        values[upper[u]] = from[u];
        if (upper[u] != lower[u]) values[lower[u]] = transpose(from[u]);
    });
}

template <class Exec>
void add_scaled_blocks(Exec& exec, double scale, View<const Mat3d> from, View<Mat3d> to) {
    exec.for_each("linear/add_scaled_blocks", to.size, [=] NOLI_HD(int k) {
        for (int j = 0; j < 9; ++j)
            to[k].a[j] += scale * from[k].a[j];
    });
}

template <class Exec>
void gather_diagonal(Exec& exec,
                     View<const int> diagonal,
                     View<const Mat3d> values,
                     View<Mat3d> out) {
    exec.for_each("linear/gather_diagonal", out.size, [=] NOLI_HD(int i) {
        out[i] = values[diagonal[i]];
    });
}

template <class Exec>
Later block_quadratic_form(Exec& exec,
                           View<const int> row_begin,
                           View<const int> col,
                           View<const Mat3d> values,
                           View<const Vec3d> x) {
    return exec.sum_later("linear/quadratic_form", x.size, [=] NOLI_HD(int i) {
        return dot(x[i],
                   block_row_product(values, col, x, row_begin[i], row_begin[i + 1]));
    });
}

}  // namespace detail

/// Block-sparse symmetric matrix in the memory of an executor.
template <class Exec>
class BlockMatrix {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    /// Takes a copy of the pattern; the values are undefined until they are set.
    void set_pattern(Exec& exec, const BlockPattern& pattern) {
        exec.upload(pattern.row_begin, row_begin_);
        exec.upload(pattern.col, col_);
        exec.upload(pattern.diagonal, diagonal_);
        exec.upload(pattern.upper, upper_);
        exec.upload(pattern.lower, lower_);
        exec.upload(pattern.gather_begin, gather_begin_);
        exec.upload(pattern.gather, gather_);
        values_.resize(pattern.num_blocks());
    }

    /// Sets the values to the sum of the element blocks plus a multiple of the identity
    /// per row.
    ///
    /// In:   element_blocks  (num_elements,90): upper triangle of each element's 4x4
    /// blocks, see
    ///                       Contribution
    ///       diagonal        (num_rows): added to the diagonal block times the identity
    void assemble(Exec& exec,
                  View<const double> element_blocks,
                  View<const double> diagonal) {
        detail::assemble_blocks(exec,
                                view(upper_),
                                view(lower_),
                                view(gather_begin_),
                                view(gather_),
                                view(col_),
                                element_blocks,
                                diagonal,
                                values_.view());
    }

    /// Sets the values from the upper triangle, blocks in the order of
    /// BlockPattern::upper.
    void set_upper(Exec& exec, View<const Mat3d> upper) {
        detail::scatter_upper(exec, view(upper_), view(lower_), upper, values_.view());
    }

    /// this += scale * other. The patterns must be the same.
    void axpy(Exec& exec, double scale, const BlockMatrix& other) {
        NOLI_DCHECK(other.values_.size() == values_.size());
        detail::add_scaled_blocks(exec, scale, other.values(), values_.view());
    }

    /// y = A x; x and y (num_rows), not the same array.
    void multiply(Exec& exec, View<const Vec3d> x, View<Vec3d> y) const {
        exec.for_lanes("linear/multiply",
                       num_rows(),
                       detail::BlockProductKernel{row_begin(), col(), values(), x, y});
    }

    /// xᵀ A x
    double quadratic_form(Exec& exec, View<const Vec3d> x) const {
        return exec.value(
            detail::block_quadratic_form(exec, row_begin(), col(), values(), x));
    }

    /// out[i] = A_ii
    void diagonal_blocks(Exec& exec, View<Mat3d> out) const {
        detail::gather_diagonal(exec, diagonal(), values(), out);
    }

    [[nodiscard]] int num_rows() const { return diagonal_.size(); }
    [[nodiscard]] int num_blocks() const { return col_.size(); }
    [[nodiscard]] View<const int> row_begin() const { return row_begin_.view(); }
    [[nodiscard]] View<const int> col() const { return col_.view(); }
    [[nodiscard]] View<const int> diagonal() const { return diagonal_.view(); }
    [[nodiscard]] View<const Mat3d> values() const { return values_.view(); }
    /// For who writes the values block by block.
    View<Mat3d> mutable_values() { return values_.view(); }

    /// Bytes held, for the memory report.
    [[nodiscard]] std::size_t bytes() const {
        return row_begin_.bytes() + col_.bytes() + diagonal_.bytes() + upper_.bytes()
             + lower_.bytes() + gather_begin_.bytes() + gather_.bytes() + values_.bytes();
    }

  private:
    static View<const int> view(const Buffer<int>& buffer) { return buffer.view(); }

    Buffer<int> row_begin_, col_, diagonal_;
    Buffer<int> upper_, lower_, gather_begin_, gather_;
    Buffer<Mat3d> values_;
};

}  // namespace noli
