// SPDX-License-Identifier: Apache-2.0
/// Body-centred cubic lattice: the corners and the centres of cubes of side h. Its edges
/// join neighbouring corners or neighbouring centres (long, h) and corners to centres
/// (short, 0.87 h). Each tetrahedron has two opposite long edges: one between the centres
/// of two cubes that share a square, and one side of that square.
///
///     1. sign of f at each lattice vertex; where it changes, a cut point on the edge
///     2. a vertex closer to a cut point than a fixed part of the edge moves there (f =
///     0)
///     3. each lattice tetrahedron keeps its part with f >= 0: itself, a tetrahedron or a
///     prism
///     4. vertices move to where the worst element around them is better
///
/// Doubled coordinates make the lattice integral: corners are all even, centres all odd.
#include "mesh/implicit.hpp"

#include "mesh/prism.hpp"
#include "mesh/smooth.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace noli {

namespace {

/// Mean edge over cube side of the lattice: 6 long and 8 short edges at each vertex.
constexpr double kMeanEdge = (6.0 + 8.0 * 0.8660254037844386) / 14.0;
// Largest part of an edge that a vertex may move. Source: [Labelle2007].
constexpr double kWarpLong = 0.24999, kWarpShort = 0.41189;

using Lattice = std::array<int, 3>;  // doubled coordinates

class Stuffing {
  public:
    Stuffing(const ImplicitBody& body, double edge) : body_(body), h_(edge / kMeanEdge) {
        for (int k = 0; k < 3; ++k) {  // one empty cube around the body
            const double extent = body.hi[k] - body.lo[k];
            n_[k] = static_cast<int>(std::ceil(extent / h_)) + 3;
            origin_[k] = 0.5 * (body.lo[k] + body.hi[k] - n_[k] * h_);
        }
        const auto count = (2L * n_[0] + 1) * (2L * n_[1] + 1) * (2L * n_[2] + 1);
        f_.assign(static_cast<std::size_t>(count), 0.0);
        output_.assign(f_.size(), -1);
    }

    Mesh run() {
        for_each_vertex([&](const Lattice& v) { f_[id(v)] = body_.f(position(v)); });
        for_each_vertex([&](const Lattice& v) { warp(v); });
        for_each_tet([&](const std::array<Lattice, 4>& t) { fill(t); });
        detail::orient_positive(mesh_);
        return std::move(mesh_);
    }

  private:
    [[nodiscard]] std::size_t id(const Lattice& v) const {
        return static_cast<std::size_t>(
            (static_cast<long>(v[2]) * (2 * n_[1] + 1) + v[1]) * (2 * n_[0] + 1) + v[0]);
    }
    [[nodiscard]] bool inside_grid(const Lattice& v) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (v[k] < 0 || v[k] > 2 * n_[static_cast<int>(k)]) return false;
        return true;
    }
    [[nodiscard]] Vec3d position(const Lattice& v) const {
        return origin_ + (0.5 * h_) * Vec3d{1.0 * v[0], 1.0 * v[1], 1.0 * v[2]};
    }
    [[nodiscard]] Vec3d warped_position(const Lattice& v) const {
        const auto it = warped_.find(id(v));
        return it == warped_.end() ? position(v) : it->second;
    }
    [[nodiscard]] int sign(const Lattice& v) const {
        const double f = f_[id(v)];
        return (f > 0.0) - (f < 0.0);
    }
    static bool is_long(const Lattice& a, const Lattice& b) {
        return ((a[0] ^ b[0]) & 1) == 0;
    }

    template <class F>
    void for_each_vertex(F f) const {
        for (int k = 0; k <= 2 * n_[2]; ++k)
            for (int j = k & 1; j <= 2 * n_[1]; j += 2)
                for (int i = k & 1; i <= 2 * n_[0]; i += 2)
                    f(Lattice{i, j, k});
    }

