// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A scene: everything that a simulation starts from, as plain data. All quantities are
/// SI (metres, kilograms, seconds, pascals); angles are in degrees and say so in their
/// names. docs/scene-format.md describes the JSON form of each field.

#include "noli/result.hpp"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace noli {

using Vector3 = std::array<double, 3>;

inline constexpr double kForever = std::numeric_limits<double>::infinity();

/// x -> A x + b; rows of the 3x4 matrix [A | b].
struct Affine {
    std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

/// The elastic energy of a tetrahedral body and its constants.
struct Material {
    enum class Model { StableNeoHookean, NeoHookean, FixedCorotated };
    Model model = Model::NeoHookean;  ///< its log term keeps elements from inverting
    double density = 1000.0;          ///< kg/m^3, > 0
    double young = 1e5;               ///< Young's modulus, Pa, > 0
    double poisson = 0.4;             ///< Poisson's ratio, in (-1, 0.5)
    bool gipc_lame =
        false;  ///< StableNeoHookean only: the Lame mapping of the authors' program
};

/// Where a body's mesh comes from: a file, or a generator with named numeric parameters.
struct MeshSource {
    std::string file;  ///< path; empty when generated
    std::string
        generator;  ///< "box", "sphere", "torus", ...; empty when read from a file
    std::vector<std::pair<std::string, std::vector<double>>>
        parameters;  ///< of the generator
    bool fix_orientation =
        false;  ///< flip inverted tetrahedra on load instead of refusing
};

/// Which vertices of a body a boundary condition holds.
struct Selection {
    enum class Kind { All, Box, Vertices };
    enum class Frame {
        MeshBox,  ///< box in units of the untransformed mesh's bounding box, 0..1 per
                  ///< axis
        World     ///< box in metres, in the initial placement
    };
    Kind kind = Kind::All;
    Frame frame = Frame::MeshBox;
    Vector3 box_min{0, 0, 0};   ///< inclusive
    Vector3 box_max{1, 1, 1};   ///< inclusive
    std::vector<int> vertices;  ///< zero-based, in the order of the mesh file
    bool surface_only = false;  ///< of a box: only vertices of the surface
};

/// A key frame of a prescribed path, relative to the placement at the start of the scene.
struct PathKey {
    double time = 0.0;       ///< s, ascending
    Vector3 translation{};   ///< m
    Vector3 rotation_deg{};  ///< about the centre of the selection, Rx Ry Rz
};

/// All three of the bits 1 x, 2 y, 4 z.
inline constexpr int kAllAxes = 7;

/// A condition on some vertices of one body, active while t_begin <= step start time <
/// t_end.
struct BoundaryCondition {
    enum class Kind {
        Fixed,     ///< held where it is
        Velocity,  ///< moves with `linear` and turns with `angular_deg`
        Path,      ///< follows `path`, linear between key frames, held after the last
        Sequence,  ///< positions of step k from `sequence[k]` (a mesh file each), then
                   ///< held
        Force,     ///< total force `linear` in newtons, spread by mass
        Acceleration,  ///< acceleration `linear` in m/s^2
    };
    Kind kind = Kind::Fixed;
    Selection selection;
    Vector3 linear{};       ///< m/s, N or m/s^2 by kind
    Vector3 angular_deg{};  ///< deg/s; per step R = Rx(wx dt) Ry(wy dt) Rz(wz dt)
    std::optional<Vector3>
        center;  ///< of rotation; default: current bounding-box centre of the selection
    std::vector<PathKey> path;
    std::vector<std::string> sequence;  ///< files, one per step
    double t_begin = 0.0;               ///< s
    double t_end = kForever;            ///< s
    /// Which coordinates are prescribed, as bits; the others are free. Not of loads.
    int axes = kAllAxes;

