// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An engine whose device may fail: memory that does not suffice, a device that is lost.
/// What it throws ends here. The step is reported as failed, and the simulation keeps the
/// state of the last whole step, so that checkpoints and a repro bundle can be written.

#include "exec/device_full.hpp"
#include "sim/engine_on.hpp"

#include <exception>
#include <utility>

namespace noli {

template <class Exec>
class GuardedEngine final : public Engine {
  public:
    /// Throws what the device throws.
    GuardedEngine(const EngineInput& input, std::string name)
        : name_(std::move(name)), engine_(input), last_(engine_.state()) {}

    using Engine::step;
    StepReport step(StopFlag stop) override {
        try {
            if (!lost_) return engine_.step(stop);
        } catch (const std::exception& trouble) {
            why_ = name_ + ": " + trouble.what();
        }
        StepReport report;
        report.step = steps() + 1;
        report.outcome = Outcome::DeviceFailed;
        report.message = why_;
        return report;
    }
    StepState state() override {
        return guarded(last_, [&] { return last_ = engine_.state(); });
    }
    [[nodiscard]] int steps() const override {
        return lost_ ? last_.steps : engine_.steps();
    }
    [[nodiscard]] const std::vector<Vec3d>& positions() const override {
        try {
            if (!lost_) return engine_.positions();
        } catch (const std::exception& trouble) {
            lose(trouble);
        }
        return last_.x;
    }
    std::vector<Vec3d> velocities() override {
        return guarded(last_.v, [&] { return engine_.velocities(); });
    }
    void set_state(const StepState& state) override {
        last_ = state;
        guarded(0, [&] { return engine_.set_state(state), 0; });
    }
    std::vector<Vec3d> contact_forces() override {
        return guarded(std::vector<Vec3d>(last_.x.size(), {0.0, 0.0, 0.0}),
                       [&] { return engine_.contact_forces(); });
    }
    Residual residual() override {
        const Residual none{std::vector<Vec3d>(last_.x.size(), {0.0, 0.0, 0.0}),
                            std::vector<std::uint8_t>(last_.x.size(), 1)};
        return guarded(none, [&] { return engine_.residual(); });
    }
    double elastic_energy() override {
        return guarded(0.0, [&] { return engine_.elastic_energy(); });
    }
    double barrier_energy() override {
        return guarded(0.0, [&] { return engine_.barrier_energy(); });
    }
    [[nodiscard]] std::string device_name() const override { return name_; }
    [[nodiscard]] bool is_on_device() const override { return true; }

  private:
    /// f(), or `otherwise` where memory does not suffice for it (that may pass) and once
    /// the device no longer answers.
    template <class T, class F>
    T guarded(const T& otherwise, const F& f) {
        try {
            if (!lost_) return f();
        } catch (const DeviceFull&) {
            return otherwise;
        } catch (const std::exception& trouble) {
            lose(trouble);
        }
        return otherwise;
    }
    void lose(const std::exception& trouble) const {
        lost_ = true;
        why_ = name_ + ": " + trouble.what();
    }

    std::string name_;
    EngineOn<Exec> engine_;
    StepState last_;  ///< the last one that came to the host
    mutable bool lost_ = false;
    mutable std::string why_;
};

}  // namespace noli
