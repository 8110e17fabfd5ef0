// SPDX-License-Identifier: Apache-2.0
#include "mesh/read.hpp"

#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"
#include "mesh/topology.hpp"

#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace noli {

namespace {

namespace fs = std::filesystem;
using detail::ReadFailure;
using detail::ReadPart;

std::string lower_extension(const std::string& path) {
    std::string ext = fs::path(path).extension().string();
    for (char& c : ext)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ext;
}

std::string with_extension(const std::string& path, const char* extension) {
    return fs::path(path).replace_extension(extension).string();
}

bool is_file(const std::string& path) {
    std::error_code ec;
    return fs::exists(path, ec);
}

/// .seg and .pt: the file itself, or what the .obj of the same name gives.
Mesh read_codimensional(const std::string& path,
                        bool is_seg,
                        const ReadOptions& options) {
    const std::string obj = with_extension(path, ".obj");
    const bool may_fall_back = options.fall_back_to_obj && is_file(obj);
    Mesh mesh;
    if (is_file(path) || !may_fall_back) {
        const std::string bytes = detail::load_file(path);
        mesh = is_seg ? detail::read_seg(path, bytes) : detail::read_pt(path, bytes);
    }
    if (!mesh.x.empty()) return mesh;
    if (!may_fall_back)
        throw ReadFailure{
            {Error::Code::BadMesh,
             path + ":1",
             fmt::format("found no \"v x y z\" line, expected points{}; fill the file "
                         "or put {} beside it",
                         is_seg ? " and \"s i j\" lines" : "",
                         fs::path(obj).filename().string())}};
    const ReadPart part = options.positions_only ? ReadPart::Positions : ReadPart::All;
    mesh = detail::read_obj(obj, detail::load_file(obj), part);
    if (is_seg) {
        for (const Int2 edge : unique_edges(mesh.triangles))
            mesh.segments.push_back(edge);
    } else {
        mesh.segments.clear();
    }
    mesh.triangles.clear();
    mesh.points.clear();
    return mesh;
}

Mesh read_by_extension(const std::string& path, const ReadOptions& options) {
    const std::string ext = lower_extension(path);
    const ReadPart part = options.positions_only ? ReadPart::Positions : ReadPart::All;
    if (ext == ".seg" || ext == ".pt")
        return read_codimensional(path, ext == ".seg", options);
    if (ext == ".ele" || ext == ".node")
        return detail::read_tetgen(detail::tetgen_files(path), part);
    if (ext == ".msh") return detail::read_msh(path, detail::load_file(path), part);
    if (ext == ".mesh") return detail::read_medit(path, detail::load_file(path), part);
    if (ext == ".obj") return detail::read_obj(path, detail::load_file(path), part);
    if (ext == ".ply") return detail::read_ply(path, detail::load_file(path), part);
    if (ext == ".stl") return detail::read_stl(path, detail::load_file(path));
    // TetGen names its output ball.1.node, ball.1.ele: ".1" is no format.
    if (ext.empty() || is_file(path + ".node") || is_file(path + ".ele"))
        return detail::read_tetgen(detail::tetgen_files(path), part);
    throw ReadFailure{
        {is_file(path) ? Error::Code::BadMesh : Error::Code::FileNotReadable,
         path,
         fmt::format("files ending in {} are not read, expected .msh, .node/.ele, .mesh, "
                     ".obj, .ply, "
                     ".stl, .seg or .pt; convert the mesh, for example with Gmsh",
                     detail::quoted(ext))}};
}

}  // namespace

Result<Mesh> read_mesh(const std::string& path, const ReadOptions& options) {
    try {
        return read_by_extension(path, options);
    } catch (const ReadFailure& failure) {
        return failure.error;
    } catch (const std::bad_alloc&) {
        return Error{
            Error::Code::FileNotReadable,
            path,
            "the mesh does not fit into memory; coarsen it or use a larger machine"};
    }
}

}  // namespace noli
