// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact detection as the Newton loop uses it: candidates of a motion, the safe step
/// along it, active pairs at a position.

#include "contact/broad_phase.hpp"
#include "contact/gap_change.hpp"
#include "contact/min_gap.hpp"
#include "contact/pairs.hpp"
#include "contact/step_bound.hpp"
#include "energy/barrier_params.hpp"
#include "model/model.hpp"
#include "step/force_change.hpp"
#include "step/settings.hpp"
#include "step/touching.hpp"

namespace noli {

/// The collision surface of a model; `kinematic` marks the vertices that are prescribed.
inline CollisionMesh collision_mesh(const Model& model,
                                    const std::vector<std::uint8_t>& kinematic) {
    CollisionMesh mesh;
    mesh.num_vertices = model.num_vertices;
    mesh.vertices = model.surface_vertices;
    mesh.edges = model.edges;
    mesh.edge_rest_sq = model.edge_rest_sq;
    mesh.triangles = model.triangles;
    mesh.body = model.body;
    mesh.kinematic = kinematic;
    mesh.num_bodies = model.num_bodies();
    mesh.pair_enabled = model.pair_enabled;
    mesh.walls = walls_of(model);
    mesh.wall_enabled = model.wall_enabled;
    return mesh;
}

template <class Exec>
class Collision {
  public:
    /// Takes the surface for one step. Cheap when `kinematic` is as before.
    void begin_step(Exec& exec,
                    const Model& model,
                    const std::vector<std::uint8_t>& kinematic) {
        min_separation_ = model.min_separation;
        if (kinematic_ != kinematic) {
            mesh_.upload(exec, collision_mesh(model, kinematic));
            kinematic_ = kinematic;
            broad_phase_.forget();
        }
        broad_phase_.sort_at_next_search();
    }

    /// Finds all pairs that get closer than dhat, beyond the minimum separation, along x
    /// + t p, t in [0, alpha]; p may be empty.
    void find_candidates_along(
        Exec& exec, View<const Vec3d> x, View<const Vec3d> p, double alpha, double dhat) {
        look_along(exec, x, p);
        find_candidates_seen(exec, x, p, alpha, dhat);
    }

    /// The same in two parts: starts to look how far the motion goes, which needs no
    /// alpha, ...
    void look_along(Exec& exec, View<const Vec3d> x, View<const Vec3d> p) {
        broad_phase_.look_along(exec, mesh_, x, p);
    }

    /// ... and finds the pairs.
    void find_candidates_seen(
        Exec& exec, View<const Vec3d> x, View<const Vec3d> p, double alpha, double dhat) {
        noli::find_candidates_seen(exec,
                                   mesh_,
                                   broad_phase_,
                                   {x, p, alpha},
                                   dhat + min_separation_,
                                   candidates_);
    }

    /// Largest safe step in [0, alpha] over the candidates of that motion.
    StepBound bound(Exec& exec,
                    View<const Vec3d> x,
                    View<const Vec3d> p,
                    double alpha,
                    double min_separation) {
        const AdvanceParams params{.slack = kCcdSlack, .min_separation = min_separation};
        return step_bound(exec, mesh_, candidates_, x, p, alpha, params, bound_work_);
    }

    /// Active pairs at x, which must lie on the motion of the last candidates.
    void find_pairs_at(Exec& exec, View<const Vec3d> x, double dhat, PairSet<Exec>& out) {
        find_pairs(exec, mesh_, candidates_, x, dhat + min_separation_, pairs_work_, out);
    }

    /// Smallest distance among pairs at x, m; +infinity without pairs.
    Later gap_at(Exec& exec, const PairSet<Exec>& pairs, View<const Vec3d> x) {
        return smallest_gap_later(exec, mesh_, pairs, x, gap_work_);
    }

    /// The bodies of these pairs; true if an elastic one was not among them before.
    bool add_touching(Exec& exec,
                      const PairSet<Exec>& pairs,
                      View<const int> body,
                      Touching<Exec>& touching) {
        return touching.add(exec, detail::reader_of(mesh_, pairs), body);
    }

    /// Largest relative change of a gap from x, where the pairs were found, to `moved`.
    Later gap_change(Exec& exec,
                     const PairSet<Exec>& pairs,
                     View<const Vec3d> x,
                     View<const Vec3d> moved) {
        return largest_gap_change_later(
            exec, mesh_, pairs, x, moved, min_separation_, change_work_);
    }

    /// The same of the normal forces, after gap_change.
    ForceChangeLater force_change(Exec& exec, const BarrierParams& barrier) {
        return force_change_later(
            exec, change_work_, barrier.exponent, barrier.dhat, min_separation_);
    }

    /// The pairs one by one, for reports.
    [[nodiscard]] detail::PairSetReader reader(const PairSet<Exec>& pairs) const {
        return detail::reader_of(mesh_, pairs);
    }

    /// The same with the first pair that has it.
    MinGap closest_at(Exec& exec, const PairSet<Exec>& pairs, View<const Vec3d> x) {
        return min_gap(exec, mesh_, pairs, x, gap_work_);
    }

  private:
    DeviceCollisionMesh<Exec> mesh_;
    BroadPhase<Exec> broad_phase_;
    Candidates<Exec> candidates_;
    StepBoundWork<Exec> bound_work_;
    FindPairsWork<Exec> pairs_work_;
    MinGapWork<Exec> gap_work_;
    GapChangeWork<Exec> change_work_;
    std::vector<std::uint8_t> kinematic_;
    double min_separation_ = 0.0;  ///< m: barriers begin to act at dhat beyond it
};

}  // namespace noli
