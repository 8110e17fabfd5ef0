// SPDX-License-Identifier: Apache-2.0
#include "noli/scene.hpp"

#include "mesh/source.hpp"
#include "scene/affine.hpp"
#include "unit/scene/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

using Kind = BoundaryCondition::Kind;

class IpcScript : public testing::Test {
  protected:
    IpcScript() {
        folder_.write("tet.mesh", test::kTetMesh);
        folder_.write("tri.obj", test::kTriangleObj);
        folder_.write("edge.seg", "v 0 0 0\nv 1 0 0\ns 1 2\n");
    }

    Scene read(const std::string& text) {
        warnings_.clear();
        const auto scene = read_scene(folder_.write("script.txt", text), &warnings_);
        EXPECT_TRUE(scene) << scene.error().where << ": " << scene.error().message << "\n"
                           << text;
        return scene ? scene.value() : Scene{};
    }

    Error refuse(const std::string& text) {
        const auto scene = read_scene(folder_.write("script.txt", text));
        EXPECT_FALSE(scene) << text;
        return scene ? Error{} : scene.error();
    }

    test::ScratchFolder folder_;
    std::vector<SceneWarning> warnings_;
};

Vec3d at(const Body& body, double x, double y, double z) {
    return apply_affine(body.transform, {x, y, z});
}

void expect_vec(const Vec3d& found, const Vec3d& expected, double tolerance = 1e-12) {
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(found[k], expected[k], tolerance) << "xyz"[k];
}

constexpr const char* kOneTet = "shapes input 1\ntet.mesh 0 0 0  0 0 0  1 1 1\n";

