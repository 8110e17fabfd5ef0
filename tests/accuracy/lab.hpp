// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A bench for one case: makes bodies of the case's size and material, runs the scene
/// with default settings and keeps what was expected and found. Public interface only.

#include "noli/simulator.hpp"

#include "case.hpp"
#include "discrete.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <optional>

namespace noli::accuracy {

/// One number and its answer.
struct Measured {
    std::string what;
    double expected = 0.0, found = 0.0;
    double scale = 0.0;    ///< errors are relative to it; > 0
    double own = 0.0;      ///< the model's own error, relative to the scale
    bool at_most = false;  ///< only an excess over `expected` is an error

    [[nodiscard]] double error() const {
        const double excess = (found - expected) / scale;
        return at_most ? std::max(0.0, excess) : std::abs(excess);
    }
};

/// Centre of mass and mean velocity of a body.
struct Motion {
    double mass = 0.0;
    Vector3 x{}, v{};
};

inline double norm(const Vector3& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// x turned by `angle` (rad) about z, then shifted.
inline Affine placed(const Vector3& at, double angle = 0.0) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    Affine out;
    out.rows = {{{c, -s, 0, at[0]}, {s, c, 0, at[1]}, {0, 0, 1, at[2]}}};
    return out;
}

inline HalfSpace plane(double friction, const Vector3& normal = {0, 1, 0}) {
    HalfSpace out;
    out.name = "plane";
    out.normal = normal;
    out.friction = friction;
    return out;
}

inline BoundaryCondition condition(BoundaryCondition::Kind kind,
                                   const Vector3& linear = {0, 0, 0}) {
    BoundaryCondition out;
    out.kind = kind;
    out.linear = linear;
    return out;
}

/// Everything between two corners in units of the mesh's box.
inline Selection part(const Vector3& low, const Vector3& high) {
    constexpr double kSlack = 1e-3;
    Selection out;
    out.kind = Selection::Kind::Box;
    for (std::size_t k = 0; k < 3; ++k) {
        out.box_min[k] = low[k] - kSlack;
        out.box_max[k] = high[k] + kSlack;
    }
    return out;
}

/// All tests that end Newton's method and the lag of friction, a hundred times tighter.
template <class Solver, class Contact>
void tighten(Solver& solver, Contact& contact) {
    solver.tolerance /= 100.0;
    if constexpr (requires { solver.gap_tolerance; }) solver.gap_tolerance /= 100.0;
    if constexpr (requires { contact.friction_tolerance; })
        contact.friction_tolerance /= 100.0;
}

class Lab {
  public:
    Lab(const Case& which, bool tight)
        : at(which), material(preset(which.preset)), tight_(tight) {}

    const Case at;
    Material material;
    std::vector<Measured> measured;
    std::string failed;  ///< why the run ended early, if it did
    int newton = 0, pcg = 0, steps = 0;
    double seconds = 0.0;  ///< of processor time

    [[nodiscard]] double size() const { return at.size; }
    [[nodiscard]] int cells() const { return kCells[static_cast<std::size_t>(at.mesh)]; }

    /// Settings of the case, no bodies.
    [[nodiscard]] Scene scene() const {
        Scene out;
        out.name = name_of(at);
        out.dt = at.dt;
        out.solver.integrator = at.integrator;
        if (tight_) tighten(out.solver, out.contact);
        return out;
    }

    [[nodiscard]] Body body(
        const std::string& name,
        const std::string& generator,
        std::vector<std::pair<std::string, std::vector<double>>> parameters,
        const Affine& place = {}) const {
        Body out;
        out.name = name;
        out.mesh.generator = generator;
        out.mesh.parameters = std::move(parameters);
        out.material = material;
        out.transform = place;
        return out;
    }

    /// A box with extents in sizes of the case, and cells likewise.
    [[nodiscard]] Body block(const std::string& name,
                             const Affine& place,
                             const Vector3& extents = {1, 1, 1}) const {
        std::vector<double> edges;
        std::vector<double> counts;
        for (const double extent : extents) {
            edges.push_back(extent * at.size);
            counts.push_back(std::max(1.0, std::round(extent * cells())));
        }
        return body(name, "box", {{"size", edges}, {"cells", counts}}, place);
    }

    /// A ball of the case's size as diameter.
    [[nodiscard]] Body ball(const std::string& name, const Affine& place) const {
        constexpr std::array<double, 4> kEdge{1.0, 0.5, 0.3, 0.13};  // of the radius
        const double radius = 0.5 * at.size;
        const double edge = kEdge[static_cast<std::size_t>(at.mesh)] * radius;
        return body(
            name, "sphere", {{"radius", {radius}}, {"edge_length", {edge}}}, place);
    }

