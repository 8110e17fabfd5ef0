// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The solver behind a Simulator, without saying where it runs.

#include "noli/simulator.hpp"

#include "linear/block_pattern.hpp"
#include "model/model.hpp"
#include "step/settings.hpp"
#include "step/stepper.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace noli {

class Engine {
  public:
    Engine() = default;
    virtual ~Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// See Simulator::step.
    virtual StepReport step(StopFlag stop) = 0;
    StepReport step() { return step(nullptr); }
    virtual StepState state() = 0;
    [[nodiscard]] virtual int steps() const = 0;
    /// Of the last step's end, m.
    [[nodiscard]] virtual const std::vector<Vec3d>& positions() const = 0;
    virtual std::vector<Vec3d> velocities() = 0;  ///< m/s
    virtual void set_state(const StepState& state) = 0;
    virtual std::vector<Vec3d> contact_forces() = 0;  ///< N, of the last step's end
    /// What the last step left unbalanced.
    virtual Residual residual() = 0;
    virtual double elastic_energy() = 0;  ///< J
    virtual double barrier_energy() = 0;  ///< of the last step's end, J
    [[nodiscard]] virtual std::string device_name() const = 0;
    [[nodiscard]] virtual bool is_on_device() const = 0;
};

/// What an engine is built from; all must outlive it.
struct EngineInput {
    const Model& model;
    const BlockPattern& pattern;
    const StepSettings& settings;
    Vector3 gravity;
    int threads;
};

std::unique_ptr<Engine> make_cpu_engine(const EngineInput& input);

/// A GPU that can be used.
struct CudaDevice {
    std::string name;
    std::size_t stack_bytes = 0;  ///< that kernels set aside whatever the scene
};

/// Nothing of the CUDA engine has run on a GPU yet, so "--device auto" takes the CPU also
/// where a usable GPU is. True once `make gpu-check` has passed on one
/// (docs/decisions/008-device-solver.md).
inline constexpr bool kAutoTakesGpu = false;

/// Says in one sentence why there is none: built without CUDA, no driver, too old a
/// driver, no device, too old a device.
Result<CudaDevice> find_cuda_device();

/// Fails without a usable GPU, and if its memory does not suffice.
Result<std::unique_ptr<Engine>> make_cuda_engine(const EngineInput& input);

/// What "--device cuda" takes: make_cuda_engine, unless a test has put another device in
/// the place of the GPU.
using EngineMaker = std::function<Result<std::unique_ptr<Engine>>(const EngineInput&)>;
EngineMaker& device_engine_maker();

}  // namespace noli
