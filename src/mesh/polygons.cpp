// SPDX-License-Identifier: Apache-2.0
#include "mesh/readers.hpp"

namespace noli::detail {

namespace {

/// Above this many corners ear clipping, which takes quadratic time or worse, gives way
/// to a fan.
constexpr int kMaxEarClipping = 1024;

/// Works on one polygon; corners that are cut off leave ring_.
class EarClipper {
  public:
    EarClipper(const std::vector<Vec3d>& x, const int* first, int count)
        : x_(x), ring_(first, first + count), normal_{0, 0, 0} {
        for (int i = 0; i < count; ++i)  // Newell: twice the area vector
            normal_ += cross(x_at(i), x_at(i + 1));
    }

    void run(std::vector<Int3>& out) {
        if (ring_.size() == 4) cut(prefers_second_diagonal() ? 0 : 1, out);
        while (ring_.size() > 3 && ring_.size() <= kMaxEarClipping) {
            const int ear = find_ear();
            if (ear < 0) break;
            cut(ear, out);
        }
        for (std::size_t i = 2; i < ring_.size(); ++i)
            out.push_back({ring_[0], ring_[i - 1], ring_[i]});
    }

  private:
    [[nodiscard]] int at(int i) const {
        const int n = static_cast<int>(ring_.size());
        return ring_[static_cast<std::size_t>((i + n) % n)];
    }
    [[nodiscard]] Vec3d x_at(int i) const { return x_[static_cast<std::size_t>(at(i))]; }
    /// Twice the signed area of (a, b, c) seen against the normal, times its length.
    [[nodiscard]] double turn(Vec3d a, Vec3d b, Vec3d c) const {
        return dot(cross(b - a, c - a), normal_);
    }

    [[nodiscard]] bool is_ear(int i) const {
        const Vec3d a = x_at(i - 1), b = x_at(i), c = x_at(i + 1);
        if (turn(a, b, c) <= 0.0) return false;
        for (int k = 2; k + 1 < static_cast<int>(ring_.size()); ++k) {
            const Vec3d p = x_at(i + k);
            if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0)
                return false;
        }
        return true;
    }

    [[nodiscard]] int find_ear() const {
        for (int i = 1; i <= static_cast<int>(ring_.size()); ++i)
            if (is_ear(i)) return i % static_cast<int>(ring_.size());
        return -1;
    }

    /// Of a quad that both diagonals cut well, the shorter one.
    [[nodiscard]] bool prefers_second_diagonal() const {
        const Vec3d a = x_at(0), b = x_at(1), c = x_at(2), d = x_at(3);
        const bool first_is_fine = turn(a, b, c) > 0.0 && turn(a, c, d) > 0.0;
        const bool second_is_fine = turn(b, c, d) > 0.0 && turn(b, d, a) > 0.0;
        if (first_is_fine != second_is_fine) return second_is_fine;
        return second_is_fine && norm_sq(d - b) < norm_sq(c - a);
    }

    void cut(int i, std::vector<Int3>& out) {
        out.push_back({at(i - 1), at(i), at(i + 1)});
        ring_.erase(ring_.begin() + i);
    }

    const std::vector<Vec3d>& x_;
    std::vector<int> ring_;
    Vec3d normal_;
};

}  // namespace

std::vector<Int3> triangulated(const std::vector<Vec3d>& x, const Polygons& polygons) {
    std::vector<Int3> out;
    out.reserve(polygons.corners.size() / 3);
    for (std::size_t p = 0; p + 1 < polygons.first.size(); ++p) {
        const int* corner = polygons.corners.data() + polygons.first[p];
        const int count = polygons.first[p + 1] - polygons.first[p];
        if (count == 3)
            out.push_back({corner[0], corner[1], corner[2]});
        else
            EarClipper(x, corner, count).run(out);
    }
    return out;
}

}  // namespace noli::detail
