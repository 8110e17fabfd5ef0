// SPDX-License-Identifier: Apache-2.0
#include "output/vtu.hpp"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <span>
#include <stdexcept>
#include <zlib.h>

namespace noli {

namespace {

/// VTK's numbers.
enum class CellType : std::uint8_t { Point = 1, Segment = 3, Triangle = 5, Tet = 10 };

template <class T>
std::string_view bytes_of(std::span<const T> values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}
template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return bytes_of(std::span<const T>(values));
}

/// A DataArray; `attributes` holds type, name and number of components.
std::string data_array(std::string_view attributes, std::string_view bytes) {
    return fmt::format(
        "        <DataArray {} format=\"binary\">\n{}\n        </DataArray>\n",
        attributes,
        encode_vtk_blocks(bytes));
}

std::string vector_array(std::string_view name, std::span<const Vector3> values) {
    return data_array(
        fmt::format("type=\"Float64\" Name=\"{}\" NumberOfComponents=\"3\"", name),
        bytes_of(values));
}

std::string compress_block(std::string_view block) {
    uLongf size = compressBound(static_cast<uLong>(block.size()));
    std::string out(size, '\0');
    // Level 1: higher levels gain a few per cent on doubles and cost several times as
    // much.
    const int status = compress2(reinterpret_cast<Bytef*>(out.data()),
                                 &size,
                                 reinterpret_cast<const Bytef*>(block.data()),
                                 static_cast<uLong>(block.size()),
                                 1);
    if (status != Z_OK) throw std::bad_alloc();  // the only way compress2 can fail here
    out.resize(size);
    return out;
}

/// Upper triangle in VTK's order of a symmetric tensor: XX YY ZZ XY YZ XZ.
std::vector<std::array<double, 6>> symmetric(
    std::span<const std::array<double, 9>> stress, size_t num_cells) {
    std::vector<std::array<double, 6>> out(num_cells, std::array<double, 6>{});
    for (size_t i = 0; i < stress.size(); ++i) {
        const auto& s = stress[i];
        out[i] = {s[0], s[4], s[8], s[1], s[5], s[2]};
    }
    return out;
}

/// Cells in the making: VTK wants one list of corners, where each cell's ends, and its
/// type.
struct CellLists {
    std::vector<std::int32_t> corners, ends, body;
    std::vector<std::uint8_t> types;

    template <class Corners>
    void add(const Corners& cell, CellType type, std::span<const int> body_of_vertex) {
        corners.insert(corners.end(), std::begin(cell), std::end(cell));
        ends.push_back(static_cast<std::int32_t>(corners.size()));
        types.push_back(static_cast<std::uint8_t>(type));
        body.push_back(body_of_vertex[static_cast<size_t>(*std::begin(cell))]);
    }
};

CellLists list_cells(const FrameMesh& mesh) {
    CellLists cells;
    for (const auto& tet : mesh.tets)
        cells.add(tet, CellType::Tet, mesh.body_of_vertex);
    const std::vector<bool> elastic = elastic_bodies(mesh);
    for (const auto& triangle : mesh.triangles) {
        const int body = mesh.body_of_vertex[static_cast<size_t>(triangle[0])];
        if (!elastic[static_cast<size_t>(body)])
            cells.add(triangle, CellType::Triangle, mesh.body_of_vertex);
    }
    for (const auto& segment : mesh.segments)
        cells.add(segment, CellType::Segment, mesh.body_of_vertex);
    for (const int point : lone_points(mesh))
        cells.add(std::array<int, 1>{point}, CellType::Point, mesh.body_of_vertex);
    return cells;
}

}  // namespace

std::string encode_base64(std::string_view bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t left = std::min<size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (size_t k = 0; k < 3; ++k)
            group =
                group << 8 | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            out += k <= left ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
    }
    return out;
}

