// SPDX-License-Identifier: Apache-2.0
#include "exec/arena.hpp"
#include "exec/cpu.hpp"
#include "sim/engine_on.hpp"

namespace noli {

namespace {

const char* simd_name() {
    switch (lane_dispatch()) {
        case LaneDispatch::Width8:
            return "AVX-512";
        case LaneDispatch::Width4:
            return "AVX2";
        case LaneDispatch::Width2:
            return "SSE2";
    }
    return "";
}

class CpuEngine final : public Engine {
  public:
    explicit CpuEngine(const EngineInput& input) : arena_(input.threads) {
        arena_.run([&] { engine_ = std::make_unique<EngineOn<CpuExec>>(input); });
    }

    using Engine::step;
    StepReport step(StopFlag stop) override {
        StepReport report;
        arena_.run([&] { report = engine_->step(stop); });
        return report;
    }
    StepState state() override { return engine_->state(); }
    [[nodiscard]] int steps() const override { return engine_->steps(); }
    [[nodiscard]] const std::vector<Vec3d>& positions() const override {
        return engine_->positions();
    }
    std::vector<Vec3d> velocities() override { return engine_->velocities(); }
    void set_state(const StepState& state) override { engine_->set_state(state); }
    std::vector<Vec3d> contact_forces() override {
        std::vector<Vec3d> out;
        arena_.run([&] { out = engine_->contact_forces(); });
        return out;
    }
    Residual residual() override {
        Residual out;
        arena_.run([&] { out = engine_->residual(); });
        return out;
    }
    double elastic_energy() override {
        double energy = 0.0;
        arena_.run([&] { energy = engine_->elastic_energy(); });
        return energy;
    }
    double barrier_energy() override {
        double energy = 0.0;
        arena_.run([&] { energy = engine_->barrier_energy(); });
        return energy;
    }
    [[nodiscard]] std::string device_name() const override {
        const int threads = arena_.threads();
        return "CPU, " + std::to_string(threads)
             + (threads == 1 ? " thread, " : " threads, ") + simd_name();
    }
    [[nodiscard]] bool is_on_device() const override { return false; }

  private:
    Arena arena_;
    std::unique_ptr<EngineOn<CpuExec>> engine_;
};

}  // namespace

std::unique_ptr<Engine> make_cpu_engine(const EngineInput& input) {
    return std::make_unique<CpuEngine>(input);
}

#if !defined(NOLI_HAVE_CUDA)
Result<CudaDevice> find_cuda_device() {
    return Error{Error::Code::NoDevice,
                 "--device cuda",
                 "this program was built without CUDA (the \"cuda\" preset has it)"};
}
Result<std::unique_ptr<Engine>> make_cuda_engine(const EngineInput& /*input*/) {
    return find_cuda_device().error();
}
#endif

}  // namespace noli
