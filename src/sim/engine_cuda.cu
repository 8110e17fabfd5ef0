// SPDX-License-Identifier: Apache-2.0
#include "exec/cuda.cuh"
#include "sim/estimate.hpp"
#include "sim/guarded_engine.hpp"

#include <exception>

namespace noli {

namespace {

constexpr int kLeastComputeCapability = 8;

/// Stack of the kernel that needs most (tools/check_ptxas.py); the driver sets it aside
/// for every thread that the GPU can hold.
constexpr std::size_t kStackBytes = 13 * 1024 + 512;

Error no_device(const std::string& why) {
    return {Error::Code::NoDevice, "--device cuda", why};
}

/// 13020 -> "13.2"
std::string version_text(int version) {
    return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

/// Why the driver cannot be used; empty if it can.
std::string driver_trouble() {
    int driver = 0;
    int runtime = 0;
    cudaDriverGetVersion(&driver);
    cudaRuntimeGetVersion(&runtime);
    if (driver == 0) return "no NVIDIA driver is installed";
    if (driver / 1000 < runtime / 1000)
        return "the NVIDIA driver is too old: it serves CUDA " + version_text(driver)
             + ", this program needs " + std::to_string(runtime / 1000) + ".0";
    return "";
}

}  // namespace

Result<CudaDevice> find_cuda_device() {
    if (const std::string trouble = driver_trouble(); !trouble.empty())
        return no_device(trouble);
    int count = 0;
    const cudaError_t found = cudaGetDeviceCount(&count);
    cudaGetLastError();
    if (found == cudaErrorInsufficientDriver)
        return no_device("the NVIDIA driver is too old for this program");
    if (found != cudaSuccess && found != cudaErrorNoDevice)
        return no_device(std::string("the NVIDIA driver does not work: ")
                         + cudaGetErrorString(found));
    if (count == 0) return no_device("no NVIDIA GPU was found");
    cudaDeviceProp properties{};
    if (cudaGetDeviceProperties(&properties, 0) != cudaSuccess)
        return no_device("the GPU does not answer");
    if (properties.major < kLeastComputeCapability)
        return no_device(std::string(properties.name) + " has compute capability "
                         + std::to_string(properties.major) + "."
                         + std::to_string(properties.minor) + ", at least "
                         + std::to_string(kLeastComputeCapability) + ".0 is needed");
    const std::size_t threads =
        static_cast<std::size_t>(properties.multiProcessorCount)
        * static_cast<std::size_t>(properties.maxThreadsPerMultiProcessor);
    return CudaDevice{properties.name, threads * kStackBytes};
}

Result<std::unique_ptr<Engine>> make_cuda_engine(const EngineInput& input) {
    const Result<CudaDevice> device = find_cuda_device();
    if (!device) return device.error();
    try {
        std::size_t free = 0;
        std::size_t total = 0;
        check_cuda(cudaMemGetInfo(&free, &total), "ask for free device memory");
        const std::string trouble =
            device_memory_trouble(input, device.value(), free, total);
        if (!trouble.empty()) return no_device(trouble);
        return std::unique_ptr<Engine>(
            std::make_unique<GuardedEngine<CudaExec>>(input, device.value().name));
    } catch (const std::exception& trouble) {
        return no_device(device.value().name + ": " + trouble.what());
    }
}

}  // namespace noli
