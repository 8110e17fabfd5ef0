// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Loops over tetrahedra: energy, gradient and Hessian blocks of elasticity, the largest
/// step that inverts nothing, and stresses for output. Formulas: energy/elastic.hpp,
/// energy/tet.hpp.

#include "core/lane_load.hpp"
#include "energy/tet.hpp"
#include "exec/lanes.hpp"
#include "exec/later.hpp"
#include "geometry/inversion.hpp"
#include "objective/device_model.hpp"

namespace noli {

/// Tetrahedra as kernels see them.
struct TetViews {
    View<const Int4> tets;
    View<const Mat3d> dm_inv;
    View<const double> volume, mu, lambda;
};

template <class Exec>
TetViews tet_views(const DeviceModel<Exec>& model) {
    return {model.tets.view(),
            model.dm_inv.view(),
            model.volume.view(),
            model.mu.view(),
            model.lambda.view()};
}

namespace detail {

template <class T>
NOLI_HD inline TetShape<T> load_tet(const TetViews& in,
                                    View<const Vec3d> x,
                                    int first,
                                    double scale) {
    TetShape<T> shape;
    for (int c = 0; c < 4; ++c)
        shape.x[c] = load_vec3_lanes<T>([&](int j) { return x[in.tets[first + j][c]]; });
    for (int k = 0; k < 9; ++k)
        shape.dm_inv.a[k] =
            load_lanes<T>([&](int j) { return in.dm_inv[first + j].a[k]; });
    shape.weight = load_lanes<T>([&](int j) { return scale * in.volume[first + j]; });
    return shape;
}

template <class T>
NOLI_HD inline LameParameters<T> load_lame(const TetViews& in, int first) {
    return {load_lanes<T>([&](int j) { return in.mu[first + j]; }),
            load_lanes<T>([&](int j) { return in.lambda[first + j]; })};
}

inline constexpr bool kResist = true;  ///< elements resist being crushed: crush.hpp

template <ElasticModel M>
struct TetEnergyKernel {
    TetViews in;
    View<const Vec3d> x;
    double scale;
    int begin;
    View<double> out;  ///< one per tet

    template <class T>
    NOLI_HD void operator()(Lane<T> lane) const {
        const int first = begin + lane.first;
        const T energy = tet_energy<M, kResist>(load_tet<T>(in, x, first, scale),
                                                load_lame<T>(in, first));
        for (int j = 0; j < kLaneWidth<T>; ++j)
            out[first + j] = lane_of(energy, j);
    }
};

template <class T>
NOLI_HD inline void store_corner_gradients(const Vec3<T> (&g)[4],
                                           int first,
                                           View<Vec3d> out) {
    for (int j = 0; j < kLaneWidth<T>; ++j)
        for (int c = 0; c < 4; ++c)
            out[4 * (first + j) + c] = {
                lane_of(g[c].x, j), lane_of(g[c].y, j), lane_of(g[c].z, j)};
}

template <ElasticModel M>
struct TetGradientKernel {
    TetViews in;
    View<const Vec3d> x;
    double scale;
    int begin;
    View<Vec3d> corners;  ///< 4 per tet

    template <class T>
    NOLI_HD void operator()(Lane<T> lane) const {
        const int first = begin + lane.first;
        const auto g = tet_gradient<M, kResist>(load_tet<T>(in, x, first, scale),
                                                load_lame<T>(in, first));
        store_corner_gradients<T>(g.g, first, corners);
    }
};

template <ElasticModel M>
struct TetHessianKernel {
    TetViews in;
    View<const Vec3d> x;
    double scale;
    int begin;
    View<Vec3d> corners;  ///< 4 per tet
    View<double> blocks;  ///< 90 per tet: the 10 upper 3x3 blocks
    bool project;