    /// Each centre, each of the three axes: the cube behind, and the four sides of the
    /// shared square.
    template <class F>
    void for_each_tet(F f) const {
        for_each_vertex([&](const Lattice& c) {
            for (std::size_t axis = 0; axis < 3 && (c[0] & 1) == 1; ++axis) {
                Lattice d = c;
                d[axis] += 2;
                if (!inside_grid(d)) continue;
                const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
                constexpr int kSquare[5][2] = {
                    {-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
                for (int s = 0; s < 4; ++s) {
                    Lattice a = c, b = c;
                    ++a[axis], ++b[axis];
                    a[u] += kSquare[s][0], a[v] += kSquare[s][1];
                    b[u] += kSquare[s + 1][0], b[v] += kSquare[s + 1][1];
                    f(std::array<Lattice, 4>{c, d, a, b});
                }
            }
        });
    }

    /// Where f vanishes between two lattice vertices, as a part of the way from a to b.
    [[nodiscard]] double cut_parameter(const Lattice& a, const Lattice& b) const {
        const Vec3d xa = position(a), xb = position(b);
        double lo = 0.0, hi = 1.0;
        const bool a_is_inside = f_[id(a)] > 0.0;
        for (int i = 0; i < 40; ++i) {
            const double mid = 0.5 * (lo + hi);
            ((body_.f(xa + mid * (xb - xa)) > 0.0) == a_is_inside ? lo : hi) = mid;
        }
        return 0.5 * (lo + hi);
    }

    /// Moves a vertex onto the closest cut point of its edges, if one is close enough.
    void warp(const Lattice& v) {
        if (sign(v) == 0) return;
        double closest = 1e300;
        Vec3d target{};
        const auto visit = [&](const Lattice& w) {
            if (!inside_grid(w) || sign(v) * sign(w) >= 0) return;
            const double t = cut_parameter(v, w),
                         length = is_long(v, w) ? 1.0 : 0.8660254037844386;
            if (t >= (is_long(v, w) ? kWarpLong : kWarpShort) || t * length >= closest)
                return;
            closest = t * length;
            target = position(v) + t * (position(w) - position(v));
        };
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const int step : {-2, 2}) {
                Lattice w = v;
                w[axis] += step;
                visit(w);
            }
        for (int corner = 0; corner < 8; ++corner)
            visit({v[0] + (corner & 1) * 2 - 1,
                   v[1] + (corner >> 1 & 1) * 2 - 1,
                   v[2] + (corner >> 2) * 2 - 1});
        if (closest == 1e300) return;
        f_[id(v)] = 0.0;
        warped_[id(v)] = target;
    }

    int output_vertex(const Lattice& v) {
        int& index = output_[id(v)];
        if (index < 0) {
            index = static_cast<int>(mesh_.x.size());
            mesh_.x.push_back(warped_position(v));
        }
        return index;
    }

    /// Cut vertex between an inside and an outside vertex.
    int output_cut(const Lattice& a, const Lattice& b) {
        const auto [it, is_new] = cuts_.try_emplace(
            std::uint64_t{id(a)} * f_.size() + id(b), static_cast<int>(mesh_.x.size()));
        if (is_new)
            mesh_.x.push_back(position(a)
                              + cut_parameter(a, b) * (position(b) - position(a)));
        return it->second;
    }

    /// Does the diagonal of the quad (p, q, cut q-m, cut p-m) start at p? Depends on the
    /// face only.
    [[nodiscard]] bool diagonal_from_first(const Lattice& p,
                                           const Lattice& q,
                                           const Lattice& m) const {
        const bool p_long = is_long(p, m), q_long = is_long(q, m);
        return p_long != q_long ? q_long : id(p) < id(q);
    }

    void fill(const std::array<Lattice, 4>& t) {
        std::vector<Lattice> in, out, on;
        for (const Lattice& v : t)
            (sign(v) > 0 ? in : (sign(v) < 0 ? out : on)).push_back(v);
        if (in.empty()) return;
        if (out.empty()) {
            mesh_.tets.push_back({output_vertex(t[0]),
                                  output_vertex(t[1]),
                                  output_vertex(t[2]),
                                  output_vertex(t[3])});
        } else if (in.size() == 1) {
            Int4 tet{output_vertex(in[0]), 0, 0, 0};
            int k = 1;
            for (const Lattice& v : out)
                tet[k++] = output_cut(in[0], v);
            for (const Lattice& v : on)
                tet[k++] = output_vertex(v);
            mesh_.tets.push_back(tet);
        } else if (out.size() == 1) {
            fill_below(in, on, out[0]);
        } else {
            fill_wedge(in, out);
        }
    }

    /// One vertex is outside: a prism between the inside vertices and their cuts.
    void fill_below(const std::vector<Lattice>& in,
                    const std::vector<Lattice>& on,
                    const Lattice& m) {
        int a[3], b[3], rank[3] = {0, 0, 0}, order[3];
        const auto num_in = static_cast<int>(in.size());
        for (int i = 0; i < num_in; ++i) {
            a[i] = output_vertex(in[static_cast<std::size_t>(i)]);
            b[i] = output_cut(in[static_cast<std::size_t>(i)], m);
        }
        if (num_in == 2) a[2] = b[2] = output_vertex(on[0]), rank[2] = 2;
        for (int i = 0; i < num_in; ++i)
            for (int j = i + 1; j < num_in; ++j) {
                const bool from_i = diagonal_from_first(
                    in[static_cast<std::size_t>(i)], in[static_cast<std::size_t>(j)], m);
                ++rank[from_i ? j : i];
            }
        for (int i = 0; i < 3; ++i)
            order[rank[i]] = i;
        detail::split_prism(a, b, order, mesh_.tets);
    }

    /// Two vertices in, two out: a prism whose third quad is a part of the surface and
    /// cut freely.
    void fill_wedge(const std::vector<Lattice>& in, const std::vector<Lattice>& out) {
        const int a[3] = {
            output_vertex(in[0]), output_cut(in[0], out[0]), output_cut(in[0], out[1])};
        const int b[3] = {
            output_vertex(in[1]), output_cut(in[1], out[0]), output_cut(in[1], out[1])};
        const bool first_below_1 = diagonal_from_first(in[0], in[1], out[0]);
        const bool first_below_2 = diagonal_from_first(in[0], in[1], out[1]);
        bool one_below_2 = first_below_2;  // if only one of the two is above column 0, it
                                           // is above the other
        if (first_below_1 == first_below_2) {
            const auto at = [&](int v) { return mesh_.x[static_cast<std::size_t>(v)]; };
            one_below_2 = norm_sq(at(a[1]) - at(b[2])) <= norm_sq(at(a[2]) - at(b[1]));
        }
        const int rank[3] = {!first_below_1 + !first_below_2,
                             first_below_1 + !one_below_2,
                             first_below_2 + one_below_2};
        int order[3];
        for (int i = 0; i < 3; ++i)
            order[rank[i]] = i;
        detail::split_prism(a, b, order, mesh_.tets);
    }

    const ImplicitBody& body_;
    double h_;
    int n_[3];
    Vec3d origin_{};
    std::vector<double> f_;    // at lattice vertices, 0 where warped
    std::vector<int> output_;  // index in mesh_.x
    std::unordered_map<std::size_t, Vec3d> warped_;
    std::unordered_map<std::uint64_t, int> cuts_;
    Mesh mesh_;
};

}  // namespace

double estimated_tets(const ImplicitBody& body, double edge_length) {
    const Vec3d size = body.hi - body.lo;
    return 12.0 * size.x * size.y * size.z / std::pow(edge_length / kMeanEdge, 3);
}

Mesh tetrahedralized(const ImplicitBody& body, double edge_length) {
    constexpr int kSweeps = 8;
    Mesh mesh = Stuffing(body, edge_length).run();
    detail::smooth(mesh, body, edge_length, kSweeps);
    return mesh;
}

}  // namespace noli
