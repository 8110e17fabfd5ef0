// SPDX-License-Identifier: Apache-2.0
#include "contact/nested.hpp"

#include "contact_shapes.hpp"

namespace noli {
namespace {

using namespace contact_test;

/// Turns the triangles from `first` on inside out: a cavity.
void reverse(Shape& s, std::size_t first) {
    for (std::size_t k = first; k < s.mesh.triangles.size(); ++k)
        std::swap(s.mesh.triangles[k].v[1], s.mesh.triangles[k].v[2]);
}

/// Gives the vertices from `first` on to a body.
void give(Shape& s, std::size_t first, int body) {
    std::fill(s.mesh.body.begin() + std::ptrdiff_t(first), s.mesh.body.end(), body);
}

/// A ball of radius 1 with a cavity of radius 0.5.
Shape hollow_ball() {
    Shape s;
    add_sphere(s, {0, 0, 0}, 1.0, 9);
    const std::size_t vertices = s.x.size();
    const std::size_t triangles = s.mesh.triangles.size();
    add_sphere(s, {0, 0, 0}, 0.5, 7);
    reverse(s, triangles);
    give(s, vertices, 0);
    return s;
}

std::vector<Nested> nested_in(Shape& s, std::vector<bool> solid) {
    complete(s);
    return nested_bodies(s.mesh, solid, s.view());
}

TEST(NestedBodies, FindsABallInABallWhicheverComesFirst) {
    for (const bool swapped : {false, true}) {
        Shape s;
        add_sphere(s, {0, 0, 0}, swapped ? 0.4 : 1.0, 9);
        add_sphere(s, {0.1, 0, 0}, swapped ? 1.0 : 0.4, 7);
        const std::vector<Nested> found = nested_in(s, {true, true});
        ASSERT_EQ(found.size(), 1U);
        EXPECT_EQ(found[0].inner, swapped ? 0 : 1);
        EXPECT_EQ(found[0].outer, swapped ? 1 : 0);
        EXPECT_EQ(s.mesh.body[std::size_t(found[0].vertex)], found[0].inner);
    }
}

TEST(NestedBodies, SeesThatTheCornerOfABoxIsNotTheBall) {
    Shape s;
    add_sphere(s, {0, 0, 0}, 1.0, 20);
    add_sphere(s, {0.75, 0.75, 0.75}, 0.2, 5);
    EXPECT_TRUE(nested_in(s, {true, true}).empty());
}

TEST(NestedBodies, LeavesWhatLiesInACavityAlone) {
    Shape s = hollow_ball();
    add_sphere(s, {0.1, 0, 0}, 0.3, 5);
    EXPECT_TRUE(nested_in(s, {true, true}).empty());
}

TEST(NestedBodies, FindsWhatLiesInTheWall) {
    Shape s = hollow_ball();
    add_sphere(s, {0, 0.75, 0}, 0.15, 5);
    const std::vector<Nested> found = nested_in(s, {true, true});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].inner, 1);
}

TEST(NestedBodies, FindsAPartInsideAnotherPartOfTheSameBody) {
    Shape s;
    add_sphere(s, {0, 0, 0}, 1.0, 9);
    const std::size_t vertices = s.x.size();
    add_sphere(s, {0, 0, 0}, 0.5, 7);
    give(s, vertices, 0);
    const std::vector<Nested> found = nested_in(s, {true});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].inner, 0);
    EXPECT_EQ(found[0].outer, 0);
}

TEST(NestedBodies, FindsAnObstacleInASolidButNotASolidInAnObstacle) {
    Shape s;
    add_sphere(s, {0, 0, 0}, 1.0, 9);
    add_sphere(s, {0, 0, 0}, 0.4, 7);
    complete(s);
    EXPECT_EQ(nested_bodies(s.mesh, {true, false}, s.view()).size(), 1U);
    EXPECT_TRUE(nested_bodies(s.mesh, {false, true}, s.view()).empty());
    s.mesh.pair_enabled = {1, 0, 0, 1};
    EXPECT_TRUE(nested_bodies(s.mesh, {true, false}, s.view()).empty());
}

}  // namespace
}  // namespace noli