    /// False if the scene cannot start; then nothing else happens.
    bool start(const Scene& scene) {
        SimulatorOptions options;
        const char* device = std::getenv("NOLI_TEST_DEVICE");
        options.device = device != nullptr && std::string(device) == "cuda" ? Device::Cuda
                                                                            : Device::Cpu;
        options.threads = 1;
        options.verify = true;
        Result<Simulator> made = Simulator::create(scene, options);
        if (!made) {
            failed = made.error().where + ": " + made.error().message;
            return false;
        }
        simulator_.emplace(std::move(made.value()));
        started_ = scene;
        return true;
    }

    /// Runs `count` steps, calling `each` after every one; false if one of them failed.
    bool run(int count, const std::function<void(const StepReport&)>& each = {}) {
        for (int k = 0; k < count && failed.empty(); ++k) {
            const std::clock_t begin = std::clock();
            const StepReport report = simulator_->step();
            seconds += double(std::clock() - begin) / CLOCKS_PER_SEC;
            newton += report.newton;
            pcg += report.pcg;
            ++steps;
            if (report.outcome != Outcome::Converged)
                failed = "step " + std::to_string(report.step) + ": "
                       + to_string(report.outcome) + ": " + report.message;
            else if (each)
                each(report);
        }
        return failed.empty();
    }

    /// Gap at which a body of mass m that n vertices carry starts at rest: half of dhat,
    /// or more where the barrier at its least stiffness pushes harder than m g there. A
    /// body that starts deeper is thrown up by the barrier, about dhat a step.
    [[nodiscard]] double resting_gap(double mass, double n, double g = kGravity) const {
        const Resolved& r = simulator_->resolved();
        const auto all = simulator_->topology().mass;
        const auto with_mass =
            std::count_if(all.begin(), all.end(), [](double m) { return m > 0.0; });
        const double mean_mass = r.total_mass / static_cast<double>(with_mass);
        const double kappa = least_stiffness(mean_mass, r.diagonal, r.dhat);
        const auto excess = [&](double gap) {
            return mass * g * at.dt * at.dt + n * kappa * barrier_slope(gap, r.dhat);
        };
        return root_of_rising(excess, 0.5 * r.dhat, r.dhat);
    }
    /// Vertices of one face of a cube.
    [[nodiscard]] double vertices_of_face() const {
        return (cells() + 1) * (cells() + 1);
    }

    [[nodiscard]] Simulator& simulator() { return *simulator_; }
    [[nodiscard]] const Scene& started() const { return started_; }

    /// Vertices of a body, counted from all of the scene.
    [[nodiscard]] std::vector<std::size_t> vertices(int body) const {
        const auto owner = simulator_->topology().body_of_vertex;
        std::vector<std::size_t> out;
        for (std::size_t v = 0; v < owner.size(); ++v)
            if (owner[v] == body) out.push_back(v);
        return out;
    }

    [[nodiscard]] Motion motion(int body = 0) const {
        const auto mass = simulator_->topology().mass;
        const std::vector<Vector3> x = simulator_->positions();
        const std::vector<Vector3> v = simulator_->velocities();
        Motion out;
        for (const std::size_t i : vertices(body)) {
            out.mass += mass[i];
            for (std::size_t k = 0; k < 3; ++k) {
                out.x[k] += mass[i] * x[i][k];
                out.v[k] += mass[i] * v[i][k];
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            out.x[k] /= out.mass;
            out.v[k] /= out.mass;
        }
        return out;
    }

    /// Contact force on a body, or on some of its vertices, N.
    [[nodiscard]] Vector3 force(const std::vector<std::size_t>& on) {
        const Fields fields = simulator_->fields();
        Vector3 sum{};
        for (const std::size_t i : on)
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += fields.contact_force[i][k];
        return sum;
    }

    [[nodiscard]] double energy() {
        const Simulator::Balance b = simulator_->balance();
        return b.kinetic + b.elastic + b.gravitational + b.contact;
    }

    /// found should be expected, within 1 % of the scale beyond the model's own error.
    void expect(const std::string& what,
                double expected,
                double found,
                double scale = 0.0,
                double own = 0.0) {
        measured.push_back(
            {what, expected, found, scale > 0.0 ? scale : std::abs(expected), own});
    }

    void expect_vector(const std::string& what,
                       const Vector3& expected,
                       const Vector3& found,
                       double scale,
                       double own = 0.0) {
        Vector3 off{};
        for (std::size_t k = 0; k < 3; ++k)
            off[k] = found[k] - expected[k];
        measured.push_back(
            {what, norm(expected), norm(expected) + norm(off), scale, own});
    }

    void expect_at_most(const std::string& what,
                        double bound,
                        double found,
                        double scale,
                        double own = 0.0) {
        measured.push_back({what, bound, found, scale, own, true});
    }

  private:
    bool tight_;
    std::optional<Simulator> simulator_;
    Scene started_;
};

}  // namespace noli::accuracy
