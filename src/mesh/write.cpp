// SPDX-License-Identifier: Apache-2.0
#include "mesh/write.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace noli {

namespace {

static_assert(std::endian::native == std::endian::little,
              "binary writers copy native bytes");

/// Text and native bytes of one file.
class Sink {
  public:
    template <class... Args>
    void text(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
    }
    template <class T>
    void bytes(T value) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        out_.append(raw, sizeof(T));
    }
    void point(const Vec3d& x, bool binary) {
        if (!binary) {
            text("{} {} {}\n", x.x, x.y, x.z);
            return;
        }
        for (int k = 0; k < 3; ++k)
            bytes(x[k]);
    }
    [[nodiscard]] const std::string& str() const { return out_; }

  private:
    std::string out_;
};

std::optional<Error> store(const std::string& path, const Sink& sink) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(sink.str().data(), static_cast<std::streamsize>(sink.str().size()));
    file.close();
    if (file) return std::nullopt;
    return Error{Error::Code::FileNotReadable,
                 path,
                 fmt::format("the file cannot be written ({}); check that its folder "
                             "exists, may be written to "
                             "and has room",
                             std::strerror(errno))};
}

/// Calls f(gmsh type, dimension, elements) for each kind of element the mesh has.
template <class F>
void for_each_kind(const Mesh& mesh, F f) {
    if (!mesh.segments.empty()) f(1, 1, mesh.segments);
    if (!mesh.triangles.empty()) f(2, 2, mesh.triangles);
    if (!mesh.tets.empty()) f(4, 3, mesh.tets);
}

std::size_t num_elements(const Mesh& mesh) {
    return mesh.segments.size() + mesh.triangles.size() + mesh.tets.size();
}

Sink msh41(const Mesh& mesh, bool binary) {
    Sink out;
    const auto ints = [&](int a, int b, int c) {
        if (!binary) return out.text("{} {} {} ", a, b, c);
        for (const int v : {a, b, c})
            out.bytes<std::int32_t>(v);
    };
    const auto size = [&](std::uint64_t v, char after) {
        binary ? out.bytes(v) : out.text("{}{}", v, after);
    };
    const auto header = [&](std::uint64_t blocks, std::uint64_t count) {
        size(blocks, ' ');
        size(count, ' ');
        size(count > 0 ? 1 : 0, ' ');
        size(count, '\n');
    };
    out.text("$MeshFormat\n4.1 {} 8\n", binary ? 1 : 0);
    if (binary) {
        out.bytes<std::int32_t>(1);
        out.text("\n");
    }
    out.text("$EndMeshFormat\n$Nodes\n");
    const int dim = mesh.tets.empty() ? (mesh.triangles.empty() ? 1 : 2) : 3;
    header(1, mesh.x.size());
    ints(dim, 1, 0);
    size(mesh.x.size(), '\n');
    for (std::size_t i = 1; i <= mesh.x.size(); ++i)
        size(i, '\n');
    for (const Vec3d& x : mesh.x)
        out.point(x, binary);
    out.text("{}$EndNodes\n$Elements\n", binary ? "\n" : "");
    std::uint64_t blocks = 0, tag = 0;
    for_each_kind(mesh, [&](int, int, const auto&) { ++blocks; });
    header(blocks, num_elements(mesh));
    for_each_kind(mesh, [&](int type, int dimension, const auto& elements) {
        ints(dimension, 1, type);
        size(elements.size(), '\n');
        for (const auto& e : elements) {
            size(++tag, ' ');
            for (const int& v : e.v)
                size(static_cast<std::uint64_t>(v) + 1,
                     &v == std::end(e.v) - 1 ? '\n' : ' ');
        }
    });
    out.text("{}$EndElements\n", binary ? "\n" : "");
    return out;
}