    /// Ends the condition for good at the first step that starts with every vertex of
    /// `body` (or of the selection) beyond `value` along `axis`.
    struct Until {
        enum class Subject { Body, Selection };
        Subject subject = Subject::Body;
        int axis = 0;            ///< 0 x, 1 y, 2 z
        bool above = true;       ///< beyond means >= value; else <= value
        double value = 0.0;      ///< m
        bool then_hold = false;  ///< afterwards fixed where it is; else released
    };
    std::optional<Until> until;
};

/// A body or, with `grid`, several copies of it. A mesh with tetrahedra is elastic; a
/// mesh of triangles, segments or points alone is an obstacle that only boundary
/// conditions move.
struct Body {
    std::string name;
    MeshSource mesh;
    Affine transform;
    Material material;
    Vector3 velocity{};              ///< initial, m/s
    Vector3 angular_velocity_deg{};  ///< initial, deg/s about the bounding-box centre
    double friction = 0.0;  ///< default coefficient of contacts of this body, >= 0
    std::vector<BoundaryCondition> boundary;
    std::array<int, 3> grid{1, 1, 1};  ///< copies along x, y, z
    Vector3 grid_spacing{};  ///< m; copy (i,j,k) is shifted by (i sx, j sy, k sz)
};

/// Solid region n.x < n.o is forbidden.
struct HalfSpace {
    std::string name;
    Vector3 point{};
    Vector3 normal{0, 1, 0};  ///< need not be unit
    double friction = 0.0;
};

/// The inside of a sphere or of an infinite cylinder: what is outside is forbidden.
struct Container {
    enum class Shape { Sphere, Cylinder };