    template <class T>
    NOLI_HD void operator()(Lane<T> lane) const {
        const int first = begin + lane.first;
        const auto all = tet_derivatives<M, kResist>(
            load_tet<T>(in, x, first, scale), load_lame<T>(in, first), project);
        store_corner_gradients<T>(all.gradient.g, first, corners);
        for (int j = 0; j < kLaneWidth<T>; ++j) {
            double* to = blocks.data + 90 * static_cast<long>(first + j);
            for (int b = 0; b < 10; ++b)
                for (int k = 0; k < 9; ++k)
                    to[9 * b + k] = lane_of(all.hessian.block[b].a[k], j);
        }
    }
};

/// Runs Kernel<M> over the tets of each elastic model.
template <template <ElasticModel> class Kernel, class Exec, class... Rest>
void for_each_model(Exec& exec,
                    const char* name,
                    const DeviceModel<Exec>& model,
                    View<const Vec3d> x,
                    double scale,
                    Rest... rest) {
    const auto& begin = model.model_begin;
    const TetViews in = tet_views(model);
    if (begin[1] > begin[0])
        exec.for_lanes(
            name,
            begin[1] - begin[0],
            Kernel<ElasticModel::StableNeoHookean>{in, x, scale, begin[0], rest...});
    if (begin[2] > begin[1])
        exec.for_lanes(name,
                       begin[2] - begin[1],
                       Kernel<ElasticModel::NeoHookean>{in, x, scale, begin[1], rest...});
    if (begin[3] > begin[2])
        exec.for_lanes(
            name,
            begin[3] - begin[2],
            Kernel<ElasticModel::FixedCorotated>{in, x, scale, begin[2], rest...});
}

}  // namespace detail

/// sum of scale V Psi(F), J times `scale`. `per_tet` is scratch.
template <class Exec>
Later elastic_energy_sum(Exec& exec,
                         const DeviceModel<Exec>& model,
                         View<const Vec3d> x,
                         double scale,
                         typename Exec::template Buffer<double>& per_tet) {
    per_tet.resize(model.num_tets);
    detail::for_each_model<detail::TetEnergyKernel>(
        exec, "objective/tet_energy", model, x, scale, per_tet.view());
    const View<const double> energies = per_tet.view();
    return exec.sum_later("objective/tet_energy_sum", model.num_tets, [=] NOLI_HD(int t) {
        return energies[t];
    });
}

/// Gradient of scale V Psi(F) at the 4 corners of each tet.
template <class Exec>
void elastic_gradients(Exec& exec,
                       const DeviceModel<Exec>& model,
                       View<const Vec3d> x,
                       double scale,
                       typename Exec::template Buffer<Vec3d>& corners) {
    corners.resize(4 * model.num_tets);
    detail::for_each_model<detail::TetGradientKernel>(
        exec, "objective/tet_gradient", model, x, scale, corners.view());
}

/// Gradient, and the Hessian, projected or exact, as 10 upper 3x3 blocks per tet.
template <class Exec>
void elastic_derivatives(Exec& exec,
                         const DeviceModel<Exec>& model,
                         View<const Vec3d> x,
                         double scale,
                         typename Exec::template Buffer<Vec3d>& corners,
                         typename Exec::template Buffer<double>& blocks,
                         bool project = true) {
    corners.resize(4 * model.num_tets);
    blocks.resize(90 * model.num_tets);
    detail::for_each_model<detail::TetHessianKernel>(exec,
                                                     "objective/tet_hessian",
                                                     model,
                                                     x,
                                                     scale,
                                                     corners.view(),
                                                     blocks.view(),
                                                     project);
}

/// out[v] += sum of the corner gradients of vertex v.
template <class Exec>
void gather_corners(Exec& exec,
                    const DeviceModel<Exec>& model,
                    View<const Vec3d> corner_gradients,
                    View<Vec3d> out) {
    const View<const int> begin = model.corner_begin.view();
    const View<const int> corners = model.corners.view();
    exec.for_each("objective/gather_corners", model.num_vertices, [=] NOLI_HD(int v) {
        Vec3d sum{0.0, 0.0, 0.0};
        for (int k = begin[v]; k < begin[v + 1]; ++k)
            sum += corner_gradients[corners[k]];
        out[v] += sum;
    });
}

namespace detail {

/// out[t] = inversion_bound of tet t. What surely keeps its volume needs no more than
/// that test.
struct InversionBoundKernel {
    View<const Int4> tets;
    View<const Vec3d> x, p;
    double keep;
    View<double> out;

    template <class T>
    NOLI_HD void operator()(Lane<T> lane) const {
        Vec3<T> at[4];
        Vec3<T> move[4];
        for (int c = 0; c < 4; ++c) {
            at[c] = load_vec3_lanes<T>([&](int j) { return x[tets[lane.first + j][c]]; });
            move[c] =
                load_vec3_lanes<T>([&](int j) { return p[tets[lane.first + j][c]]; });
        }
        const T bound = select(surely_keeps_volume(at, move, keep), T(1.0), T(0.0));
        for (int j = 0; j < kLaneWidth<T>; ++j)
            out[lane.first + j] = lane_of(bound, j) > 0.0 ? 1.0 : solved(lane.first + j);
    }

  private:
    [[nodiscard]] NOLI_HD double solved(int t) const {
        Stencil<4> at;
        Stencil<4> move;
        for (int c = 0; c < 4; ++c) {
            at.x[c] = x[tets[t][c]];
            move.x[c] = p[tets[t][c]];
        }
        return inversion_bound(at, move, keep);
    }
};

}  // namespace detail

/// Largest t in (0, 1] for which every tet keeps `keep` of its volume along x + t p, and
/// that tet.
struct InversionBound {
    double alpha = 1.0;
    int tet = -1;
};

/// An InversionBound on its way to the host.
struct InversionLater {
    Later alpha, tet;

    template <class Exec>
    [[nodiscard]] InversionBound value(Exec& exec) const {
        const double bound = std::fmin(1.0, exec.value(alpha));
        if (!(bound < 1.0)) return {};
        return {bound, static_cast<int>(exec.value(tet))};
    }
};

namespace detail {

/// First tet whose bound is the smallest one, *least.
template <class Exec>
Later first_inverting(Exec& exec, const double* least, View<const double> bound) {
    return exec.min_later("objective/inversion_argmin", bound.size, [=] NOLI_HD(int t) {
        return bound[t] <= *least ? static_cast<double>(t) : HUGE_VAL;
    });
}

}  // namespace detail

template <class Exec>
InversionLater inversion_step_bound(Exec& exec,
                                    const DeviceModel<Exec>& model,
                                    View<const Vec3d> x,
                                    View<const Vec3d> p,
                                    double keep,
                                    typename Exec::template Buffer<double>& per_tet) {
    per_tet.resize(model.num_tets);
    const View<const double> bound = per_tet.view();
    exec.for_lanes(
        "objective/inversion_bound",
        model.num_tets,
        detail::InversionBoundKernel{model.tets.view(), x, p, keep, per_tet.view()});
    InversionLater out;
    if (model.num_tets == 0) return {{-1, HUGE_VAL}, {}};
    out.alpha = exec.min_later(
        "objective/inversion_min", bound.size, [=] NOLI_HD(int t) { return bound[t]; });
    out.tet = detail::first_inverting(exec, exec.place(out.alpha), bound);
    return out;
}

}  // namespace noli
