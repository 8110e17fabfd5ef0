// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Running a scene: step by step (Simulator), or as a whole into a run directory
/// (run_scene).

#include "noli/result.hpp"
#include "noli/scene.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace noli {

/// Version of the library and the program.
inline constexpr const char* kVersion = "0.1.0";

enum class Device { Auto, Cpu, Cuda };

struct SimulatorOptions {
    Device device = Device::Auto;
    int threads = 0;  ///< 0 = all cores
    bool verify =
        false;  ///< exact intersection and inversion test after every accepted step
    bool record_iterations = false;  ///< keep an IterationRecord per Newton iteration
};

/// How a time step ended.
enum class Outcome {
    Converged,
    MaxIterations,  ///< the Newton iteration cap
    Stalled,  ///< steps too short to make progress, with every contact Hessian tried
    LinearSolverFailed,  ///< PCG broke down or hit its cap, or a factorisation failed
    NumericalTrouble,    ///< NaN or infinity
    BoundaryBlocked,     ///< a prescribed motion runs into something that cannot give way
    Intersecting,        ///< --verify found an intersection or an inversion (a bug)
    DeviceFailed,        ///< the GPU ran out of memory or no longer answers
    Cancelled,           ///< stopped on request; the state is that of before the step
};
const char* to_string(Outcome outcome);

/// One Newton iteration.
struct IterationRecord {
    int iteration = 0;
    double energy = 0.0;        ///< incremental potential before the update, J times h^2
    double energy_after = 0.0;  ///< and after it, with the same kappa
    double direction = 0.0;     ///< max |p|, m
    double gradient = 0.0;      ///< max |g| over free vertices
    double step_bound = 1.0;    ///< largest collision- and inversion-free step
    double step = 1.0;          ///< accepted step length alpha
    int halvings = 0;           ///< of the line search
    int pcg = 0;                ///< iterations of the linear solver
    int contacts = 0;           ///< active pairs
    double min_gap = 0.0;       ///< m
    double kappa = 0.0;
    std::string limiting;  ///< what bounds the step: "pair EE 12 13 | 40 41", "tet 7",
                           ///< "boundary", ""
    bool noise_accepted = false;  ///< energies differ by less than their rounding error
    bool boundary_moved =
        false;  ///< a prescribed motion advanced, so the energy may rise
};

/// What one time step did.
struct StepReport {
    int step = 0;       ///< 1 for the first step
    double time = 0.0;  ///< s, at the end of the step
    Outcome outcome = Outcome::Converged;
    std::string message;  ///< empty, or the likeliest cause with numbers and ids
    int newton = 0;       ///< linear systems solved
    int pcg = 0;          ///< linear iterations, summed
    int friction_updates = 0;
    int contacts = 0;      ///< active pairs at the end
    double min_gap = 0.0;  ///< m; +infinity if nothing is near
    double kappa = 0.0;    ///< J/m^4
    double boundary_yield =
        0.0;  ///< m that blocked prescribed vertices stayed short of their targets
    /// How far the end of the step was from its tolerances: max|p| over tolerance * dt,
    /// relative change of a gap, relative change of a body's friction force.
    double direction_ratio = 0.0, gap_change = 0.0, lag_change = 0.0;
    /// With SimulatorOptions::verify: the largest of Simulator::net_forces, N and N m; -1
    /// = not looked at.
    double net_force = -1.0, net_torque = -1.0;
    int intersections = -1;  ///< exact test; -1 = not tested
    int inversions = -1;
    double wall_s = 0.0;
    double t_pairs = 0, t_assemble = 0, t_solve = 0, t_ccd = 0, t_search = 0,
           t_output = 0;  ///< s
    /// Parts of t_assemble: gradients and projected Hessians of these energies, s.
    double t_elastic = 0, t_barrier = 0, t_friction = 0;
    double peak_mb = 0.0;
    int threads = 0;  ///< that its loops ran on: one where that is faster; 0 on a GPU
    std::vector<IterationRecord> iterations;
};