    std::string name;
    Shape shape = Shape::Sphere;
    Vector3 center{};       ///< m; Cylinder: any point of the axis
    double radius = 1.0;    ///< m, > 0
    Vector3 axis{0, 1, 0};  ///< Cylinder: its direction; need not be unit
    double friction = 0.0;
};

/// Overrides for one pair of bodies (or a body and a half-space or container), by name;
/// "*" matches all.
struct ContactPairRule {
    std::string a, b;
    std::optional<double> friction;
    std::optional<bool> enabled;
};

/// Whose contact model: the barrier, its Hessian and its projection as one choice.
enum class ContactFormulation { Gipc, Ipc };
enum class ContactModel { Gn, GnPlus, Exact, Numeric };
enum class MollifierModel { TwoMode, FourMode, Exact };
/// PrimalDual keeps friction that turns about from halving the steps of Newton's method.
enum class FrictionHessian { PrimalDual, Newton };
enum class Integrator { ImplicitEuler, Bdf2, Newmark };
enum class LinearSolver { Pcg, Cholmod, BlockJacobi, IncompleteCholesky };
enum class ContactProduct { Modes, Warp };
/// Of elastic Hessians: element by element where the exact one is not positive definite,
/// or always.
enum class HessianProjection { OnDemand, Always };
/// Where Newton's method starts: where the last two steps lead, or where the bodies are.
enum class NewtonStart { Extrapolated, Last };

/// ContactSettings::friction_iterations: as often as the forces ask for, four times at
/// most.
inline constexpr int kFrictionAsNeeded = -1;

struct ContactSettings {
    bool enabled = true;
    bool self_contact = true;  ///< contact within one body
    double dhat =
        1e-3;  ///< activation distance; relative to the scene's diagonal unless absolute
    bool dhat_absolute = false;
    /// Ipc is [Li2020]: exponent 1, full Hessians projected numerically; the next three
    /// are then not read.
    ContactFormulation model = ContactFormulation::Gipc;
    int barrier_exponent = 2;  ///< r of docs/theory/barrier.md: 1 or 2
    ContactModel hessian = ContactModel::GnPlus;
    MollifierModel mollifier = MollifierModel::FourMode;
    double kappa = 0.0;  ///< fixed stiffness, J/m^4; 0 = adaptive
    double kappa_min_multiplier = 1e11;
    double epsv = 1e-3;  ///< static friction speed; relative to the diagonal per second
                         ///< unless absolute
    bool epsv_absolute = false;
    /// Lag updates per step; 0 = until convergence, kFrictionAsNeeded = again while a
    /// body's friction force changes by more than `friction_tolerance`.
    int friction_iterations = kFrictionAsNeeded;
    FrictionHessian friction_hessian = FrictionHessian::PrimalDual;
    double friction_tolerance = 0.02;  ///< relative change of a body's friction force
    double min_separation = 0.0;       ///< m; barriers begin at dhat beyond it
    /// After several short steps move the solve to a stronger contact Hessian.
    bool strengthen = true;
    std::vector<ContactPairRule> pairs;
};

struct DampingSettings {
    double mass = 0.0;       ///< Rayleigh alpha, 1/s
    double stiffness = 0.0;  ///< viscosity (Rayleigh beta), s: damps no rotation
};

struct SolverSettings {
    Integrator integrator = Integrator::ImplicitEuler;
    double newmark_beta = 0.25;
    double newmark_gamma = 0.5;
    double tolerance =
        1e-3;  ///< Newton: stop at max|p| < tolerance * diagonal * dt (relative)
    /// And when no gap of an active pair would change by more than this share any more;
    /// 0 = do not ask.
    double gap_tolerance = 0.03;
    /// If > 0, Newton stops at max|g| <= gradient_tolerance * diagonal * dt^2 instead.
    double gradient_tolerance = 0.0;
    bool tolerance_absolute = false;  ///< then max|p| < tolerance * dt, tolerance in m/s
    std::vector<double>
        tolerance_per_step;  ///< overrides `tolerance` for step k; the last one repeats
    int max_newton = 1000;
    HessianProjection projection = HessianProjection::OnDemand;
    NewtonStart start = NewtonStart::Extrapolated;
    LinearSolver linear = LinearSolver::Pcg;
    /// How conjugate gradients apply contacts. Warp: as the supplement does.
    ContactProduct contact_product = ContactProduct::Modes;
    double pcg_tolerance =
        0.0;  ///< on r^T P^-1 r, relative (docs/theory/linear_operator.md); 0 = automatic
    int max_pcg = 20000;
};

struct OutputSettings {
    int every = 1;                            ///< frames: every N steps; 0 = none
    std::vector<std::string> formats{"vtu"};  ///< of "vtu", "obj", "ply"
    int checkpoint_steps = 0;          ///< checkpoint every N steps; 0 = by time only
    double checkpoint_seconds = 10.0;  ///< and at least every S seconds of wall time
    /// stats.csv: state hash every N steps; 0 = every step on a CPU, and on a GPU with
    /// frames, since all of the state has to come to the host for it.
    int hash_every = 0;
};

struct Scene {
    std::string name;
    std::string description;
    std::string base_folder;  ///< relative mesh paths start here
    double duration = 5.0;    ///< s
    double dt = 0.025;        ///< s
    Vector3 gravity{0, -9.80665, 0};
    double length_scale =
        0.0;  ///< m, the "diagonal" of relative settings; 0 = bounding-box diagonal of
              ///< all elastic bodies at the start
    std::vector<Body> bodies;
    std::vector<HalfSpace> half_spaces;
    std::vector<Container> containers;
    ContactSettings contact;
    DampingSettings damping;
    SolverSettings solver;
    OutputSettings output;

    /// ceil(duration / dt), robust to rounding.
    [[nodiscard]] int num_steps() const;
};

/// Things said about a scene that are not errors.
struct SceneWarning {
    std::string where;
    std::string message;
};

/// Reads native JSON (format version 1) or an IPC script (.txt), by extension.
/// Every error of a JSON scene carries a JSON pointer, what was found, what was expected,
/// a cure.
Result<Scene> read_scene(const std::string& path,
                         std::vector<SceneWarning>* warnings = nullptr);

/// The scene as native JSON text; reading it back gives the same scene, bit for bit.
std::string scene_to_json(const Scene& scene);

/// The words that a scene has for the values of a setting, in the order of its
/// documentation. E is Integrator, LinearSolver, ContactModel or MollifierModel.
template <class E>
std::vector<std::string> value_names();

/// The value that such a word stands for, if any.
template <class E>
std::optional<E> value_named(const std::string& name);

}  // namespace noli
