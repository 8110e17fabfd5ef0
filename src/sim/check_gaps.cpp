// SPDX-License-Identifier: Apache-2.0
/// Gaps at the start: what cannot be told from contact, and what the barrier throws
/// apart.

#include "sim/start_checks.hpp"
#include "sim/step_settings.hpp"
#include "step/stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace noli {

namespace {

constexpr double kTouching = 64.0;   ///< gap over the rounding of the coordinates
constexpr double kFewDigits = 1e-6;  ///< gap over dhat
constexpr double kThrown = 0.1;      ///< thrown speed over the speeds of the scene

class GapCheck {
  public:
    GapCheck(const Scene& scene, const Model& model)
        : scene_(scene),
          model_(model),
          mass_(body_masses(model)),
          sizes_(body_sizes(model)),
          velocity_(mass_.size(), Vec3d{0, 0, 0}) {
        const StepSettings settings = step_settings(scene, model);
        kappa_ = settings.contact.kappa > 0.0 ? settings.contact.kappa
                                              : stiffness_range(settings).low;
        for (std::size_t v = 0; v < model.v0.size(); ++v) {
            const std::size_t b = static_cast<std::size_t>(model.body[v]);
            if (mass_[b] > 0.0) velocity_[b] += (model.mass[v] / mass_[b]) * model.v0[v];
        }
    }

    void check(const BodyGap& gap, Findings& out) const {
        const double least = kTouching * rounding_at(gap.closest);
        if (gap.closest.gap <= least) return touching(gap, least, out);
        if (gap.closest.gap < kFewDigits * model_.dhat) return nearly(gap, out);
        const double speed = thrown_speed(gap);
        if (speed > kThrown * usual_speed(gap)) thrown(gap, speed, out);
    }

  private:
    [[nodiscard]] std::string who(const BodyGap& gap) const {
        const auto body = [&](int b) {
            return "\"" + model_.body_names[static_cast<std::size_t>(b)] + "\"";
        };
        if (gap.plane >= 0)
            return body(gap.a) + " and half-space \""
                 + model_.walls[static_cast<std::size_t>(gap.plane)].name + "\"";
        return gap.a == gap.b ? body(gap.a) + " and itself"
                              : body(gap.a) + " and " + body(gap.b);
    }

    void touching(const BodyGap& gap, double least, Findings& out) const {
        out.push_back(
            {Finding::Severity::Error,
             who(gap),
             fmt::format(
                 "touch: {} are {:g} m apart, which rounding of their coordinates "
                 "({:.1g} m) cannot tell from contact; leave a gap of more than "
                 "{:.1g} m, better of dhat = {:g} m, where contact begins to push",
                 describe_pair(model_, gap.closest),
                 gap.closest.gap,
                 least / kTouching,
                 std::max(least, kFewDigits * model_.dhat),
                 model_.dhat)});
    }

    void nearly(const BodyGap& gap, Findings& out) const {
        out.push_back(
            {Finding::Severity::Warning,
             who(gap),
             fmt::format(
                 "all but touch: {} are {:g} m apart, {:.1g} of dhat; they may stick "
                 "there "
                 "for many steps, stall the first one, or be thrown apart; leave a gap "
                 "of "
                 "more than {:.1g} m, better of dhat = {:g} m, where contact begins to "
                 "push",
                 describe_pair(model_, gap.closest),
                 gap.closest.gap,
                 gap.closest.gap / model_.dhat,
                 0.1 * model_.dhat,
                 model_.dhat)});
    }

    void thrown(const BodyGap& gap, double speed, Findings& out) const {
        out.push_back(
            {Finding::Severity::Warning,
             who(gap),
             fmt::format(
                 "start {:g} m apart, within dhat = {:g} m: contact pushes them apart "
                 "from the first step, with up to {:.2g} m/s; start them dhat apart, "
                 "or choose a smaller dhat",
                 gap.closest.gap,
                 model_.dhat,
                 speed)});
    }

    /// Of the coordinates of the pair, m.
    [[nodiscard]] double rounding_at(const MinGap& pair) const {
        const int used = pair.kind == MinGap::Kind::Wall ? 1 : 4;
        double farthest = 0.0;
        for (int k = 0; k < used; ++k)
            if (pair.vertices[k] >= 0)
                farthest = std::max(
                    farthest,
                    max_abs(model_.x0[static_cast<std::size_t>(pair.vertices[k])]));
        return std::numeric_limits<double>::epsilon() * farthest;
    }

    /// 1 / mass of a body that can be thrown; 0 for obstacles and half-spaces.
    [[nodiscard]] double mobility(int body) const {
        if (body < 0) return 0.0;
        const double mass = mass_[static_cast<std::size_t>(body)];
        return mass > 0.0 ? 1.0 / mass : 0.0;
    }

    /// Relative speed (m/s) if all energy of the barrier, kappa B / dt^2, became motion;
    /// but one step moves bodies no farther than out of dhat, and then the barrier ends.
    [[nodiscard]] double thrown_speed(const BodyGap& gap) const {
        if (gap.a == gap.b) return 0.0;
        const double dt = scene_.dt;
        const double energy = kappa_ * gap.barrier / (dt * dt);
        const double free = std::sqrt(2.0 * energy * (mobility(gap.a) + mobility(gap.b)));
        return std::min(free, (model_.dhat - gap.closest.gap) / dt);
    }

    /// What to compare with: the relative speed at the start, or that after a fall by the
    /// size of the smaller body, or the speed that takes a body through its size in the
    /// duration of the scene.
    [[nodiscard]] double usual_speed(const BodyGap& gap) const {
        double size = HUGE_VAL;
        Vec3d relative{0, 0, 0};
        for (const int b : {gap.a, gap.b}) {
            if (b < 0 || mobility(b) == 0.0) continue;
            const std::size_t k = static_cast<std::size_t>(b);
            size = std::min(size, max_abs(sizes_[k]));
            relative = velocity_[k] - relative;
        }
        const Vec3d g{scene_.gravity[0], scene_.gravity[1], scene_.gravity[2]};
        return std::max(
            {norm(relative), std::sqrt(2.0 * norm(g) * size), size / scene_.duration});
    }

    const Scene& scene_;
    const Model& model_;
    std::vector<double> mass_;
    std::vector<Vec3d> sizes_;
    std::vector<Vec3d> velocity_;
    double kappa_ = 0.0;
};

}  // namespace

void check_gaps(const Scene& scene,
                const Model& model,
                const std::vector<BodyGap>& gaps,
                Findings& out) {
    if (gaps.empty()) return;
    const GapCheck check(scene, model);
    for (const BodyGap& gap : gaps)
        check.check(gap, out);
}

}  // namespace noli
