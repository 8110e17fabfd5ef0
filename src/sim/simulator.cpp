// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "model/origin.hpp"
#include "model/rotation.hpp"
#include "output/hash.hpp"
#include "sim/beyond_walls.hpp"
#include "sim/engine.hpp"
#include "sim/estimate.hpp"
#include "sim/net_force.hpp"
#include "sim/squeeze.hpp"
#include "sim/start_checks.hpp"
#include "sim/state_bytes.hpp"
#include "sim/step_settings.hpp"
#include "sim/stress.hpp"
#include "sim/verify.hpp"
#include "step/sound_travel.hpp"

#include <algorithm>
#include <chrono>
#include <sys/resource.h>

namespace noli {

namespace {

Vector3 to_array(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

std::vector<Vector3> to_arrays(const std::vector<Vec3d>& items) {
    std::vector<Vector3> out(items.size());
    std::transform(items.begin(), items.end(), out.begin(), to_array);
    return out;
}

double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

EngineMaker& device_engine_maker() {
    static EngineMaker maker = make_cuda_engine;
    return maker;
}

const char* to_string(Outcome outcome) {
    switch (outcome) {
        case Outcome::Converged:
            return "converged";
        case Outcome::MaxIterations:
            return "max_iterations";
        case Outcome::Stalled:
            return "stalled";
        case Outcome::LinearSolverFailed:
            return "linear_solver_failed";
        case Outcome::NumericalTrouble:
            return "numerical_trouble";
        case Outcome::BoundaryBlocked:
            return "boundary_blocked";
        case Outcome::Intersecting:
            return "intersecting";
        case Outcome::DeviceFailed:
            return "device_failed";
        case Outcome::Cancelled:
            return "cancelled";
    }
    return "unknown";
}

struct Simulator::Impl {
    Scene scene;
    SimulatorOptions options;
    Model model;
    BlockPattern pattern;
    StepSettings settings;
    std::unique_ptr<Engine> engine;
    std::unique_ptr<Verifier> verifier;  // made when first needed
    Resolved resolved;
    // The public face speaks of plain arrays; these are copies in its types.
    std::vector<std::array<int, 4>> tets;
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::array<int, 2>> segments;

    Status start();
    Verifier& exact() {
        if (!verifier) verifier = std::make_unique<Verifier>(model);
        return *verifier;
    }
    void explain(StepReport& report);
    Status choose_engine();
    void copy_topology();
    void resolve();
};

/// Adds to the message of a failed step what only a look at whole bodies can tell.
void Simulator::Impl::explain(StepReport& report) {
    if (report.outcome == Outcome::Converged || report.outcome == Outcome::Cancelled
        || report.outcome == Outcome::DeviceFailed)
        return;
    const std::string squeezed = describe_squeeze(
        model, exact().gaps(engine->positions(), settings.contact.barrier_exponent));
    if (!squeezed.empty()) report.message = squeezed + "; " + report.message;
    if (model.walls.empty()) return;
    const std::string beyond =
        describe_beyond_walls(exact().run(engine->positions()).beyond_walls);
    if (!beyond.empty()) report.message = beyond + "; " + report.message;
}

Status Simulator::Impl::choose_engine() {
    const EngineInput input{model, pattern, settings, scene.gravity, options.threads};
    const bool wants_gpu = options.device == Device::Cuda
                        || (options.device == Device::Auto && kAutoTakesGpu);
    if (wants_gpu) {
        auto made = device_engine_maker()(input);
        if (made) engine = std::move(made.value());
        if (!made && options.device == Device::Cuda) {
            Error error = made.error();
            error.message += "; use --device cpu, or run where a usable GPU is";
            return error;
        }
        if (!made) resolved.device_note = made.error().message;
    } else if (options.device == Device::Auto) {
        const Result<CudaDevice> found = find_cuda_device();
        resolved.device_note =
            found ? found.value().name
                        + " could be used, but the CUDA engine has not been checked on a "
                          "GPU yet; --device cuda selects it"
                  : found.error().message;
    }
    if (!engine) engine = make_cpu_engine(input);
    return Done{};
}

void Simulator::Impl::copy_topology() {
    tets.resize(model.tets.size());
    for (std::size_t k = 0; k < model.tets.size(); ++k)
        std::copy_n(model.tets[k].v,
                    4,
                    tets[static_cast<std::size_t>(model.tet_source[k])].begin());
    for (const Int3& t : model.triangles)
        triangles.push_back({t[0], t[1], t[2]});
    for (const Int2& s : model.segments)
        segments.push_back({s[0], s[1]});
}

void Simulator::Impl::resolve() {
    resolved.diagonal = model.diagonal;
    resolved.dhat = model.dhat;
    resolved.epsv = model.epsv;
    resolved.tolerance = model.tolerance(scene.solver, 0);
    resolved.device = engine->device_name();
    resolved.on_gpu = engine->is_on_device();
    const bool by_warps = scene.solver.contact_product == ContactProduct::Warp
                       && scene.solver.linear != LinearSolver::Cholmod;
    const LinearSolver linear =
        by_warps && !resolved.on_gpu ? LinearSolver::BlockJacobi : scene.solver.linear;
    resolved.linear_solver =
        describe_linear_solver(model, linear, scene.dt, resolved.on_gpu);
    if (by_warps)
        resolved.linear_solver += "; contacts as dense blocks, multiplied by warps";
    resolved.estimated_mb = estimate_megabytes(model);
    resolved.total_mass = model.total_mass;
    resolved.num_vertices = model.num_vertices;
    resolved.num_tets = model.num_tets();
    resolved.num_triangles = static_cast<int>(model.triangles.size());
    resolved.num_bodies = model.num_bodies();
}

Status Simulator::Impl::start() {
    if (scene.solver.linear == LinearSolver::Cholmod && !CholmodSolver::available())
        return Error{Error::Code::Unsupported,
                     "solver.linear",
                     "this build has no CHOLMOD; install SuiteSparse and build with "
                     "NOLI_CHOLMOD=ON, or use \"pcg\""};
    pattern = build_block_pattern(model.num_vertices, model.tets);
    settings = step_settings(scene, model, options.record_iterations);
    Status chosen = choose_engine();
    if (!chosen) return chosen.error();
    copy_topology();
    resolve();
    return Done{};
}

Simulator::Simulator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;
Simulator::~Simulator() = default;

Result<Simulator> Simulator::create(const Scene& scene, const SimulatorOptions& options) {
    std::vector<SceneWarning> warnings;
    Result<Model> model = build_model(scene, &warnings);
    if (!model) return model.error();
    auto impl = std::make_unique<Impl>();
    impl->resolved.warnings = std::move(warnings);
    impl->scene = scene;
    impl->options = options;
    impl->model = std::move(model.value());
    Status started = impl->start();
    if (!started) return started.error();
    return Simulator(std::move(impl));
}

namespace {

/// For debug builds: whether a step that converged has left no net force but what its
/// tests for the end allow. Of settings that say so exactly.
[[maybe_unused]] bool is_balanced(Simulator& simulator,
                                  const Scene& scene,
                                  const StepReport& report) {
    const ContactSettings& contact = scene.contact;
    const SolverSettings& solver = scene.solver;
    if (report.outcome != Outcome::Converged || !report.message.empty()
        || solver.gap_tolerance <= 0.0 || solver.gradient_tolerance > 0.0
        || !solver.tolerance_per_step.empty()
        || contact.friction_iterations != kFrictionAsNeeded)
        return true;
    const double share =
        solver.gap_tolerance + contact.friction_tolerance + report.lag_change;
    return unbalanced(simulator.topology(),
                      simulator.net_forces(),
                      simulator.fields().contact_force,
                      simulator.resolved().tolerance * scene.dt,
                      scene.dt,
                      share)
        <= 1.0;
}

}  // namespace

StepReport Simulator::step(const std::atomic<bool>* stop) {
    const auto start = std::chrono::steady_clock::now();
    StepReport report = impl_->engine->step(stop);
    impl_->explain(report);
    NOLI_DCHECK(is_balanced(*this, impl_->scene, report));
    if (impl_->options.verify && report.outcome != Outcome::Cancelled) {
        const VerifyReport exact = verify();
        for (const NetForce& net : net_forces()) {
            report.net_force = std::max(report.net_force, norm(to_vec3(net.force)));
            report.net_torque = std::max(report.net_torque, norm(to_vec3(net.torque)));
        }
        report.intersections = exact.num_intersections;
        report.inversions = exact.num_inversions;
        if (exact.num_intersections + exact.num_inversions > 0
            && report.outcome == Outcome::Converged) {
            report.outcome = Outcome::Intersecting;
            report.message = "the exact test found "
                           + std::to_string(exact.num_intersections)
                           + " intersections and " + std::to_string(exact.num_inversions)
                           + " inverted tetrahedra after this step";
        }
    }
    report.wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report.peak_mb = peak_megabytes();
    return report;
}

int Simulator::steps_done() const {
    return impl_->engine->steps();
}
double Simulator::time() const {
    return steps_done() * impl_->scene.dt;
}
const Resolved& Simulator::resolved() const {
    return impl_->resolved;
}

Topology Simulator::topology() const {
    return {impl_->tets,
            impl_->triangles,
            impl_->segments,
            impl_->model.body,
            impl_->model.body_names,
            impl_->model.mass,
            impl_->model.unreferenced};
}

std::vector<Vector3> Simulator::positions() const {
    std::vector<Vector3> out = to_arrays(impl_->engine->positions());
    const Vec3d& origin = impl_->model.origin;
    if (max_abs(origin) == 0.0) return out;  // 0 + -0 would not be -0
    for (Vector3& p : out)
        p = {p[0] + origin.x, p[1] + origin.y, p[2] + origin.z};
    return out;
}
std::vector<Vector3> Simulator::velocities() const {
    return to_arrays(impl_->engine->velocities());
}

Fields Simulator::fields() {
    Fields out;
    out.contact_force = to_arrays(impl_->engine->contact_forces());
    tet_stresses(impl_->model, impl_->engine->positions(), out.stress, out.von_mises);
    return out;
}

VerifyReport Simulator::verify() const {
    return impl_->exact().run(impl_->engine->positions());
}

std::vector<Finding> Simulator::findings() const {
    return check_start(impl_->scene, impl_->model, impl_->exact());
}

std::uint64_t Simulator::state_hash() const {
    return hash_bytes(std::span<const std::byte>(save()));
}
std::vector<std::byte> Simulator::save() const {
    return encode_state(impl_->engine->state());
}

Status Simulator::restore(std::span<const std::byte> bytes) {
    Result<StepState> state =
        decode_state(bytes,
                     impl_->model.num_vertices,
                     static_cast<int>(impl_->model.conditions.size()));
    if (!state) return state.error();
    impl_->engine->set_state(state.value());
    return Done{};
}

std::vector<NetForce> Simulator::net_forces() {
    return noli::net_forces(
        impl_->model, impl_->engine->positions(), impl_->engine->residual());
}

Simulator::Balance Simulator::balance() {
    const StepState state = impl_->engine->state();
    const Vector3& g = impl_->scene.gravity;
    Balance out;
    Vec3d linear{0, 0, 0};
    Vec3d angular{0, 0, 0};
    for (std::size_t v = 0; v < state.x.size(); ++v) {
        const double m = impl_->model.mass[v];
        out.kinetic += 0.5 * m * norm_sq(state.v[v]);
        const Vec3d at = in_world(impl_->model, state.x[v]);
        out.gravitational -= m * dot(Vec3d{g[0], g[1], g[2]}, at);
        linear += m * state.v[v];
        angular += m * cross(at, state.v[v]);
    }
    out.elastic = impl_->engine->elastic_energy();
    out.contact = impl_->engine->barrier_energy();
    out.linear = to_array(linear);
    out.angular = to_array(angular);
    return out;
}

}  // namespace noli
