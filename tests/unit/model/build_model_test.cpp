// SPDX-License-Identifier: Apache-2.0
/// From a scene to flat arrays: masses, length scales, tables.

#include "model/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace noli {
namespace {

Body box(const std::string& name, double x) {
    Body body;
    body.name = name;
    body.mesh.generator = "box";
    body.mesh.parameters = {{"size", {1, 1, 1}}, {"cells", {2, 2, 2}}};
    body.transform.rows = {{{1, 0, 0, x}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    return body;
}

Model built(const Scene& scene) {
    Result<Model> model = build_model(scene);
    EXPECT_TRUE(model) << model.error().message;
    return model ? model.value() : Model{};
}

TEST(BuildModel, LumpedMassIsThatOfTheVolume) {
    Scene scene;
    scene.bodies = {box("a", 0)};
    scene.bodies[0].material.density = 700;
    const Model m = built(scene);
    EXPECT_NEAR(std::accumulate(m.mass.begin(), m.mass.end(), 0.0), 700.0, 1e-9);
    EXPECT_NEAR(std::accumulate(m.volume.begin(), m.volume.end(), 0.0), 1.0, 1e-12);
    EXPECT_NEAR(m.mean_mass * m.num_vertices, 700.0, 1e-9);
}

TEST(BuildModel, RelativeSettingsScaleWithTheDiagonalOfElasticBodies) {
    Scene scene;
    scene.bodies = {box("a", 0), box("b", 2)};
    const Model m = built(scene);
    EXPECT_NEAR(m.diagonal, std::sqrt(9.0 + 1.0 + 1.0), 1e-12);
    EXPECT_NEAR(m.dhat, scene.contact.dhat * m.diagonal, 1e-15);
    EXPECT_NEAR(m.tolerance(scene.solver, 0), scene.solver.tolerance * m.diagonal, 1e-15);
    scene.solver.tolerance_per_step = {1e-2, 1e-3};
    EXPECT_NEAR(m.tolerance(scene.solver, 5), 1e-3 * m.diagonal, 1e-15);
}

TEST(BuildModel, GridsMakeCopiesThatAreBodiesOfTheirOwn) {
    Scene scene;
    scene.bodies = {box("a", 0)};
    scene.bodies[0].grid = {2, 1, 2};
    scene.bodies[0].grid_spacing = {1.5, 0, 2.5};
    const Model m = built(scene);
    EXPECT_EQ(m.num_bodies(), 4);
    EXPECT_EQ(m.num_vertices, 4 * 27);
    EXPECT_NEAR(m.x0.back().x - m.x0[26].x, 1.5, 1e-12);
    EXPECT_NEAR(m.x0.back().z - m.x0[26].z, 2.5, 1e-12);
}

TEST(BuildModel, TetsAreOrderedByLawAndRememberTheirPlace) {
    Scene scene;
    scene.bodies = {box("corotated", 0), box("stable", 2)};
    scene.bodies[0].material.model = Material::Model::FixedCorotated;
    scene.bodies[1].material.model = Material::Model::StableNeoHookean;
    const Model m = built(scene);
    const int half = m.num_tets() / 2;
    EXPECT_EQ(m.model_begin[1], half);
    EXPECT_EQ(m.model_begin[2], half);
    EXPECT_EQ(m.model_begin[3], 2 * half);
    for (int k = 0; k < half; ++k)
        EXPECT_EQ(
            m.body[static_cast<std::size_t>(m.tets[static_cast<std::size_t>(k)][0])], 1);
    EXPECT_EQ(m.tet_source[0], half);
}

TEST(BuildModel, FrictionOfAPairIsTheLargerOneUnlessTheTableSaysOtherwise) {
    Scene scene;
    scene.bodies = {box("a", 0), box("b", 2), box("c", 4)};
    scene.bodies[0].friction = 0.1;
    scene.bodies[1].friction = 0.4;
    ContactPairRule rule;
    rule.a = "a";
    rule.b = "c";
    rule.friction = 0.7;
    scene.contact.pairs = {rule};
    const Model m = built(scene);
    EXPECT_EQ(m.pair_friction[0 * 3 + 2], 0.7);
    EXPECT_EQ(m.pair_friction[2 * 3 + 0], 0.7);
    EXPECT_EQ(m.pair_friction[0 * 3 + 1], 0.4);
    EXPECT_EQ(m.pair_friction[1 * 3 + 0], 0.4);
}

}  // namespace
}  // namespace noli