Sink msh22(const Mesh& mesh, bool binary) {
    Sink out;
    const auto number = [&](std::size_t v, char after) {
        binary ? out.bytes(static_cast<std::int32_t>(v)) : out.text("{}{}", v, after);
    };
    out.text("$MeshFormat\n2.2 {} 8\n", binary ? 1 : 0);
    if (binary) {
        out.bytes<std::int32_t>(1);
        out.text("\n");
    }
    out.text("$EndMeshFormat\n$Nodes\n{}\n", mesh.x.size());
    for (std::size_t i = 0; i < mesh.x.size(); ++i) {
        number(i + 1, ' ');
        out.point(mesh.x[i], binary);
    }
    out.text("{}$EndNodes\n$Elements\n{}\n", binary ? "\n" : "", num_elements(mesh));
    std::size_t tag = 0;
    for_each_kind(mesh, [&](int type, int, const auto& elements) {
        if (binary)  // one run of elements of this type, with the two customary tags
            for (const std::size_t v :
                 {static_cast<std::size_t>(type), elements.size(), std::size_t{2}})
                number(v, ' ');
        for (const auto& e : elements) {
            number(++tag, ' ');
            if (!binary) out.text("{} 2 ", type);
            number(1, ' ');
            number(1, ' ');
            for (const int& v : e.v)
                number(static_cast<std::size_t>(v) + 1,
                       &v == std::end(e.v) - 1 ? '\n' : ' ');
        }
    });
    out.text("{}$EndElements\n", binary ? "\n" : "");
    return out;
}

Sink obj(const Mesh& mesh) {
    Sink out;
    for (const Vec3d& x : mesh.x)
        out.text("v {} {} {}\n", x.x, x.y, x.z);
    for (const Int3& t : mesh.triangles)
        out.text("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    for (const Int2& s : mesh.segments)
        out.text("l {} {}\n", s[0] + 1, s[1] + 1);
    for (const int v : mesh.points)
        out.text("p {}\n", v + 1);
    return out;
}

Sink ply(const Mesh& mesh, bool binary) {
    Sink out;
    out.text("ply\nformat {} 1.0\nelement vertex {}\n",
             binary ? "binary_little_endian" : "ascii",
             mesh.x.size());
    out.text("property double x\nproperty double y\nproperty double z\n");
    out.text("element face {}\nproperty list uchar int vertex_indices\n",
             mesh.triangles.size());
    if (!mesh.segments.empty())
        out.text("element edge {}\nproperty int vertex1\nproperty int vertex2\n",
                 mesh.segments.size());
    out.text("end_header\n");
    for (const Vec3d& x : mesh.x)
        out.point(x, binary);
    for (const Int3& t : mesh.triangles) {
        if (!binary) {
            out.text("3 {} {} {}\n", t[0], t[1], t[2]);
            continue;
        }
        out.bytes<std::uint8_t>(3);
        for (const int v : t.v)
            out.bytes<std::int32_t>(v);
    }
    for (const Int2& s : mesh.segments) {
        if (binary) {
            out.bytes<std::int32_t>(s[0]);
            out.bytes<std::int32_t>(s[1]);
        } else {
            out.text("{} {}\n", s[0], s[1]);
        }
    }
    return out;
}

Sink stl(const Mesh& mesh) {
    Sink out;
    out.text("solid mesh\n");
    for (const Int3& t : mesh.triangles) {
        const auto at = [&](int k) { return mesh.x[static_cast<std::size_t>(t[k])]; };
        const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
        const double length = norm(n);
        const Vec3d unit = length > 0.0 ? (1.0 / length) * n : Vec3d{0, 0, 0};
        out.text("facet normal {} {} {}\nouter loop\n", unit.x, unit.y, unit.z);
        for (int k = 0; k < 3; ++k)
            out.text("vertex {} {} {}\n", at(k).x, at(k).y, at(k).z);
        out.text("endloop\nendfacet\n");
    }
    out.text("endsolid mesh\n");
    return out;
}

Sink medit(const Mesh& mesh) {
    Sink out;
    out.text("MeshVersionFormatted 2\nDimension 3\nVertices\n{}\n", mesh.x.size());
    for (const Vec3d& x : mesh.x)
        out.text("{} {} {} 0\n", x.x, x.y, x.z);
    for_each_kind(mesh, [&](int type, int, const auto& elements) {
        out.text("{}\n{}\n",
                 type == 4 ? "Tetrahedra" : (type == 2 ? "Triangles" : "Edges"),
                 elements.size());
        for (const auto& e : elements) {
            for (const int v : e.v)
                out.text("{} ", v + 1);
            out.text("0\n");
        }
    });
    out.text("End\n");
    return out;
}

Sink tetgen_node(const Mesh& mesh) {
    Sink out;
    out.text("{} 3 0 0\n", mesh.x.size());
    for (std::size_t i = 0; i < mesh.x.size(); ++i)
        out.text("{} {} {} {}\n", i + 1, mesh.x[i].x, mesh.x[i].y, mesh.x[i].z);
    return out;
}

Sink tetgen_ele(const Mesh& mesh) {
    Sink out;
    out.text("{} 4 0\n", mesh.tets.size());
    for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
        const Int4& t = mesh.tets[i];
        out.text("{} {} {} {} {}\n", i + 1, t[0] + 1, t[1] + 1, t[2] + 1, t[3] + 1);
    }
    return out;
}