/// Read-only picture of the simulated bodies. Arrays live as long as the Simulator.
struct Topology {
    std::span<const std::array<int, 4>> tets;
    std::span<const std::array<int, 3>> triangles;  ///< surfaces and obstacles
    std::span<const std::array<int, 2>> segments;   ///< of codimensional obstacles
    std::span<const int> body_of_vertex;
    std::span<const std::string> body_names;
    std::span<const double> mass;       ///< lumped, per vertex, kg; 0 for obstacles
    std::span<const int> unreferenced;  ///< vertices without an element, ascending
};

/// Fields of the current state, in the order of the vertices of all bodies (mesh-file
/// order).
struct Fields {
    std::vector<Vector3> contact_force;         ///< per vertex, N
    std::vector<double> von_mises;              ///< per tet, Pa
    std::vector<std::array<double, 9>> stress;  ///< per tet, Cauchy, row-major, Pa
};

/// What a step has left unbalanced on a body: N, and N m about its centre of mass.
struct NetForce {
    Vector3 force{}, torque{};
};

struct ExactIntersection {
    std::array<int, 2> edge;
    std::array<int, 3> triangle;
    Vector3 place;
    std::string body_a, body_b;
};

/// Vertices of one body that are where one half-space or container forbids them to be.
struct BeyondWall {
    std::string body;
    std::string wall;           ///< "half-space "floor"" or "container "drum""
    std::vector<int> vertices;  ///< ascending
    int deepest;                ///< the vertex that is deepest
    double depth;               ///< m, >= 0
    Vector3 place;              ///< where the deepest is
    std::string message;        ///< all of this in words, with a cure
};

struct VerifyReport {
    /// Edge through triangle, or a vertex (given twice) on one; at most 1000 listed.
    std::vector<ExactIntersection> intersections;
    std::vector<BeyondWall> beyond_walls;
    /// With contact.min_separation: two things that are no farther apart, in words.
    std::string too_close;
    int num_intersections = 0;  ///< of all three kinds: a vertex counts once per wall
    std::vector<int> inverted_tets;
    int num_inversions = 0;
};

/// Settings as they came out, in absolute units.
struct Resolved {
    double diagonal = 0.0;   ///< m
    double dhat = 0.0;       ///< m
    double epsv = 0.0;       ///< m/s
    double tolerance = 0.0;  ///< m/s
    std::string device;      ///< "CPU, 2 threads, AVX-512" or the GPU's name
    bool on_gpu = false;
    std::string device_note;             ///< why that device, when "auto"
    std::string linear_solver;           ///< and why that one
    std::vector<SceneWarning> warnings;  ///< of the meshes and the conditions
    double estimated_mb = 0.0;
    double total_mass = 0.0;
    int num_vertices = 0, num_tets = 0, num_triangles = 0, num_bodies = 0;
};

/// Something wrong, or probably not meant, before the first step.
struct Finding {
    enum class Severity { Error, Warning, Note };
    Severity severity = Severity::Note;
    std::string where;
    std::string message;
};

/// Owns the state of one simulation. Movable, not copyable.
class Simulator {
  public:
    /// Loads meshes, checks them, finds a device. Does not check for initial
    /// intersections.
    static Result<Simulator> create(const Scene& scene,
                                    const SimulatorOptions& options = {});
    Simulator(Simulator&&) noexcept;
    Simulator& operator=(Simulator&&) noexcept;
    ~Simulator();

    /// Advances by one time step. Never throws; a step that could not finish leaves the
    /// state at the last intersection-free iterate and says so in its outcome.
    ///
    /// `stop` may be set by another thread or a signal handler, and is looked at between
    /// Newton iterations and between those of conjugate gradients. Once it is set the
    /// step ends as Cancelled and the state is that of before it, bit for bit (`save`,
    /// `state_hash`, positions); the contact forces of `fields` are then those of that
    /// state without friction, until the next step. A step that is as good as done may
    /// still converge.
    StepReport step(const std::atomic<bool>* stop = nullptr);

    [[nodiscard]] int steps_done() const;
    [[nodiscard]] double time() const;
    [[nodiscard]] const Resolved& resolved() const;
    [[nodiscard]] Topology topology() const;
    [[nodiscard]] std::vector<Vector3> positions() const;   ///< m
    [[nodiscard]] std::vector<Vector3> velocities() const;  ///< m/s
    [[nodiscard]] Fields fields();

