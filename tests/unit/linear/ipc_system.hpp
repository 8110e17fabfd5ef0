// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reader of the dumped Newton systems (format IPCSYS01) in
/// NOLI_SHARED_DIR/linear-systems.

#include "core/vec.hpp"

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>
#include <zlib.h>

namespace noli::test {

struct IpcSystem {
    int num_vertices = 0;
    std::vector<Vec3d> rest;
    std::vector<Vec3d> positions;  ///< of this Newton iterate
    std::vector<std::uint8_t> fixed;
    std::vector<Int4> tets;
    std::vector<Int2> couplings;  ///< upper blocks by rows, diagonal included
    std::vector<Mat3d> a;         ///< upper blocks of the whole Hessian
    std::vector<Mat3d> a0;        ///< the same without contact
    std::vector<Vec3d> b, x;      ///< right-hand side and the direct solution
};

namespace detail {

class GzipStream {
  public:
    explicit GzipStream(const std::string& path) : file_(gzopen(path.c_str(), "rb")) {}
    ~GzipStream() {
        if (file_ != nullptr) gzclose(file_);
    }
    GzipStream(const GzipStream&) = delete;
    GzipStream& operator=(const GzipStream&) = delete;

    [[nodiscard]] bool is_open() const { return file_ != nullptr; }
    [[nodiscard]] bool ok() const { return ok_; }
    template <class T>
    std::vector<T> read(std::size_t count) {
        std::vector<T> out(count);
        const auto bytes = static_cast<unsigned>(count * sizeof(T));
        ok_ = ok_ && gzread(file_, out.data(), bytes) == static_cast<int>(bytes);
        return out;
    }

  private:
    gzFile file_;
    bool ok_ = true;
};

}  // namespace detail

/// Nothing when the file is missing or cut short.
inline std::optional<IpcSystem> read_ipc_system(const std::string& name) {
    detail::GzipStream in(std::string(NOLI_SHARED_DIR) + "/linear-systems/" + name
                          + ".bin.gz");
    if (!in.is_open()) return std::nullopt;
    const auto magic = in.read<char>(8);
    const auto header = in.read<std::int32_t>(8);
    in.read<double>(8);
    if (!in.ok() || std::memcmp(magic.data(), "IPCSYS01", 8) != 0) return std::nullopt;
    const auto num_vertices = static_cast<std::size_t>(header[0]);
    const auto num_blocks = static_cast<std::size_t>(header[2]);

    IpcSystem s;
    s.num_vertices = header[0];
    s.rest = in.read<Vec3d>(num_vertices);
    s.positions = in.read<Vec3d>(num_vertices);
    s.fixed = in.read<std::uint8_t>(num_vertices);
    s.tets = in.read<Int4>(static_cast<std::size_t>(header[1]));
    const auto row_begin = in.read<std::int32_t>(num_vertices + 1);
    const auto col = in.read<std::int32_t>(num_blocks);
    s.a = in.read<Mat3d>(num_blocks);
    s.a0 = in.read<Mat3d>(num_blocks);
    s.b = in.read<Vec3d>(num_vertices);
    s.x = in.read<Vec3d>(num_vertices);
    if (!in.ok()) return std::nullopt;
    for (int i = 0; i < s.num_vertices; ++i)
        for (int k = row_begin[static_cast<std::size_t>(i)];
             k < row_begin[static_cast<std::size_t>(i) + 1];
             ++k)
            s.couplings.push_back({{i, col[static_cast<std::size_t>(k)]}});
    return s;
}

}  // namespace noli::test