TEST_F(IpcScript, HasTheDefaultsOfTheLanguage) {
    const Scene s = read(kOneTet);
    EXPECT_EQ(s.duration, 5);
    EXPECT_EQ(s.dt, 0.025);
    EXPECT_EQ(s.gravity, (Vector3{0, -9.80665, 0}));
    ASSERT_EQ(s.bodies.size(), 1u);
    EXPECT_EQ(s.bodies[0].name, "tet");
    EXPECT_EQ(s.bodies[0].material.model, Material::Model::NeoHookean);
    EXPECT_EQ(s.bodies[0].material.young, 1e5);
    EXPECT_EQ(s.bodies[0].material.poisson, 0.4);
    EXPECT_EQ(s.bodies[0].material.density, 1000);
    EXPECT_TRUE(s.contact.enabled && s.contact.self_contact);
    EXPECT_EQ(s.contact.dhat, 1e-3);
    EXPECT_EQ(s.contact.epsv, 1e-3);
    EXPECT_EQ(s.contact.friction_iterations, kFrictionAsNeeded);
    EXPECT_EQ(s.solver.tolerance, SolverSettings{}.tolerance);
    EXPECT_FALSE(s.solver.tolerance_absolute);
    EXPECT_EQ(s.solver.integrator, Integrator::ImplicitEuler);
    EXPECT_DOUBLE_EQ(s.length_scale, std::sqrt(3.0));
    EXPECT_EQ(s.base_folder, folder_.path());
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(IpcScript, ReadsSettings) {
    const Scene s = read(std::string(kOneTet) + R"(energy FCR   # a comment
timeIntegration NM 0.3 0.6
time 2 0.01
density 500
stiffness 2e4 0.3
turnOffGravity
dampingRatio 0.1
selfFric 0.2
dHat 2e-3
epsv 1e-4
fricIterAmt -1
tol 3
1e-2 1e-3
1e-4
kappaMinMultiplier 1e10
useAbsParameters
ground 0.4 -1
halfSpace 0 1 0  1 2 0  50 0.3
warmStart 2
frobnicate 1
)");
    EXPECT_EQ(s.bodies[0].material.model, Material::Model::FixedCorotated);
    EXPECT_EQ(s.bodies[0].material.density, 500);
    EXPECT_EQ(s.bodies[0].material.young, 2e4);
    EXPECT_EQ(s.bodies[0].friction, 0.2);
    EXPECT_EQ(s.solver.integrator, Integrator::Newmark);
    EXPECT_EQ(s.solver.newmark_beta, 0.3);
    EXPECT_EQ(s.num_steps(), 200);
    EXPECT_EQ(s.gravity, Vector3{});
    EXPECT_DOUBLE_EQ(s.damping.stiffness, 0.75 * 0.1 * 0.01);
    EXPECT_EQ(s.contact.dhat, 2e-3);
    EXPECT_TRUE(s.contact.dhat_absolute && s.contact.epsv_absolute
                && s.solver.tolerance_absolute);
    EXPECT_EQ(s.contact.friction_iterations, 0);
    EXPECT_EQ(s.solver.tolerance_per_step, (std::vector<double>{1e-2, 1e-3, 1e-4}));
    EXPECT_EQ(s.contact.kappa_min_multiplier, 1e10);
    ASSERT_EQ(s.half_spaces.size(), 2u);
    EXPECT_EQ(s.half_spaces[0].point, (Vector3{0, -1, 0}));
    EXPECT_EQ(s.half_spaces[0].friction, 0.4);
    EXPECT_EQ(s.half_spaces[1].normal, (Vector3{1, 2, 0}));
    EXPECT_NE(s.half_spaces[0].name, s.half_spaces[1].name);
    ASSERT_EQ(warnings_.size(),
              2u);  // the unknown keyword, and one line for all that is ignored
    EXPECT_NE(warnings_[0].message.find("\"frobnicate\""), std::string::npos);
    EXPECT_NE(warnings_[1].message.find("warmStart"), std::string::npos);
}

TEST_F(IpcScript, PlacesShapesByScaleThenZThenYThenX) {
    const Scene s = read("shapes input 1\ntet.mesh 5 6 7  90 0 90  1 2 3\n");
    // x: scaled by 1, about z to +y, about x to +z.   y: by 2, to -x.   z: by 3, about x
    // to -y.
    expect_vec(at(s.bodies[0], 1, 0, 0), {5, 6, 8});
    expect_vec(at(s.bodies[0], 0, 1, 0), {3, 6, 7});
    expect_vec(at(s.bodies[0], 0, 0, 1), {5, 3, 7});
}

TEST_F(IpcScript, ScalesAllShapesTogetherAndMovesThemToTheOrigin) {
    const Scene s = read(
        "size 2\nshapes input 2\ntet.mesh 1 1 1  0 0 0  1 1 1\ntri.obj 4 1 1  0 0 0  1 1 "
        "1\n"
        "meshCO tri.obj 9 9 9  3  50 0\n");
    // Together they reach from 1 to 5 along x: the factor is 1/2.
    expect_vec(at(s.bodies[0], 0, 0, 0), {0, 0, 0});
    expect_vec(at(s.bodies[0], 1, 0, 0), {0.5, 0, 0});
    expect_vec(at(s.bodies[1], 1, 0, 0), {2, 0, 0});
    EXPECT_DOUBLE_EQ(s.length_scale, 0.5 * std::sqrt(3.0));  // of the tetrahedra alone
    // meshCO: centred at its vertex mean (1/3, 0, 1/3), extent 3, untouched by size.
    expect_vec(at(s.bodies[2], 0, 0, 0), {8, 9, 8});
    expect_vec(at(s.bodies[2], 1, 0, 0), {11, 9, 8});
}

TEST_F(IpcScript, TurnsTheModelButTakesTheScaleAtRest) {
    const Scene s = read(
        "size 1\nrotateModel 0 0 1 90\nshapes input 1\ntet.mesh 0 0 0  0 0 0  4 1 1\n");
    expect_vec(at(s.bodies[0], 1, 0, 0),
               {0.25, 1, 0});  // 4 long along y now, scaled to 1
    expect_vec(at(s.bodies[0], 0, 1, 0), {0, 0, 0});
    EXPECT_DOUBLE_EQ(s.length_scale, 0.25 * std::sqrt(18.0));
}

TEST_F(IpcScript, LiftsWithFallByHalfTheDiagonal) {
    const double half = 0.5 * std::sqrt(3.0);
    expect_vec(at(read(std::string(kOneTet) + "script fall\n").bodies[0], 0, 0, 0),
               {0, half, 0});
    expect_vec(at(read(std::string(kOneTet) + "script fallNoShift\n").bodies[0], 0, 0, 0),
               {0, 0, 0});
}

TEST_F(IpcScript, ReadsConditionsOfShapes) {
    const Scene s = read(R"(shapes input 1
# a comment line
tet.mesh 0 0 0  0 0 0  1 1 1 material 3000 1e8 0.3 initVel 1 2 3 0 90 0 \
   DBC -0.1 -0.1 -0.1 0.1 1.1 1.1  0 0 0  # its angular velocity and window follow \
   0 0 0  1 2  # the end
NBCTimeRange 0.5 9
)");
    const Body& b = s.bodies[0];
    EXPECT_EQ(b.material.density, 3000);
    EXPECT_EQ(b.material.young, 1e8);
    EXPECT_EQ(b.velocity, (Vector3{1, 2, 3}));
    EXPECT_EQ(b.angular_velocity_deg, (Vector3{0, 90, 0}));
    ASSERT_EQ(b.boundary.size(), 1u);
    EXPECT_EQ(b.boundary[0].kind, Kind::Fixed);
    EXPECT_EQ(b.boundary[0].selection.kind, Selection::Kind::Box);
    EXPECT_EQ(b.boundary[0].selection.frame, Selection::Frame::MeshBox);
    EXPECT_TRUE(b.boundary[0].selection.surface_only);
    EXPECT_EQ(b.boundary[0].t_begin, 1);
    EXPECT_EQ(b.boundary[0].t_end, 2);
}

TEST_F(IpcScript, CutsConditionsToTheGlobalRange) {
    const Scene s =
        read(std::string("DBCTimeRange 1 3\nNBCTimeRange 2 4\nshapes input 1\ntet.mesh 0 "
                         "0 0 0 0 0 1 1 1 ")
             + "DBC 0 0 0 1 1 1  1 0 0  0 90 0  0 2  NBC 0 0 0 1 1 1  0 5 0\n");
    ASSERT_EQ(s.bodies[0].boundary.size(), 2u);
    const auto& dirichlet = s.bodies[0].boundary[0];
    EXPECT_EQ(dirichlet.kind, Kind::Velocity);
    EXPECT_EQ(dirichlet.angular_deg, (Vector3{0, 90, 0}));
    EXPECT_EQ(dirichlet.t_begin, 1);
    EXPECT_EQ(dirichlet.t_end, 2);
    const auto& neumann = s.bodies[0].boundary[1];
    EXPECT_EQ(neumann.kind, Kind::Acceleration);
    EXPECT_EQ(neumann.linear, (Vector3{0, 5, 0}));
    EXPECT_EQ(neumann.t_begin, 2);
    EXPECT_EQ(neumann.t_end, 4);
}

TEST_F(IpcScript, MovesWholeShapes) {
    const Scene s = read(
        "shapes input 2\ntri.obj 0 0 0 0 0 0 1 1 1 angularVelocity 10 90 0\n"
        "tet.mesh 0 3 0 0 0 0 1 1 1 linearVelocity 1 2 3\n");
    EXPECT_EQ(s.bodies[0].boundary[0].angular_deg, (Vector3{10, 90, 0}));
    EXPECT_FALSE(
        s.bodies[0].boundary[0].center.has_value());  // the current centre of the box
    EXPECT_EQ(s.bodies[1].boundary[0].linear, (Vector3{1, 2, 3}));
    EXPECT_EQ(s.bodies[1].boundary[0].selection.kind, Selection::Kind::All);
}

TEST_F(IpcScript, MakesGridsOfShapeMatrices) {
    const Scene s = read(
        "size 4\nshapes input 1\ntet.mesh 0 0 0 0 0 0 1 1 1\nshapeMatrix input 3 1 2  1 "
        "0 0\n"
        "edge.seg 2 1 3  0 0 0  1 1 1\n");
    const Body& grid =
        s.bodies[1];  // along x from 1 to 6: everything is 6 long, the factor 2/3
    EXPECT_EQ(grid.grid, (std::array{3, 1, 2}));
    EXPECT_NEAR(grid.grid_spacing[0], 4.0 / 3.0, 1e-15);
    EXPECT_NEAR(grid.grid_spacing[2], 2.0, 1e-15);
    expect_vec(at(grid, 0, 0, 0), {2.0 / 3.0, 0, 0});
}

TEST_F(IpcScript, ReadsSequencesAndFallsBackToObj) {
    folder_.write("frames/0.seg", "v 0 0 0\nv 1 0 0\nv 0 0 1\n");
    folder_.write("frames/1.seg", "v 0 0 0\nv 1 0 0\nv 0 0 1\n");
    const Scene s = read("shapes input 1\ntri.seg 0 0 0 0 0 0 1 1 1 meshSeq frames\n");
    EXPECT_EQ(s.bodies[0].mesh.file, "tri.seg");  // there is only tri.obj
    ASSERT_EQ(s.bodies[0].boundary.size(), 1u);
    EXPECT_EQ(s.bodies[0].boundary[0].sequence,
              (std::vector<std::string>{"frames/0.seg", "frames/1.seg"}));
}

TEST_F(IpcScript, SkipsSectionsOfOtherSolvers) {
    const Scene s = read(std::string(kOneTet) + "time 2 0.1\nsection SQP QP\ntime 9 9\nconstraintSolver QP\nsection end\n"
                                                "section IP\ndensity 7\nsection end\nsection SQP\nstiffness 1 0\n");
    EXPECT_EQ(s.duration, 2);
    EXPECT_EQ(s.bodies[0].material.density, 7);
    EXPECT_EQ(s.bodies[0].material.young,
              1e5);  // a section without end goes on to the end of the file
}

TEST_F(IpcScript, SwitchesContactOfShapesOff) {
    const Scene alone = read(std::string(kOneTet) + "selfCollisionOff\n");
    EXPECT_FALSE(alone.contact.enabled);
    const Scene s = read(
        "shapes input 2\ntet.mesh 0 0 0 0 0 0 1 1 1\ntet.mesh 0 3 0 0 0 0 1 1 1\nground "
        "0 -1\n"
        "selfCollisionOff\n");
    EXPECT_TRUE(s.contact.enabled);  // with the ground
    EXPECT_FALSE(s.contact.self_contact);
    ASSERT_EQ(s.contact.pairs.size(), 1u);
    EXPECT_EQ(s.contact.pairs[0].a, "tet");
    EXPECT_EQ(s.contact.pairs[0].b, "tet_2");
    EXPECT_EQ(s.contact.pairs[0].enabled, false);
}

TEST_F(IpcScript, GivesObstaclesTheirOwnFriction) {
    const Scene s =
        read(std::string(kOneTet) + "selfFric 0.5\nmeshCO tri.obj 0 -3 0 1 50 0.1\n");
    ASSERT_EQ(s.contact.pairs.size(), 1u);
    EXPECT_EQ(s.contact.pairs[0].b, "tri");
    EXPECT_EQ(s.contact.pairs[0].friction, 0.1);
}

// ── animations
// ─────────────────────────────────────────────────────────────────────────────────

TEST_F(IpcScript, TwistTurnsBothEndsAboutX) {
    const Scene s = read(
        "script twist\nhandleRatio 0.1\nshapes input 2\ntet.mesh 0 0 0  0 0 0  1 1 1\n"
        "tet.mesh 4 0 0  0 0 0  1 1 1 DBC 0 0 0 1 1 1 0 0 0 0 0 0\n");
    ASSERT_EQ(s.bodies[0].boundary.size(), 1u);  // the left end only
    ASSERT_EQ(s.bodies[1].boundary.size(),
              1u);  // the right end only; its own condition is ignored
    const auto& left = s.bodies[0].boundary[0];
    const auto& right = s.bodies[1].boundary[0];
    EXPECT_EQ(left.angular_deg, (Vector3{-72, 0, 0}));
    EXPECT_EQ(right.angular_deg, (Vector3{72, 0, 0}));
    EXPECT_EQ(left.center.value(), (Vector3{2.5, 0.5, 0.5}));
    EXPECT_EQ(left.selection.frame, Selection::Frame::World);
    EXPECT_EQ(left.selection.box_max[0], std::nextafter(0.5, 0.0));  // x < 0 + 0.1 * 5
    EXPECT_EQ(right.selection.box_min[0], std::nextafter(4.5, 9.0));
    ASSERT_EQ(warnings_.size(), 1u);
    EXPECT_NE(warnings_[0].message.find("twist"), std::string::npos);
}

TEST_F(IpcScript, DragRightPullsUntilPastTheObstacles) {
    const Scene s =
        read(std::string(kOneTet) + "script dragright\nmeshCO tri.obj 2 0 0 3 50 0\n");
    const auto& pull = s.bodies[0].boundary.at(0);
    EXPECT_EQ(pull.linear, (Vector3{0.5, 0, 0}));
    EXPECT_EQ(pull.selection.box_min[0], std::nextafter(0.96, 1.0));
    ASSERT_TRUE(pull.until.has_value());
    EXPECT_EQ(pull.until->subject, BoundaryCondition::Until::Subject::Body);
    EXPECT_NEAR(pull.until->value, 4.0, 1e-12);  // vertices at 2 - 1 and 2 + 2
    EXPECT_FALSE(pull.until->then_hold);
}

TEST_F(IpcScript, StretchAndPauseStopsBothEnds) {
    const Scene s = read(std::string(kOneTet) + "script stretchAndPause\ntime 1 0.1\n");
    const auto& conditions = s.bodies[0].boundary;
    ASSERT_EQ(conditions.size(), 4u);
    EXPECT_EQ(conditions[0].linear, (Vector3{-1, 0, 0}));
    EXPECT_NEAR(conditions[0].t_end,
                0.25,
                1e-15);  // at -0.3 after three steps, the first beyond -0.28
    EXPECT_EQ(conditions[1].kind, Kind::Fixed);
    EXPECT_EQ(conditions[1].t_begin, conditions[0].t_end);
    EXPECT_EQ(conditions[2].linear, (Vector3{1, 0, 0}));
}

TEST_F(IpcScript, RotatesCylindersAboutTheirCentres) {
    std::string text = "script DCORotCylinders\nshapes input 5\n";
    for (int i = 0; i < 4; ++i)
        text += "tri.obj " + std::to_string(3 * i) + " 0 0  0 0 0  1 1 1\n";
    const Scene s = read(text + "tet.mesh 0 5 0  0 0 0  1 1 1\n");
    EXPECT_EQ(s.bodies[0].boundary[0].angular_deg, (Vector3{90, 0, 0}));
    EXPECT_EQ(s.bodies[1].boundary[0].angular_deg, (Vector3{-90, 0, 0}));
    EXPECT_EQ(s.bodies[2].boundary[0].angular_deg, (Vector3{0, 0, -90}));
    EXPECT_EQ(s.bodies[3].boundary[0].angular_deg, (Vector3{0, 0, 90}));
    EXPECT_EQ(s.bodies[1].boundary[0].center.value(), (Vector3{3.5, 0, 0.5}));
    EXPECT_TRUE(s.bodies[4].boundary.empty());
}

TEST_F(IpcScript, SquashSixTurnsBackWhenThePlanesAreClose) {
    std::string text = "script DCOSquash6\ntime 2 0.1\nshapes input 7\n";
    for (const char* place : {"0 0 0", "2.05 0 0", "0 -1 0", "0 3 0", "0 0 -1", "0 0 3"})
        text += "tri.obj " + std::string(place)
              + "  0 0 90  1 1 1\n";  // turned: extent 0 along x
    const Scene s = read(text + "tet.mesh 0 1 0  0 0 0  0.1 0.1 0.1\n");
    // The gap is 2.05 - 0.2 n after n steps: below 0.1 first at the begin of step 10
    // (0.05), so it turns there.
    const auto& first = s.bodies[0].boundary.at(0).path;
    ASSERT_EQ(first.size(), 3u);
    EXPECT_NEAR(first[1].time, 1.0, 1e-12);
    EXPECT_NEAR(first[1].translation[0], 1.0, 1e-12);
    EXPECT_NEAR(first[2].time, 2.0, 1e-12);
    EXPECT_NEAR(first[2].translation[0], 0.0, 1e-12);
    EXPECT_NEAR(s.bodies[1].boundary.at(0).path[1].translation[0], -1.0, 1e-12);
    EXPECT_NEAR(s.bodies[2].boundary.at(0).path[1].translation[1], 1.0, 1e-12);
    EXPECT_NEAR(s.bodies[5].boundary.at(0).path[1].translation[2], -1.0, 1e-12);
    EXPECT_TRUE(s.bodies[6].boundary.empty());
}

TEST_F(IpcScript, BedComesDownUntilNearTheOther) {
    const Scene s = read(
        "script DCOSegBedSquash\ntime 5 0.1\nshapes input 1\ntet.mesh 0 0.1 0  0 0 0  "
        "0.5 0.5 0.5\n"
        "shapeMatrix input 2 1 2\nedge.seg 1 1 1  0 0 0  1 1 1\n"
        "shapeMatrix input 2 1 2  0 2 0\nedge.seg 1 1 1  0 0 0  1 1 1\n");
    EXPECT_TRUE(s.bodies[1].boundary.empty());
    const auto& down = s.bodies[2].boundary.at(0);
    EXPECT_EQ(down.linear, (Vector3{0, -1, 0}));
    EXPECT_GT(down.t_end,
              1.9 - 0.1 + 1e-6);  // steps that start at 0, 0.1, ..., 1.8 move it ...
    EXPECT_LT(down.t_end, 2.0);   // ... until the gap is 0.1 (or, by rounding, 0)
}

TEST_F(IpcScript, BallHitsWall) {
    const Scene s = read(std::string(kOneTet) + "script DCOBallHitWall 1 7.5\n");
    EXPECT_EQ(s.bodies[0].velocity, (Vector3{7.5, 0, 0}));
}

// ── refusals
// ───────────────────────────────────────────────────────────────────────────────────

TEST_F(IpcScript, RefusesByName) {
    struct Case {
        std::string text;
        int line;  ///< 0: no line in the message
        Error::Code code;
        std::vector<const char*> parts;
    };
    const std::string one = kOneTet;
    const Case cases[] = {
        {one + "constraintSolver QP\n",
         3,
         Error::Code::Unsupported,
         {"QP", "interiorPoint"}},
        {one + "script DCOSquash5\n",
         3,
         Error::Code::Unsupported,
         {"\"DCOSquash5\"", "did you mean \"DCOSquash6\"?"}},
        {one + "script meshSeqFromFile somewhere\n",
         3,
         Error::Code::Unsupported,
         {"\"meshSeqFromFile\""}},
        {one + "restart status9\n",
         3,
         Error::Code::Unsupported,
         {"\"restart\"", "remove"}},
        {one + "energy StVK\n", 3, Error::Code::Unsupported, {"\"StVK\"", "NH or FCR"}},
        {one + "timeIntegration BDF2\n",
         3,
         Error::Code::Unsupported,
         {"\"BDF2\"", "BE or NM"}},
        {one + "tuning 1\n1e5\n",
         0,
         Error::Code::Unsupported,
         {"fixed contact stiffness", "write 0"}},
        {"shapes grid 1\n", 1, Error::Code::Unsupported, {"\"grid\"", "input"}},
        {"time 1 0.1\n", 0, Error::Code::InvalidScene, {"no shapes", "shapes input 1"}},
        {"shapes input 2\ntet.mesh 0 0 0 0 0 0 1 1 1\n",
         1,
         Error::Code::InvalidScene,
         {"end of the file", "add the lines"}},
        {"shapes input 1\ntet.mesh 0 0 0 0 0 0 1 1\n",
         2,
         Error::Code::InvalidScene,
         {"end of the line", "the scale"}},
        {"shapes input 1\ntet.mesh 0 0 0 0 0 x 1 1 1\n",
         2,
         Error::Code::InvalidScene,
         {"\"x\"", "expected a number"}},
        {"shapes input 1\ntet.mesh 0 0 0 0 0 0 1 1 1 DCB\n",
         2,
         Error::Code::InvalidScene,
         {"\"DCB\"", "did you mean \"DBC\"?"}},
        {"shapes input 1\ntet.mesh 0 0 0 0 0 0 1 1 1 material 1000 -1 0.4\n",
         2,
         Error::Code::InvalidScene,
         {"-1", "expected > 0"}},
        {"shapes input 1\ntet.mesh 0 0 0 0 0 0 0 1 1\n",
         2,
         Error::Code::InvalidScene,
         {"scale of 0"}},
        {"shapes input 1\ntat.mesh 0 0 0 0 0 0 1 1 1\n",
         2,
         Error::Code::FileNotReadable,
         {"\"tat.mesh\"", "did you mean \"tet.mesh\"?"}},
        {one + "time 1 0\n", 3, Error::Code::InvalidScene, {"expected both > 0"}},
        {one + "stiffness 1e5 0.5\n", 3, Error::Code::InvalidScene, {"0.5"}},
        {one + "tol 2\n1e-3\n",
         3,
         Error::Code::InvalidScene,
         {"found 1 numbers", "expected 2"}},
        {one + "tol 1\n0\n", 0, Error::Code::InvalidScene, {"tolerance", "> 0"}},
        {one + "halfSpace 0 0 0 0 0 0 1 1\n",
         3,
         Error::Code::InvalidScene,
         {"0 0 0", "a direction"}},
        {one + "script DCORotCylinders\n",
         3,
         Error::Code::InvalidScene,
         {"found 1 shapes", "at least 4"}},
        {"shapes input 2\ntet.mesh 0 0 0 0 0 0 1 1 1\ntet.mesh 0 3 0 0 0 0 1 1 1\nscript "
         "dragright\n",
         4,
         Error::Code::Unsupported,
         {"dragright with several shapes"}},
    };
    for (const Case& c : cases) {
        const Error error = refuse(c.text);
        const std::string file = folder_.path() + "/script.txt";
        EXPECT_EQ(error.where, c.line > 0 ? file + ":" + std::to_string(c.line) : file)
            << c.text << error.message;
        EXPECT_EQ(error.code, c.code) << c.text << error.message;
        for (const char* part : c.parts)
            EXPECT_NE(error.message.find(part), std::string::npos)
                << part << " in " << error.message;
    }
}

TEST_F(IpcScript, SurvivesDamagedText) {
    const std::string text =
        "size 1\nscript twist\ntol 1\n1e-3\nshapes input 1\ntet.mesh 0 0 0 0 0 0 1 1 1 "
        "DBC 0 0 0 1 1 1 "
        "0 0 0 0 0 0\nmeshCO tri.obj 0 0 0 1 1 0 rotate 0 0 90\ntuning 6\n0 1e-3 1e-3 "
        "1e-9 1e-3 1e-3\n";
    for (std::size_t length = 0; length < text.size(); ++length) {
        const auto scene = read_scene(folder_.write("cut.txt", text.substr(0, length)));
        EXPECT_TRUE(scene || !scene.error().message.empty()) << length;
    }
}

}  // namespace
}  // namespace noli
