// SPDX-License-Identifier: Apache-2.0
#include "exec/cuda.cuh"
#include "sim/engine_on.hpp"

#include <exception>

namespace noli {

namespace {

class CudaEngine final : public Engine {
  public:
    CudaEngine(const EngineInput& input, std::string name)
        : name_(std::move(name)), engine_(input) {}

    StepReport step() override {
        try {
            return engine_.step();
        } catch (const std::exception& trouble) {
            StepReport report;
            report.outcome = Outcome::NumericalTrouble;
            report.message = name_ + ": " + trouble.what();
            return report;
        }
    }
    StepState state() override { return engine_.state(); }
    [[nodiscard]] int steps() const override { return engine_.steps(); }
    [[nodiscard]] const std::vector<Vec3d>& positions() const override {
        return engine_.positions();
    }
    std::vector<Vec3d> velocities() override { return engine_.velocities(); }
    void set_state(const StepState& state) override { engine_.set_state(state); }
    std::vector<Vec3d> contact_forces() override { return engine_.contact_forces(); }
    double elastic_energy() override { return engine_.elastic_energy(); }
    double barrier_energy() override { return engine_.barrier_energy(); }
    [[nodiscard]] std::string device_name() const override { return name_; }

  private:
    std::string name_;
    EngineOn<CudaExec> engine_;
};

Error no_device(const std::string& why) {
    return {Error::Code::NoDevice,
            "--device cuda",
            why + "; use --device cpu, or run where a GPU is"};
}

}  // namespace

Result<std::unique_ptr<Engine>> make_cuda_engine(const EngineInput& input) {
    int count = 0;
    const cudaError_t found = cudaGetDeviceCount(&count);
    if (found == cudaErrorInsufficientDriver)
        return no_device(
            "no NVIDIA driver, or one too old for this program's CUDA runtime");
    if (found != cudaSuccess || count == 0) return no_device("no NVIDIA GPU was found");
    cudaDeviceProp properties{};
    if (cudaGetDeviceProperties(&properties, 0) != cudaSuccess)
        return no_device("the GPU does not answer");
    if (properties.major < 8)
        return no_device(std::string(properties.name) + " has compute capability "
                         + std::to_string(properties.major) + "."
                         + std::to_string(properties.minor) + ", at least 8.0 is needed");
    try {
        return std::unique_ptr<Engine>(
            std::make_unique<CudaEngine>(input, properties.name));
    } catch (const std::exception& trouble) {
        return no_device(std::string(properties.name) + ": " + trouble.what());
    }
}

}  // namespace noli