    /// Exact test of the current state for intersections and inverted tetrahedra.
    [[nodiscard]] VerifyReport verify() const;

    /// What `check_scene` finds in the scene as it starts, besides intersections,
    /// obstacles that overlap each other, and estimates: errors, then warnings, then
    /// notes. The start must be free of intersections.
    [[nodiscard]] std::vector<Finding> findings() const;

    /// Hash of the complete state (positions, velocities, stiffness, step); equal on
    /// equal states.
    [[nodiscard]] std::uint64_t state_hash() const;

    /// The complete state as bytes; `restore` continues bitwise as if never stopped.
    [[nodiscard]] std::vector<std::byte> save() const;
    Status restore(std::span<const std::byte> bytes);

    /// Per body, sums of the forces that the last step left unbalanced; 0 of obstacles
    /// and of bodies with prescribed vertices. Over mass and times dt they are an error
    /// of the velocity, at most about the tolerance.
    [[nodiscard]] std::vector<NetForce> net_forces();

    /// Kinetic, elastic and potential energy (J), momenta about the origin (kg m/s, kg
    /// m^2/s).
    struct Balance {
        double kinetic = 0, elastic = 0, gravitational = 0, contact = 0;
        Vector3 linear{}, angular{};
    };
    [[nodiscard]] Balance balance();

  private:
    struct Impl;
    explicit Simulator(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

struct RunOptions {
    std::string
        directory;   ///< created; must be empty or a run of the same scene with resume
    int steps = -1;  ///< -1 = all of the scene
    bool resume = false;
    bool overwrite = false;      ///< start anew in a directory that holds a run
    bool iteration_log = false;  ///< iterations.jsonl
    SimulatorOptions simulator;
    std::function<void(const Resolved&, int first_step, int last_step)> on_start;
    std::function<void(const StepReport&)> on_step;
    /// Warnings about the scene before its first step (none where a run is resumed); what
    /// would be an error for `check_scene` is one for run_scene.
    std::function<void(const std::vector<Finding>&)> on_warnings;
    /// Things worth saying that are not errors: damaged checkpoints skipped, where a
    /// resume starts.
    std::function<void(const std::string&)> on_note;
    const std::atomic<bool>* stop =
        nullptr;  ///< set it to give the step up, write a checkpoint and return
};

struct RunSummary {
    int steps_done = 0;  ///< in total, including those before a resume
    int steps_asked = 0;
    bool interrupted = false;
    Outcome outcome = Outcome::Converged;  ///< of the last step
    std::string message;
    std::string repro_folder;  ///< non-empty when a step failed: everything to repeat it
    double wall_s = 0.0;       ///< of this call
    double time = 0.0;         ///< s, simulated, in total
    std::uint64_t state_hash = 0;  ///< after steps_done; of a failed run 0 if not known
    /// The largest of the same figures of the steps of this call.
    double direction_ratio = 0.0, gap_change = 0.0, lag_change = 0.0;
};

/// Runs a scene into a directory (docs/frame-format.md): frames, stats.csv, checkpoints,
/// log.
Result<RunSummary> run_scene(const Scene& scene, const RunOptions& options);

/// Everything wrong before the first frame.
struct CheckReport {
    std::vector<Finding> findings;
    VerifyReport intersections;
    double min_gap = 0.0;  ///< m
    Resolved resolved;
    double estimated_step_s = 0.0;
    std::string
        marked_mesh;  ///< PLY with intersecting triangles in colour, when there are any
};
/// `mark_folder`: where the coloured mesh goes when there are intersections; empty =
/// nowhere.
Result<CheckReport> check_scene(const Scene& scene, const std::string& mark_folder = {});

/// A few lines about a mesh file, a scene file or a run directory.
Result<std::string> describe(const std::string& path);

/// Reads a mesh file and writes it in another format, both by extension. Fails if the
/// format cannot hold the mesh's elements.
Status convert_mesh(const std::string& from, const std::string& to);

}  // namespace noli
