// SPDX-License-Identifier: Apache-2.0
#include "linear/scaled_operator.hpp"

#include "core/index.hpp"

namespace noli {

namespace {

using detail::at;

}  // namespace

bool ScaledOperator::scale_row(int row, View<const Mat3d> diagonal) {
    return invert_factor(diagonal[vertex(row)], scale_[at(row)]);
}

double ScaledOperator::inertia_share(int row,
                                     View<const Mat3d> diagonal,
                                     View<const double> inertia) const {
    if (inertia.size == 0) return 0.0;
    const int v = vertex(row);
    const Mat3d& d = diagonal[v];
    return inertia[v] / std::fmax(d.a[0], std::fmax(d.a[4], d.a[8]));
}

void ScaledOperator::choose_precision(double least_inertia) {
    single_ = least_inertia >= kSinglePrecisionInertia;
    if (single_)
        single_blocks_.resize(rows_.num_off_diagonal());
    else
        double_blocks_.resize(rows_.num_off_diagonal());
}

void ScaledOperator::fetch_row(const OperatorView& op, int row) const {
    const MergedBlocks& lower = rows_.lower();
    const int end = lower.row_begin[at(row) + 1] - 1;
    for (int p = lower.row_begin[at(row)]; p < end; ++p)
        if (const int source = lower.source[at(p)]; source >= 0) {
            __builtin_prefetch(op.values[source].a);
            __builtin_prefetch(op.values[source].a + 8);  // mostly in the next line
        }
}

void ScaledOperator::fill_row(const OperatorView& op, int row) {
    thread_local std::vector<Mat3d> blocks;
    const MergedBlocks& lower = rows_.lower();
    const int begin = lower.row_begin[at(row)];
    const int count = lower.row_begin[at(row) + 1] - begin - 1;  // no diagonal block
    if (blocks.size() < at(count)) blocks.resize(at(count));
    detail::merged_row_values(op,
                              rows_.touched(),
                              detail::const_view(rows_.numbering().rank),
                              vertex(row),
                              {lower.col.data() + begin, at(count)},
                              {lower.source.data() + begin, at(count)},
                              blocks.data());
    if (single_)
        scale_row_blocks(single_blocks_, row, blocks.data());
    else
        scale_row_blocks(double_blocks_, row, blocks.data());
}

template <class Number>
void ScaledOperator::scale_row_blocks(Triangles<Number>& to,
                                      int row,
                                      const Mat3d* blocks) {
    const MergedBlocks& lower = rows_.lower();
    const int begin = lower.row_begin[at(row)];
    const int count = lower.row_begin[at(row) + 1] - begin - 1;
    const detail::RowScaling<Number> scaling{scale_.data(),
                                             lower.col.data() + begin,
                                             rows_.upper_place.data(),
                                             to.lower.view().data,
                                             to.upper.view().data};
    detail::scale_blocks(scaling, row, begin - row, count, blocks);
}

}  // namespace noli
