// SPDX-License-Identifier: Apache-2.0
#include "step/sound_travel.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

/// A box of 1 x 0.5 x 0.25 m, `length` times as large.
Body elastic_box(
    const std::string& name, double y, double length, double young, double density) {
    Body body;
    body.name = name;
    body.mesh.generator = "box";
    body.mesh.parameters = {{"size", {1, 0.5, 0.25}}, {"cells", {4, 2, 2}}};
    body.transform.rows = {{{length, 0, 0, 0}, {0, length, 0, y}, {0, 0, length, 0}}};
    body.material.young = young;
    body.material.poisson = 0.3;
    body.material.density = density;
    return body;
}

double sound_travel_of(const std::vector<Body>& bodies, double dt) {
    Scene scene;
    scene.bodies = bodies;
    const Result<Model> model = build_model(scene);
    EXPECT_TRUE(model) << model.error().message;
    return model ? sound_travel(model.value(), dt) : -1.0;
}

/// Edge of the regular tetrahedron that is as large as the mean one of elastic_box.
double box_edge() {
    Scene scene;
    scene.bodies = {elastic_box("a", 0, 1, 1e4, 1000)};
    const Result<Model> model = build_model(scene);
    EXPECT_TRUE(model);
    return model ? std::cbrt(6.0 * std::sqrt(2.0) * 0.125 / model.value().num_tets()) : 0;
}

TEST(SoundTravel, IsTimeStepTimesSpeedOverTheElementsEdge) {
    const double expected = 0.01 * std::sqrt(4e6 / 900.0) / box_edge();
    EXPECT_NEAR(sound_travel_of({elastic_box("a", 0, 1, 4e6, 900)}, 0.01),
                expected,
                1e-10 * expected);
    EXPECT_NEAR(sound_travel_of({elastic_box("a", 0, 3, 4e6, 900)}, 0.01),
                expected / 3.0,
                1e-10 * expected);
    EXPECT_NEAR(sound_travel_of({elastic_box("a", 0, 1, 4e6, 900)}, 0.02),
                2.0 * expected,
                1e-10 * expected);
}

TEST(SoundTravel, IsTheSameForAllElasticLaws) {
    const double expected = 0.01 * std::sqrt(4e6 / 900.0) / box_edge();
    for (const Material::Model law : {Material::Model::StableNeoHookean,
                                      Material::Model::FixedCorotated,
                                      Material::Model::NeoHookean}) {
        Body body = elastic_box("a", 0, 1, 4e6, 900);
        body.material.model = law;
        EXPECT_NEAR(sound_travel_of({body}, 0.01), expected, 1e-10 * expected);
    }
}

TEST(SoundTravel, IsThatOfTheBodyWhereItIsLargest) {
    const double soft = sound_travel_of({elastic_box("a", 0, 1, 1e4, 1000)}, 0.01);
    const double small = sound_travel_of({elastic_box("a", 0, 0.1, 1e4, 1000)}, 0.01);
    const double stiff = sound_travel_of({elastic_box("a", 0, 1, 1e6, 1000)}, 0.01);
    EXPECT_NEAR(small, 10.0 * soft, 1e-9 * small);
    EXPECT_NEAR(sound_travel_of({elastic_box("a", 0, 1, 1e4, 1000),
                                 elastic_box("b", 2, 0.1, 1e4, 1000)},
                                0.01),
                small,
                1e-10 * small);
    for (const bool first : {true, false}) {
        const Body strong = elastic_box("strong", 0, 1, 1e6, 1000);
        const Body weak = elastic_box("weak", 2, 1, 1e4, 1000);
        EXPECT_NEAR(
            sound_travel_of(first ? std::vector{strong, weak} : std::vector{weak, strong},
                            0.01),
            stiff,
            1e-10 * stiff);
    }
}

TEST(SoundTravel, IgnoresObstacles) {
    Body obstacle = elastic_box("obstacle", 2, 0.01, 1e9, 1000);
    obstacle.mesh.generator = "box_surface";
    EXPECT_EQ(sound_travel_of({elastic_box("a", 0, 1, 1e4, 1000), obstacle}, 0.01),
              sound_travel_of({elastic_box("a", 0, 1, 1e4, 1000)}, 0.01));
    EXPECT_EQ(sound_travel_of({obstacle}, 0.01), 0.0);
}

TEST(DescribeLinearSolver, SaysWhatIsTakenAndWhy) {
    Scene scene;
    Body box = elastic_box("a", 0, 1, 1e4, 1000);
    box.mesh.parameters = {{"size", {1, 0.5, 0.25}}, {"cells", {9, 9, 9}}};
    scene.bodies = {box};
    const Result<Model> model = build_model(scene);
    ASSERT_TRUE(model);
    const auto says = [&](LinearSolver asked, double dt, const char* words) {
        const std::string said = describe_linear_solver(model.value(), asked, dt, false);
        EXPECT_NE(said.find(words), std::string::npos) << said;
    };
    says(LinearSolver::Pcg, 0.01, "Gauss-Seidel (stiffness reaches 0.");
    says(LinearSolver::Pcg, 10.0, "Gauss-Seidel + rigid motions of up to about 32 ver");
    says(LinearSolver::IncompleteCholesky, 0.01, "IC(0) (stiffness reaches 0.");
    says(LinearSolver::IncompleteCholesky,
         10.0,
         "IC(0) + rigid motions of up to about 16 ver");
}

}  // namespace
}  // namespace noli
