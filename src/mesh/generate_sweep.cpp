// SPDX-License-Identifier: Apache-2.0
/// Bodies that a round disc sweeps: cylinder, torus, knot. The disc is rings of 6, 12, 18
/// .. vertices around its centre; the prisms between two discs become three tetrahedra
/// each.
#include "mesh/generate.hpp"
#include "mesh/parameters.hpp"
#include "mesh/prism.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace noli {

namespace {

constexpr double kPi = std::numbers::pi;

struct Disc {
    std::vector<Vec2d> x;  ///< in the unit circle
    std::vector<Int3> triangles;
};

int rounded(double value, int at_least) {
    return std::max(at_least, static_cast<int>(std::lround(value)));
}

Disc make_disc(int rings) {
    Disc disc;
    disc.x.push_back({0, 0});
    const auto vertex = [](int ring, int i) {
        return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring);
    };
    for (int ring = 1; ring <= rings; ++ring)
        for (int i = 0; i < 6 * ring; ++i) {
            const double angle = 2.0 * kPi * i / (6 * ring),
                         radius = static_cast<double>(ring) / rings;
            disc.x.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        }
    for (int ring = 1; ring <= rings; ++ring)
        for (int sector = 0; sector < 6; ++sector)
            for (int i = 0; i < ring; ++i) {
                const int outer = vertex(ring, sector * ring + i),
                          next = vertex(ring, sector * ring + i + 1);
                const int inner = vertex(ring - 1, sector * (ring - 1) + i);
                disc.triangles.push_back({inner, outer, next});
                if (i + 1 < ring)
                    disc.triangles.push_back(
                        {inner, next, vertex(ring - 1, sector * (ring - 1) + i + 1)});
            }
    return disc;
}

/// Where a copy of the disc lies: centre and the two axes of its plane, times its radius.
struct Station {
    Vec3d centre, u, v;
};

Mesh sweep(const Disc& disc, const std::vector<Station>& stations, bool closed) {
    Mesh mesh;
    for (const Station& s : stations)
        for (const Vec2d& q : disc.x)
            mesh.x.push_back(s.centre + q.x * s.u + q.y * s.v);
    const auto per_disc = static_cast<int>(disc.x.size());
    const auto count = static_cast<int>(stations.size());
    for (int s = 0; s + (closed ? 0 : 1) < count; ++s)
        for (const Int3& t : disc.triangles) {
            int a[3], b[3], order[3] = {0, 1, 2};
            for (int k = 0; k < 3; ++k) {
                a[k] = s * per_disc + t[k];
                b[k] = (s + 1) % count * per_disc + t[k];
            }
            std::sort(order, order + 3, [&](int i, int j) { return t[i] < t[j]; });
            detail::split_prism(a, b, order, mesh.tets);
        }
    detail::orient_positive(mesh);
    return mesh;
}

/// Number of tetrahedra of a sweep, before anything is built.
double estimate(double radius, double length, double edge) {
    const double rings = std::max(1.0, radius / edge);
    return 18.0 * rings * rings * std::max(3.0, length / edge);
}

Vec3d knot_point(const KnotParams& p, double t) {
    constexpr double kSway =
        0.4;  // of the strand about the ring, relative to the ring's radius
    const double r = p.radius * (1.0 + kSway * std::cos(p.q * t));
    return {r * std::cos(p.p * t),
            p.radius * kSway * std::sin(p.q * t),
            r * std::sin(p.p * t)};
}

/// Points at equal distances along a closed curve.
struct ClosedCurve {
    std::vector<Vec3d> x;
    double length;
};

ClosedCurve sample_knot(const KnotParams& p, double edge_length) {
    constexpr int kFine = 8192;
    std::vector<double> arc(kFine + 1, 0.0);
    for (int i = 1; i <= kFine; ++i)
        arc[static_cast<std::size_t>(i)] =
            arc[static_cast<std::size_t>(i - 1)]
            + norm(knot_point(p, 2.0 * kPi * i / kFine)
                   - knot_point(p, 2.0 * kPi * (i - 1) / kFine));
    ClosedCurve curve{{}, arc.back()};
    const int count = rounded(curve.length / edge_length, 12);
    for (int i = 0; i < count; ++i) {
        const double target = curve.length * i / count;
        const auto above = std::upper_bound(arc.begin(), arc.end() - 1, target);
        const double before = *(above - 1), after = *above;
        const double t = static_cast<double>(above - 1 - arc.begin())
                       + (target - before) / (after - before);
        curve.x.push_back(knot_point(p, 2.0 * kPi * t / kFine));
    }
    return curve;
}

