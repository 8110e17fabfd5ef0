// SPDX-License-Identifier: Apache-2.0
/// Contact product y += H c on the CPU: dense blocks per pair (linear/dense_pairs.hpp)
/// against low-rank modes (linear/low_rank.hpp), same pairs, same gather per vertex, all
/// cores. Says nothing about GPUs. Prints CSV.
///
///     warp_product_bench [num_pairs ...]

#include "energy/contact_pair.hpp"
#include "exec/cpu.hpp"
#include "linear/dense_pairs.hpp"

#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace noli {
namespace {

constexpr BarrierParams kBarrier{
    .dhat = 2.0, .kappa = 3.0, .exponent = 2, .curvature_cap = 0.0};
constexpr int kReach = 64;  ///< a pair's vertices lie this close in the vertex order

/// Which pair types a run has.
enum class Mix { PointPoint, PointEdge, PointTriangle, EdgeEdge, Quarter };
constexpr const char* kMixNames[] = {"PP", "PE", "PT", "EE", "quarter of each"};

/// The same random pairs in both forms.
struct Pairs {
    WarpProduct<CpuExec> dense;
    LowRankTerms<CpuExec> low_rank;
    std::vector<Vec3d> x;
    std::vector<Vec3d> c;  ///< not x: H x nearly cancels
    std::size_t low_rank_storage = 0;

    std::vector<Int4> term_vertices;
    std::vector<int> first_mode{0};
    std::vector<Mode> modes;
    std::mt19937 rng{1};
};

/// S different vertices from `first` on, near each other.
template <int S>
void draw_vertices(Pairs& pairs, int first, int (&v)[S]) {
    const int n = static_cast<int>(pairs.x.size());
    std::uniform_int_distribution<int> offset(1, kReach);
    v[0] = first;
    for (int s = 1; s < S; ++s) {
        do
            v[s] = (first + offset(pairs.rng)) % n;
        while (std::find(v, v + s, v[s]) != v + s);
    }
}

/// Pairs in the order of their first vertices, as a search over a mesh in a local order
/// finds them.
template <int S>
void add_pairs(Pairs& pairs,
               ContactHessian model,
               PairKind kind,
               int count,
               DenseBlocks<CpuExec, S>& to) {
    to.resize(count);
    for (int i = 0; i < count; ++i) {
        int v[S];
        draw_vertices(pairs,
                      static_cast<int>(pairs.x.size() * static_cast<std::size_t>(i)
                                       / static_cast<std::size_t>(count)),
                      v);
        Stencil<S> at;
        Int4 term{{-1, -1, -1, -1}};
        for (int s = 0; s < S; ++s) {
            at.x[s] = pairs.x[static_cast<std::size_t>(v[s])];
            to.vertices.view()[S * i + s] = v[s];
            term[s] = v[s];
        }
        const auto hessian = pair_hessian(model, kind, at, kBarrier);
        dense_block(hessian, to.values.view().data + 9 * S * S * i);
        pairs.term_vertices.push_back(term);
        // As the simulator does: room for the largest rank, missing modes are zero.
        const int rank = max_rank(kind, model);
        for (int k = 0; k < rank; ++k) {
            Mode mode{};
            for (int s = 0; k < hessian.rank && s < S; ++s)
                mode.q[s] = hessian.q[k][s];
            pairs.modes.push_back(mode);
        }
        pairs.first_mode.push_back(static_cast<int>(pairs.modes.size()));
        pairs.low_rank_storage += low_rank_bytes(rank);
    }
}

/// About as many vertices as pairs, as in a scene with much contact.
void build(CpuExec& exec, Pairs& pairs, Mix mix, ContactHessian model, int num_pairs) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < std::max(num_pairs, 4 * kReach); ++i)
        pairs.x.push_back({unit(pairs.rng), unit(pairs.rng), unit(pairs.rng)});
    for (std::size_t i = 0; i < pairs.x.size(); ++i)
        pairs.c.push_back({unit(pairs.rng), unit(pairs.rng), unit(pairs.rng)});
    const auto count = [&](Mix type) {
        if (mix == Mix::Quarter) return num_pairs / 4;
        return mix == type ? num_pairs : 0;
    };
    WarpProduct<CpuExec>& dense = pairs.dense;
    add_pairs(
        pairs, model, PairKind::PointPoint, count(Mix::PointPoint), dense.point_point);
    add_pairs(pairs, model, PairKind::PointEdge, count(Mix::PointEdge), dense.point_edge);
    add_pairs(pairs,
              model,
              PairKind::PointTriangle,
              count(Mix::PointTriangle),
              dense.point_triangle);
    add_pairs(pairs, model, PairKind::EdgeEdge, count(Mix::EdgeEdge), dense.edge_edge);
    exec.upload(pairs.term_vertices, pairs.low_rank.vertices);
    exec.upload(pairs.first_mode, pairs.low_rank.first_mode);
    exec.upload(pairs.modes, pairs.low_rank.modes);
    const int num_vertices = static_cast<int>(pairs.x.size());
    dense.build_incidence(exec, num_vertices);
    pairs.low_rank.build_incidence(exec, num_vertices);
}