/// .seg, or .pt without the segments.
Sink lines(const Mesh& mesh, bool with_segments) {
    Sink out;
    for (const Vec3d& x : mesh.x)
        out.text("v {} {} {}\n", x.x, x.y, x.z);
    if (with_segments)
        for (const Int2& s : mesh.segments)
            out.text("s {} {}\n", s[0] + 1, s[1] + 1);
    return out;
}

std::optional<Error> refuse(const std::string& path,
                            const char* found,
                            const char* cure) {
    return Error{Error::Code::BadMesh,
                 path,
                 fmt::format("this format cannot hold {}; {}", found, cure)};
}

/// What the format would lose; silently dropping elements would be worse than an error.
std::optional<Error> check_format(const std::string& path,
                                  const std::string& ext,
                                  const Mesh& mesh) {
    const bool holds_tets =
        ext == ".msh" || ext == ".mesh" || ext == ".node" || ext == ".ele";
    if (!holds_tets && !mesh.tets.empty())
        return refuse(path,
                      "tetrahedra",
                      "write .msh, .mesh or .node/.ele, or only the boundary triangles");
    const bool holds_triangles = ext == ".msh" || ext == ".mesh" || ext == ".obj"
                              || ext == ".ply" || ext == ".stl";
    if (!holds_triangles && !mesh.triangles.empty())
        return refuse(path, "triangles", "write .obj, .ply, .stl, .msh or .mesh");
    const bool holds_segments = ext == ".msh" || ext == ".mesh" || ext == ".obj"
                             || ext == ".ply" || ext == ".seg";
    if (!holds_segments && !mesh.segments.empty())
        return refuse(path, "segments", "write .seg, .obj, .ply, .msh or .mesh");
    if (ext != ".obj" && !mesh.points.empty())
        return refuse(path, "points beside other elements", "write .obj");
    return std::nullopt;
}

}  // namespace

std::optional<Error> write_mesh(const std::string& path,
                                const Mesh& mesh,
                                const WriteOptions& options) {
    namespace fs = std::filesystem;
    std::string ext = fs::path(path).extension().string();
    for (char& c : ext)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    auto refused = check_format(path, ext, mesh);
    if (refused) return refused;
    if (ext == ".msh")
        return store(path,
                     options.msh == WriteOptions::Msh::V41 ? msh41(mesh, options.binary)
                                                           : msh22(mesh, options.binary));
    if (ext == ".mesh") return store(path, medit(mesh));
    if (ext == ".obj") return store(path, obj(mesh));
    if (ext == ".ply") return store(path, ply(mesh, options.binary));
    if (ext == ".stl") return store(path, stl(mesh));
    if (ext == ".seg" || ext == ".pt") return store(path, lines(mesh, ext == ".seg"));
    if (ext == ".node" || ext == ".ele") {
        const auto failed =
            store(fs::path(path).replace_extension(".node").string(), tetgen_node(mesh));
        return failed ? failed
                      : store(fs::path(path).replace_extension(".ele").string(),
                              tetgen_ele(mesh));
    }
    return refuse(path,
                  "any mesh",
                  "end the name in .msh, .mesh, .node, .obj, .ply, .stl, .seg or .pt");
}

}  // namespace noli
