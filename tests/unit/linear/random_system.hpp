// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Seeded random operators for the tests of linear/, with their dense counterparts.

#include "exec/cpu.hpp"
#include "linear/block_matrix.hpp"
#include "linear/low_rank.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

namespace noli::test {

/// Element blocks, diagonal and low-rank terms as plain vectors.
struct RandomSystem {
    int num_vertices = 0;
    std::vector<Int4> elements;
    std::vector<double> element_blocks;
    std::vector<double> diagonal;
    std::vector<Int4> term_vertices;
    std::vector<int> first_mode;
    std::vector<Mode> modes;
};

/// Four different vertices; num_vertices must be at least 4.
inline Int4 random_vertices(std::mt19937& rng, int num_vertices, int reach) {
    // Near each other, as in a mesh whose vertices are in a local order.
    std::uniform_int_distribution<int> first(0, num_vertices - 1);
    std::uniform_int_distribution<int> offset(1, reach);
    Int4 v{};
    bool different = false;
    while (!different) {
        v[0] = first(rng);
        for (int k = 1; k < 4; ++k)
            v[k] = (v[0] + offset(rng)) % num_vertices;
        different = v[0] != v[1] && v[0] != v[2] && v[0] != v[3] && v[1] != v[2]
                 && v[1] != v[3] && v[2] != v[3];
    }
    return v;
}

/// A system with SPD element blocks. The last two vertices belong to no element.
inline RandomSystem random_system(int num_vertices,
                                  int num_elements,
                                  int num_terms,
                                  int seed) {
    std::mt19937 rng(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    RandomSystem s;
    s.num_vertices = num_vertices;
    for (int e = 0; e < num_elements; ++e) {
        s.elements.push_back(random_vertices(rng, num_vertices - 2, 6));
        Eigen::Matrix<double, 12, 6> half;
        for (double& h : half.reshaped())
            h = normal(rng);
        const Eigen::Matrix<double, 12, 12> h = half * half.transpose();
        for (int a = 0; a < 4; ++a)
            for (int b = a; b < 4; ++b)
                for (int k = 0; k < 9; ++k)
                    s.element_blocks.push_back(h(3 * a + k / 3, 3 * b + k % 3));
    }
    for (int i = 0; i < num_vertices; ++i)
        s.diagonal.push_back(0.1 + std::abs(normal(rng)));
    s.first_mode.push_back(0);
    for (int t = 0; t < num_terms; ++t) {
        Int4 v = random_vertices(rng, num_vertices, num_vertices - 1);
        const int used = 1 + t % 4;
        for (int k = used; k < 4; ++k)
            v[k] = -1;
        if (t % 7 == 0) std::swap(v[0], v[3]);  // unused slots need not be the last
        s.term_vertices.push_back(v);
        for (int m = 0; m < t % 4; ++m) {
            Mode mode{};
            for (int k = 0; k < 4; ++k)
                if (v[k] >= 0)
                    mode.q[k] = {3 * normal(rng), 3 * normal(rng), 3 * normal(rng)};
            s.modes.push_back(mode);
        }
        s.first_mode.push_back(static_cast<int>(s.modes.size()));
    }
    return s;
}

inline Eigen::MatrixXd dense_elements(const RandomSystem& s) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * s.num_vertices, 3 * s.num_vertices);
    for (std::size_t e = 0; e < s.elements.size(); ++e) {
        const double* block = s.element_blocks.data() + 90 * e;
        for (int a = 0; a < 4; ++a)
            for (int b = a; b < 4; ++b, block += 9) {
                const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> m(
                    block);
                const int i = 3 * s.elements[e][a];
                const int j = 3 * s.elements[e][b];
                dense.block<3, 3>(i, j) += m;
                if (a != b) dense.block<3, 3>(j, i) += m.transpose();
            }
    }
    for (int i = 0; i < s.num_vertices; ++i)
        dense.block<3, 3>(3 * i, 3 * i) +=
            s.diagonal[static_cast<std::size_t>(i)] * Eigen::Matrix3d::Identity();
    return dense;
}

inline Eigen::MatrixXd dense_terms(const RandomSystem& s) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * s.num_vertices, 3 * s.num_vertices);
    for (std::size_t t = 0; t < s.term_vertices.size(); ++t)
        for (int m = s.first_mode[t]; m < s.first_mode[t + 1]; ++m) {
            Eigen::VectorXd q = Eigen::VectorXd::Zero(3 * s.num_vertices);
            for (int k = 0; k < 4; ++k)
                for (int d = 0; d < 3; ++d)
                    if (s.term_vertices[t][k] >= 0)
                        q[3 * s.term_vertices[t][k] + d] +=
                            s.modes[static_cast<std::size_t>(m)].q[k][d];
            dense += q * q.transpose();
        }
    return dense;
}

/// The same system in an executor's memory.
template <class Exec>
struct LoadedSystem {
    BlockMatrix<Exec> matrix;
    LowRankTerms<Exec> terms;
};

template <class T>
View<const T> view_of(const std::vector<T>& v) {
    return {v.data(), static_cast<int>(v.size())};
}
template <class T>
View<T> view_of(std::vector<T>& v) {
    return {v.data(), static_cast<int>(v.size())};
}

template <class Exec>
LoadedSystem<Exec> load(Exec& exec, const RandomSystem& s) {
    LoadedSystem<Exec> out;
    out.matrix.set_pattern(exec,
                           build_block_pattern(s.num_vertices, std::span(s.elements)));
    out.matrix.assemble(exec, view_of(s.element_blocks), view_of(s.diagonal));
    exec.upload(s.term_vertices, out.terms.vertices);
    exec.upload(s.first_mode, out.terms.first_mode);
    exec.upload(s.modes, out.terms.modes);
    out.terms.build_incidence(exec, s.num_vertices);
    return out;
}

inline std::vector<Vec3d> random_vector(int n, int seed) {
    std::mt19937 rng(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    std::vector<Vec3d> v(static_cast<std::size_t>(n));
    for (Vec3d& item : v)
        item = {normal(rng), normal(rng), normal(rng)};
    return v;
}

inline Eigen::VectorXd to_eigen(const std::vector<Vec3d>& v) {
    Eigen::VectorXd out(3 * static_cast<Eigen::Index>(v.size()));
    for (std::size_t i = 0; i < v.size(); ++i)
        for (int k = 0; k < 3; ++k)
            out[3 * static_cast<Eigen::Index>(i) + k] = v[i][k];
    return out;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size()
        && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace noli::test
