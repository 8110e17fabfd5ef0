// SPDX-License-Identifier: Apache-2.0
/// The engine's text as a device runs it. Without a GPU: on an executor whose memory may
/// only be touched inside of kernels, so that host code which looks into a view dies.
/// With a GPU: on CUDA.
#include "noli/simulator.hpp"

#include "exec/cpu.hpp"
#include "linear/block_pattern.hpp"
#include "sim/engine_on.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <sys/mman.h>
#include <vector>

namespace noli {
namespace {

/// "Device" memory: closed unless somebody holds an Open.
class DeviceMemory {
  public:
    static void* take(std::size_t bytes) {
        Pool& p = pool();
        const std::size_t begin = p.used;
        p.used += (bytes + kPage - 1) / kPage * kPage;
        if (p.used > kSize) throw std::bad_alloc();
        return p.base + begin;
    }

    class Open {
      public:
        Open() {
            if (pool().open++ == 0) protect(PROT_READ | PROT_WRITE);
        }
        ~Open() {
            if (--pool().open == 0) protect(PROT_NONE);
        }
        Open(const Open&) = delete;
        Open& operator=(const Open&) = delete;
    };

  private:
    struct Pool {
        char* base = static_cast<char*>(mmap(nullptr,
                                             kSize,
                                             PROT_NONE,
                                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                                             -1,
                                             0));
        std::size_t used = 0;
        int open = 0;
    };
    static Pool& pool() {
        static Pool pool;
        return pool;
    }
    static void protect(int how) { mprotect(pool().base, pool().used, how); }

    static constexpr std::size_t kPage = 4096;
    static constexpr std::size_t kSize = std::size_t{1}
                                      << 30;  // of addresses, not of memory
};

/// Never gives memory back; a test is short. New memory holds NaN.
template <class T>
class ClosedBuffer {
  public:
    void resize(int n) {
        if (n > capacity_) {
            capacity_ = 2 * n;
            const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(capacity_);
            data_ = static_cast<T*>(DeviceMemory::take(bytes));
            const DeviceMemory::Open open;
            std::memset(static_cast<void*>(data_), 0xFF, bytes);
        }
        size_ = n;
    }
    [[nodiscard]] int size() const { return size_; }
    View<T> view() { return {data_, size_}; }
    [[nodiscard]] View<const T> view() const { return {data_, size_}; }

  private:
    T* data_ = nullptr;
    int size_ = 0;
    int capacity_ = 0;
};

/// Takes every decision of the text that a GPU takes, on one thread of the host.
class DeviceLikeExec {
  public:
    template <class T>
    using Buffer = ClosedBuffer<T>;
    static constexpr bool kIsDevice = true;

    template <class F>
    void for_each(const char* name, int n, F f, int grain = 1) {
        const DeviceMemory::Open open;
        host_.for_each(name, n, f, grain);
    }
    template <class F>
    void for_lanes(const char* /*name*/, int n, F f) {
        const DeviceMemory::Open open;
        for (int i = 0; i < n; ++i)
            f(Lane<double>{i});
    }
    template <class F>
    double sum(const char* name, int n, F f) {
        const DeviceMemory::Open open;
        return host_.sum(name, n, f);
    }
    template <class F>
    double min(const char* name, int n, F f) {
        const DeviceMemory::Open open;
        return host_.min(name, n, f);
    }
    int scan(const char* name, View<const int> counts, View<int> offsets) {
        const DeviceMemory::Open open;
        return host_.scan(name, counts, offsets);
    }
    template <class Key>
    void sort_by_key(const char* name, View<Key> keys, View<int> values) {
        const DeviceMemory::Open open;
        host_.sort_by_key(name, keys, values);
    }
    template <class T>
    void upload(const std::vector<T>& from, ClosedBuffer<T>& to) {
        to.resize(static_cast<int>(from.size()));
        const DeviceMemory::Open open;
        std::copy(from.begin(), from.end(), to.view().begin());
    }
    template <class T>
    void download(View<const T> from, std::vector<T>& to) {
        const DeviceMemory::Open open;
        host_.download(from, to);
    }
    template <class T>
    void copy(View<const T> from, View<T> to) {
        const DeviceMemory::Open open;
        host_.copy(from, to);
    }
    template <class T>
    T read(View<const T> from, int i) {
        const DeviceMemory::Open open;
        return from[i];
    }

