// SPDX-License-Identifier: Apache-2.0
#include "mesh/smooth.hpp"

#include "mesh/topology.hpp"

#include <algorithm>
#include <cmath>

namespace noli::detail {

namespace {

class Smoother {
  public:
    Smoother(Mesh& mesh, const ImplicitBody& body, double edge)
        : mesh_(mesh), body_(body), edge_(edge) {
        const std::size_t n = mesh.x.size();
        start_.assign(n + 1, 0);
        for (const Int4& t : mesh.tets)
            for (const int v : t.v)
                ++start_[static_cast<std::size_t>(v) + 1];
        for (std::size_t v = 0; v < n; ++v)
            start_[v + 1] += start_[v];
        around_.resize(4 * mesh.tets.size());
        std::vector<int> fill(start_.begin(), start_.end() - 1);
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            for (const int v : mesh.tets[t].v)
                around_[static_cast<std::size_t>(fill[static_cast<std::size_t>(v)]++)] =
                    static_cast<int>(t);
        on_surface_.assign(n, false);
        for (const Int3& t : boundary_triangles(mesh.tets))
            for (const int v : t.v)
                on_surface_[static_cast<std::size_t>(v)] = true;
    }

    void run(int sweeps) {
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (std::size_t v = 0; v < mesh_.x.size(); ++v)
                improve(v, 0.2 * edge_ / (1 << (sweep / 3)));
    }

  private:
    /// 0.9 of a regular tetrahedron; the untouched lattice has 0.93.
    static constexpr double kGood = 0.9 * 0.0481125;

    /// 6 V / (sum of squared edges)^{3/2}
    [[nodiscard]] double quality(const Int4& t) const {
        const auto at = [&](int k) -> const Vec3d& {
            return mesh_.x[static_cast<std::size_t>(t[k])];
        };
        const Vec3d a = at(1) - at(0), b = at(2) - at(0), c = at(3) - at(0);
        const double sum = norm_sq(a) + norm_sq(b) + norm_sq(c) + norm_sq(b - a)
                         + norm_sq(c - a) + norm_sq(c - b);
        return dot(cross(a, b), c) / (sum * std::sqrt(sum));
    }

    [[nodiscard]] double worst_around(std::size_t v) const {
        double worst = 1.0;
        for (int k = start_[v]; k < start_[v + 1]; ++k)
            worst = std::min(worst,
                             quality(mesh_.tets[static_cast<std::size_t>(
                                 around_[static_cast<std::size_t>(k)])]));
        return worst;
    }

    [[nodiscard]] Vec3d centre_of_neighbours(std::size_t v) const {
        Vec3d sum{0, 0, 0};
        double count = 0;
        for (int k = start_[v]; k < start_[v + 1]; ++k)
            for (const int w :
                 mesh_
                     .tets[static_cast<std::size_t>(around_[static_cast<std::size_t>(k)])]
                     .v) {
                const auto i = static_cast<std::size_t>(w);
                if (i == v || (on_surface_[v] && !on_surface_[i])) continue;
                sum += mesh_.x[i];
                count += 1.0;
            }
        return (1.0 / count) * sum;
    }

    /// Newton's method along the gradient onto f = 0.
    [[nodiscard]] Vec3d projected(Vec3d x) const {
        const double eps = 1e-5 * edge_;
        for (int i = 0; i < 4; ++i) {
            Vec3d slope{};
            for (int k = 0; k < 3; ++k) {
                Vec3d hi = x, lo = x;
                hi[k] += eps;
                lo[k] -= eps;
                slope[k] = (body_.f(hi) - body_.f(lo)) / (2.0 * eps);
            }
            const double f = body_.f(x), slope_sq = norm_sq(slope);
            if (!(slope_sq > 0.0)) return x;
            x -= (f / slope_sq) * slope;
            if (std::fabs(f) < 1e-12 * edge_ * std::sqrt(slope_sq)) break;
        }
        return x;
    }

    void improve(std::size_t v, double step) {
        const Vec3d start = mesh_.x[v];
        double best = worst_around(v);
        if (best > kGood) return;
        Vec3d best_x = start;
        const auto attempt = [&](const Vec3d& x) {
            mesh_.x[v] = on_surface_[v] ? projected(x) : x;
            if (const double q = worst_around(v); q > best) {
                best = q;
                best_x = mesh_.x[v];
            }
        };
        const Vec3d centre = centre_of_neighbours(v);
        attempt(centre);
        attempt(0.5 * (start + centre));
        for (int k = 0; k < 3; ++k)
            for (const double s : {-step, step}) {
                Vec3d x = best_x;
                x[k] += s;
                attempt(x);
            }
        mesh_.x[v] = best_x;
    }

    Mesh& mesh_;
    const ImplicitBody& body_;
    double edge_;
    std::vector<int> start_, around_;  // tetrahedra at each vertex
    std::vector<char> on_surface_;
};

}  // namespace

void smooth(Mesh& mesh, const ImplicitBody& body, double edge, int sweeps) {
    Smoother(mesh, body, edge).run(sweeps);
}

}  // namespace noli::detail
