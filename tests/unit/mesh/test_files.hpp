// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small files for the tests of the mesh room.

#include "mesh/mesh.hpp"
#include "mesh/read.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace noli::test {

/// A folder that lives as long as the object.
class TempFolder {
  public:
    TempFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path()
              / ("noli_mesh_" + std::to_string(getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TempFolder() { std::filesystem::remove_all(path_); }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    [[nodiscard]] std::string path() const { return path_.string(); }
    std::string operator/(const std::string& name) const {
        return (path_ / name).string();
    }
    std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(*this / name, std::ios::binary) << bytes;
        return *this / name;
    }

  private:
    std::filesystem::path path_;
};

/// Binary files, value by value.
class Bytes {
  public:
    explicit Bytes(bool big_endian = false) : swap_(big_endian) {}
    Bytes& text(const std::string& s) {
        out += s;
        return *this;
    }
    template <class T>
    Bytes& put(T value) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        if (swap_) std::reverse(raw, raw + sizeof(T));
        out.append(raw, sizeof(T));
        return *this;
    }
    std::string out;

  private:
    bool swap_;
};

/// Reads a file that must be fine.
inline Mesh read_fine(const std::string& path, const ReadOptions& options = {}) {
    Result<Mesh> mesh = read_mesh(path, options);
    if (!mesh) {
        ADD_FAILURE() << mesh.error().where << ": " << mesh.error().message;
        return {};
    }
    return std::move(mesh.value());
}

inline bool same_points(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    return a.size() == b.size()
        && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3d)) == 0);
}

inline void expect_same(const Mesh& a, const Mesh& b) {
    EXPECT_TRUE(same_points(a.x, b.x));
    EXPECT_EQ(a.tets, b.tets);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.segments, b.segments);
}

/// One tetrahedron at the corner of the unit cube, as most tests expect it.
inline Mesh corner_tet() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}, {}};
}

}  // namespace noli::test