std::string encode_vtk_blocks(std::string_view bytes) {
    constexpr size_t kBlock = size_t{1} << 18;
    std::string data;
    std::vector<std::uint64_t> header{0, kBlock, bytes.size() % kBlock};
    for (size_t at = 0; at < bytes.size(); at += kBlock) {
        const std::string block = compress_block(bytes.substr(at, kBlock));
        header.push_back(block.size());
        data += block;
    }
    header[0] = header.size() - 3;
    return encode_base64(bytes_of(header)) + encode_base64(data);
}

VtuWriter::VtuWriter(const FrameMesh& mesh) : mesh_(mesh) {
    const CellLists cells = list_cells(mesh);
    num_cells_ = static_cast<int>(cells.types.size());
    cells_ = "      <Cells>\n"
           + data_array("type=\"Int32\" Name=\"connectivity\"", bytes_of(cells.corners))
           + data_array("type=\"Int32\" Name=\"offsets\"", bytes_of(cells.ends))
           + data_array("type=\"UInt8\" Name=\"types\"", bytes_of(cells.types))
           + "      </Cells>\n";
    const std::string body_id = "type=\"Int32\" Name=\"body_id\"";
    cell_body_id_ = data_array(body_id, bytes_of(cells.body));
    point_body_id_ = data_array(body_id, bytes_of(mesh.body_of_vertex));
}

std::string VtuWriter::point_data(const Frame& frame) const {
    std::string out = "      <PointData Vectors=\"velocity\">\n";
    if (!frame.velocities.empty()) out += vector_array("velocity", frame.velocities);
    if (!frame.contact_force.empty())
        out += vector_array("contact_force", frame.contact_force);
    if (mesh_.initial_positions.size() == frame.positions.size()) {
        std::vector<Vector3> displacement(frame.positions.size());
        for (size_t i = 0; i < displacement.size(); ++i)
            for (size_t k = 0; k < 3; ++k)
                displacement[i][k] =
                    frame.positions[i][k] - mesh_.initial_positions[i][k];
        out += vector_array("displacement", displacement);
    }
    return out + point_body_id_ + "      </PointData>\n";
}

std::string VtuWriter::cell_data(const Frame& frame) const {
    const auto num_cells = static_cast<size_t>(num_cells_);
    std::string out = "      <CellData>\n";
    if (!frame.stress.empty())
        out += data_array(
            "type=\"Float64\" Name=\"stress\" NumberOfComponents=\"6\" "
            "ComponentName0=\"XX\" ComponentName1=\"YY\" ComponentName2=\"ZZ\" "
            "ComponentName3=\"XY\" ComponentName4=\"YZ\" ComponentName5=\"XZ\"",
            bytes_of(symmetric(frame.stress, num_cells)));
    if (!frame.von_mises.empty()) {
        std::vector<double> von_mises(frame.von_mises.begin(), frame.von_mises.end());
        von_mises.resize(num_cells, 0.0);
        out += data_array("type=\"Float64\" Name=\"von_mises\"", bytes_of(von_mises));
    }
    return out + cell_body_id_ + "      </CellData>\n";
}

std::string VtuWriter::encode(const Frame& frame) const {
    std::string out = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
        "  <UnstructuredGrid>\n"
        "    <FieldData>\n"
        "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
        "format=\"ascii\">{:.17g}</DataArray>\n"
        "    </FieldData>\n"
        "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
        frame.time,
        frame.positions.size(),
        num_cells_);
    out += point_data(frame) + cell_data(frame);
    out += "      <Points>\n" + vector_array("Points", frame.positions)
         + "      </Points>\n" + cells_;
    return out + "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
}

std::string encode_pvd(const std::vector<PvdEntry>& entries) {
    std::string out =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
        "  <Collection>\n";
    for (const PvdEntry& entry : entries)
        out += fmt::format("    <DataSet timestep=\"{:.17g}\" part=\"0\" file=\"{}\"/>\n",
                           entry.time,
                           entry.file);
    return out + "  </Collection>\n</VTKFile>\n";
}

}  // namespace noli