struct Seconds {
    double dense, modes;
};

double median(std::vector<double>& times) {
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
}

/// Median seconds of one call of each, called in turns so that whatever else runs on the
/// machine slows both; at least 15 calls each and 0.6 s, after a warm-up.
template <class F, class G>
Seconds time_in_turns(F dense, G modes) {
    using Clock = std::chrono::steady_clock;
    const auto time = [](auto f) {
        const auto start = Clock::now();
        f();
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    dense();
    modes();
    std::vector<double> dense_times, modes_times;
    for (double total = 0.0; dense_times.size() < 15 || total < 0.6;) {
        dense_times.push_back(time(dense));
        modes_times.push_back(time(modes));
        total += dense_times.back() + modes_times.back();
    }
    return {median(dense_times), median(modes_times)};
}

/// |a - b| / |b|
double difference(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double diff = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        diff += norm_sq(a[i] - b[i]);
        size += norm_sq(b[i]);
    }
    return std::sqrt(diff / size);
}

/// Prints one row; returns the relative difference of the two products.
double compare(Mix mix, ContactHessian model, int num_pairs) {
    CpuExec exec;
    Pairs pairs;
    build(exec, pairs, mix, model, num_pairs);
    const int n = static_cast<int>(pairs.x.size());
    const View<const Vec3d> c{pairs.c.data(), n};
    std::vector<Vec3d> y_dense(pairs.x.size(), Vec3d{0, 0, 0});
    std::vector<Vec3d> y_modes = y_dense;
    pairs.dense.multiply_add(exec, c, {y_dense.data(), n});
    pairs.low_rank.multiply_add(exec, c, {y_modes.data(), n});
    const double differ = difference(y_dense, y_modes);
    const auto [dense_s, modes_s] = time_in_turns(
        [&] {
            pairs.dense.multiply_add(exec, c, {y_dense.data(), n});
        },
        [&] {
            pairs.low_rank.multiply_add(exec, c, {y_modes.data(), n});
        });
    const double count = pairs.dense.num_pairs();
    const auto dense_bytes = static_cast<double>(pairs.dense.bytes());
    const auto modes_bytes = static_cast<double>(pairs.low_rank_storage);
    std::printf("CPU,%d,%s,%s,%.0f,%.0f,%.0f,%.0f,%.0f,%.3e,%.3e,%.2f,%.1e\n",
                tbb::info::default_concurrency(),
                kMixNames[static_cast<int>(mix)],
                model == ContactHessian::GaussNewton ? "gn" : "gn+",
                count,
                dense_bytes / count,
                modes_bytes / count,
                dense_bytes,
                modes_bytes,
                dense_s,
                modes_s,
                dense_s / modes_s,
                differ);
    std::fflush(stdout);
    return differ;
}

int run(const std::vector<int>& sizes) {
    std::printf(
        "device,threads,pairs of type,hessian,pairs,dense bytes per pair,"
        "low-rank bytes per pair,dense bytes per product,low-rank bytes per "
        "product,dense seconds per product,low-rank seconds per product,"
        "dense / low-rank seconds,relative difference\n");
    double worst = 0.0;
    for (const int num_pairs : sizes)
        for (const auto model :
             {ContactHessian::GaussNewton, ContactHessian::GaussNewtonPlus})
            for (const Mix mix : {Mix::PointPoint,
                                  Mix::PointEdge,
                                  Mix::PointTriangle,
                                  Mix::EdgeEdge,
                                  Mix::Quarter})
                worst = std::max(worst, compare(mix, model, num_pairs));
    return worst < 1e-13 ? 0 : 1;  // else the two did not compute the same thing
}

}  // namespace
}  // namespace noli

int main(int argc, char** argv) {
    std::vector<int> sizes;
    for (int i = 1; i < argc; ++i) {
        const int size = std::atoi(argv[i]);
        if (size < 4) {
            std::fprintf(stderr,
                         "warp_product_bench: \"%s\" is no number of pairs >= 4\n",
                         argv[i]);
            return 2;
        }
        sizes.push_back(size);
    }
    if (sizes.empty()) sizes = {1000, 10000, 100000, 500000};
    return noli::run(sizes);
}