/// Discs across a closed curve. Each frame is the last one turned the least; what is
/// missing to a full turn at the end is shared out evenly.
std::vector<Station> frames_along(const std::vector<Vec3d>& x, double radius) {
    const std::size_t n = x.size();
    std::vector<Vec3d> tangent(n), u(n + 1);
    for (std::size_t i = 0; i < n; ++i)
        tangent[i] = normalized(x[(i + 1) % n] - x[(i + n - 1) % n]);
    const auto flattened = [&](const Vec3d& a, std::size_t i) {
        return normalized(a - dot(a, tangent[i]) * tangent[i]);
    };
    u[0] = flattened(std::fabs(tangent[0].y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, 0);
    for (std::size_t i = 1; i <= n; ++i)
        u[i] = flattened(u[i - 1], i % n);
    const double gap = std::atan2(dot(cross(u[n], u[0]), tangent[0]), dot(u[n], u[0]));
    std::vector<Station> stations;
    for (std::size_t i = 0; i < n; ++i) {
        const double turn = gap * static_cast<double>(i) / static_cast<double>(n);
        const Vec3d v = cross(tangent[i], u[i]);
        const Vec3d turned = std::cos(turn) * u[i] + std::sin(turn) * v;
        stations.push_back({x[i], radius * turned, radius * cross(tangent[i], turned)});
    }
    return stations;
}

/// Largest tube radius that keeps strands apart and bends open, from points of the centre
/// line.
double largest_tube_radius(const ClosedCurve& curve) {
    const auto n = static_cast<int>(curve.x.size());
    const auto at = [&](int i) { return curve.x[static_cast<std::size_t>((i + n) % n)]; };
    const double step = curve.length / n;
    double radius = curve.length;
    for (int i = 0; i < n; ++i) {
        const double curvature =
            norm(at(i + 1) - 2.0 * at(i) + at(i - 1)) / (step * step);
        radius = std::min(radius, 1.0 / std::max(curvature, 1e-300));
    }
    const int neighbours =
        static_cast<int>(kPi * radius / step) + 1;  // half a turn of the tightest bend
    for (int i = 0; i < n; ++i)
        for (int j = i + neighbours; j <= i + n - neighbours; ++j)
            radius = std::min(radius, 0.5 * norm(at(j) - at(i)));
    return 0.9 * radius;
}

}  // namespace

Result<Mesh> make_cylinder(const CylinderParams& p) {
    detail::ParameterCheck check("cylinder");
    check.above("radius", p.radius, 0.0).above("height", p.height, 0.0);
    check.above("edge_length", p.edge_length, 0.0, p.radius);
    check.elements(estimate(p.radius, p.height, p.edge_length), kMaxGeneratedElements);
    if (check.error()) return *check.error();
    const int layers = rounded(p.height / p.edge_length, 1);
    std::vector<Station> stations;
    for (int i = 0; i <= layers; ++i)
        stations.push_back({{0, p.height * (static_cast<double>(i) / layers - 0.5), 0},
                            {p.radius, 0, 0},
                            {0, 0, p.radius}});
    return sweep(make_disc(rounded(p.radius / p.edge_length, 1)), stations, false);
}

Result<Mesh> make_torus(const TorusParams& p) {
    detail::ParameterCheck check("torus");
    check.above("major_radius", p.major_radius, 0.0);
    check.above("minor_radius", p.minor_radius, 0.0, 0.95 * p.major_radius);
    check.above("edge_length", p.edge_length, 0.0, p.minor_radius);
    check.elements(estimate(p.minor_radius, 2.0 * kPi * p.major_radius, p.edge_length),
                   kMaxGeneratedElements);
    if (check.error()) return *check.error();
    const int count = rounded(2.0 * kPi * p.major_radius / p.edge_length, 6);
    std::vector<Station> stations;
    for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * kPi * i / count;
        const Vec3d out{std::cos(angle), 0, std::sin(angle)};
        stations.push_back(
            {p.major_radius * out, p.minor_radius * out, {0, p.minor_radius, 0}});
    }
    return sweep(make_disc(rounded(p.minor_radius / p.edge_length, 1)), stations, true);
}

Result<Mesh> make_knot(const KnotParams& p) {
    detail::ParameterCheck check("knot");
    check.range("p", p.p, 1, 5).range("q", p.q, 1, 7).above("radius", p.radius, 0.0);
    check.require(
        std::gcd(p.p, p.q) == 1, "q", p.q, "a number without a common divisor with p");
    check.above("tube_radius", p.tube_radius, 0.0, p.radius);
    check.above("edge_length", p.edge_length, 0.0, p.tube_radius);
    if (check.error()) return *check.error();
    const ClosedCurve coarse =
        sample_knot(p, 0.01 * p.radius);  // at most a few thousand points
    check.above("tube_radius", p.tube_radius, 0.0, largest_tube_radius(coarse));
    check.elements(estimate(p.tube_radius, coarse.length, p.edge_length),
                   kMaxGeneratedElements);
    if (check.error()) return *check.error();
    const ClosedCurve curve = sample_knot(p, p.edge_length);
    return sweep(make_disc(rounded(p.tube_radius / p.edge_length, 1)),
                 frames_along(curve.x, p.tube_radius),
                 true);
}

}  // namespace noli
