// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Stiffness damping of all elastic bodies in one step: energy, gradient, and as Hessian
/// the stiffness matrix of small strains about the present shape: exact where the step
/// has only turned an element, and always positive semi-definite. Formula:
/// energy/viscosity.hpp.

#include "energy/viscosity.hpp"
#include "linear/block_matrix.hpp"
#include "objective/elastic_terms.hpp"
#include "objective/vector_loops.hpp"

namespace noli {

namespace detail {

/// The tetrahedra as they are at x, in place of their rest shapes.
template <class Exec>
void shapes_at(Exec& exec,
               View<const Int4> tets,
               View<const Vec3d> x,
               View<Mat3d> d_inv,
               View<double> volume) {
    exec.for_each("objective/shapes_at", tets.size, [=] NOLI_HD(int t) {
        const Int4& v = tets[t];
        const Mat3d d =
            from_columns(x[v[1]] - x[v[0]], x[v[2]] - x[v[0]], x[v[3]] - x[v[0]]);
        d_inv[t] = inverse(d);
        volume[t] = det(d) / 6.0;
    });
}

/// Tetrahedron t; the first `num_stable` are stable neo-Hookean, whose lambda is larger
/// by mu (lame_parameters).
NOLI_HD inline ViscousTet viscous_tet(const TetViews& in,
                                      View<const Vec3d> x,
                                      int num_stable,
                                      int t) {
    const Int4& v = in.tets[t];
    return {{x[v[0]], x[v[1]], x[v[2]], x[v[3]]},
            in.dm_inv[t],
            in.volume[t],
            in.mu[t],
            in.lambda[t] - (t < num_stable ? in.mu[t] : 0.0)};
}

}  // namespace detail

template <class Exec>
class Viscosity {
  public:
    /// Takes the shapes at x_start. `scale` = h^2 beta / dt, s^2; >= 0, 0 = no damping.
    void begin_step(Exec& exec,
                    const Model& model,
                    const BlockPattern& pattern,
                    View<const Vec3d> x_start,
                    double scale) {
        scale_ = scale;
        if (!acts()) return;
        if (shapes_.num_tets == 0) {
            shapes_.upload(exec, model);
            shapes_now_.upload(exec, model);
            matrix_.set_pattern(exec, pattern);
            diagonal_.resize(model.num_vertices);
            detail::set_zero(exec, diagonal_.view());
        }
        detail::shapes_at(exec,
                          View<const Int4>(shapes_.tets.view()),
                          x_start,
                          shapes_.dm_inv.view(),
                          shapes_.volume.view());
    }

    [[nodiscard]] bool acts() const { return scale_ > 0.0; }

    /// scale W summed, J s^2.
    Later energy_later(Exec& exec, View<const Vec3d> x) {
        const TetViews in = tet_views(shapes_);
        const int num_stable = shapes_.model_begin[1];
        const double scale = scale_;
        return exec.sum_later(
            "objective/viscous_energy", shapes_.num_tets, [=] NOLI_HD(int t) {
                return scale * viscous_energy(detail::viscous_tet(in, x, num_stable, t));
            });
    }

    /// out += its gradient
    void add_gradient(Exec& exec, View<const Vec3d> x, View<Vec3d> out) {
        const TetViews in = tet_views(shapes_);
        const int num_stable = shapes_.model_begin[1];
        const double scale = scale_;
        corners_.resize(4 * shapes_.num_tets);
        const View<Vec3d> corners = corners_.view();
        exec.for_each("objective/viscous_gradient", shapes_.num_tets, [=] NOLI_HD(int t) {
            Vec3d g[4];
            viscous_gradient(detail::viscous_tet(in, x, num_stable, t), g);
            for (int c = 0; c < 4; ++c)
                corners[4 * t + c] = scale * g[c];
        });
        gather_corners(exec, shapes_, View<const Vec3d>(corners), out);
    }

    /// The matrix at x.
    const BlockMatrix<Exec>& matrix_at(Exec& exec, View<const Vec3d> x) {
        detail::shapes_at(exec,
                          View<const Int4>(shapes_now_.tets.view()),
                          x,
                          shapes_now_.dm_inv.view(),
                          shapes_now_.volume.view());
        elastic_derivatives(exec, shapes_now_, x, scale_, corners_, blocks_);
        matrix_.assemble(exec, blocks_.view(), View<const double>(diagonal_.view()));
        return matrix_;
    }

  private:
    double scale_ = 0.0;
    /// With the shapes at the step's start, and the present ones, as rest shapes.
    DeviceModel<Exec> shapes_, shapes_now_;
    BlockMatrix<Exec> matrix_;
    typename Exec::template Buffer<Vec3d> corners_;
    typename Exec::template Buffer<double> blocks_, diagonal_;
};

}  // namespace noli