  private:
    ShuffledExec
        host_;  // kernels run in a scrambled order: results must not depend on it
};

/// A box that lands askew on another one, which stands on a slope: all kinds of pairs,
/// friction.
Scene pile() {
    Scene scene;
    scene.dt = 0.01;
    scene.damping.stiffness = 1e-3;
    Body below;
    below.name = "below";
    below.mesh.generator = "box";
    below.transform.rows[1][3] = 0.501;
    below.friction = 0.3;
    Body above = below;
    above.name = "above";
    above.transform.rows = {{{0.8, 0, 0.6, 0.2}, {0, 1, 0, 1.503}, {-0.6, 0, 0.8, 0.1}}};
    above.velocity = {0.1, -1.0, 0};
    scene.bodies = {below, above};
    HalfSpace ground;
    ground.name = "ground";
    ground.friction = 0.3;
    scene.half_spaces = {ground};
    return scene;
}

constexpr int kSteps = 12;

StepSettings settings_of(const Scene& scene, const Model& model) {
    StepSettings out;
    out.dt = scene.dt;
    out.dhat = model.dhat;
    out.epsv = model.epsv;
    out.diagonal = model.diagonal;
    out.mean_mass = model.mean_mass;
    out.has_friction = true;
    out.contact = scene.contact;
    out.damping = scene.damping;
    out.solver = scene.solver;
    return out;
}

double largest_difference(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double largest = a.size() == b.size() ? 0.0 : HUGE_VAL;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        largest = std::max(largest, max_abs(a[i] - b[i]));
    return largest;
}

void expect_device_text_matches_cpu(const Scene& scene) {
    const Result<Model> model = build_model(scene);
    ASSERT_TRUE(model) << model.error().message;
    const BlockPattern pattern =
        build_block_pattern(model.value().num_vertices, model.value().tets);
    const StepSettings settings = settings_of(scene, model.value());
    const EngineInput input{model.value(), pattern, settings, scene.gravity, 1};
    EngineOn<DeviceLikeExec> device(input);
    const std::unique_ptr<Engine> cpu = make_cpu_engine(input);
    int most_contacts = 0;
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = device.step();
        ASSERT_EQ(report.outcome, Outcome::Converged) << report.message;
        ASSERT_EQ(cpu->step().outcome, Outcome::Converged);
        most_contacts = std::max(most_contacts, report.contacts);
    }
    EXPECT_GT(most_contacts, 20);
    // The preconditioners differ, so the two agree as far as Newton's tolerance goes.
    const double tolerance = model.value().tolerance(scene.solver, 0) * scene.dt * kSteps;
    EXPECT_LT(largest_difference(device.state().x, cpu->state().x), tolerance);
    EXPECT_EQ(device.contact_forces().size(), device.state().x.size());
    EXPECT_NEAR(
        device.elastic_energy(), cpu->elastic_energy(), 0.05 * cpu->elastic_energy());
}

TEST(DeviceMemory, EndsAProgramThatTouchesItOutsideOfKernels) {
    DeviceLikeExec exec;
    ClosedBuffer<int> buffer;
    exec.upload(std::vector<int>{1, 2, 3}, buffer);
    EXPECT_EQ(exec.read(View<const int>(buffer.view()), 2), 3);
    EXPECT_DEATH(buffer.view()[2] = 4, "");
}

TEST(DeviceText, TouchesDeviceMemoryInKernelsOnlyAndMatchesTheCpu) {
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.pcg_tolerance = 1e-8;
    expect_device_text_matches_cpu(scene);
}

TEST(DeviceText, DoesSoWithTheDirectSolver) {
    if (!CholmodSolver::available()) GTEST_SKIP() << "this build has no CHOLMOD";
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.linear = LinearSolver::Cholmod;
    expect_device_text_matches_cpu(scene);
}

TEST(CudaEngine, MatchesTheCpu) {
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.pcg_tolerance = 1e-8;
    SimulatorOptions options;
    options.device = Device::Cuda;
    Result<Simulator> cuda = Simulator::create(scene, options);
    if (!cuda) {
        ASSERT_EQ(cuda.error().code, Error::Code::NoDevice);
        GTEST_SKIP() << cuda.error().message;
    }
    options.device = Device::Cpu;
    Result<Simulator> cpu = Simulator::create(scene, options);
    ASSERT_TRUE(cpu);
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = cuda.value().step();
        ASSERT_EQ(report.outcome, Outcome::Converged) << report.message;
        ASSERT_EQ(cpu.value().step().outcome, Outcome::Converged);
    }
    EXPECT_EQ(cuda.value().verify().num_intersections, 0);
    const auto& a = cuda.value().positions();
    const auto& b = cpu.value().positions();
    ASSERT_EQ(a.size(), b.size());
    const double tolerance = cpu.value().resolved().tolerance * scene.dt * kSteps;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(a[i][c], b[i][c], tolerance) << "vertex " << i;
}

}  // namespace
}  // namespace noli
