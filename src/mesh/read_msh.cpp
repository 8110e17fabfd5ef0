// SPDX-License-Identifier: Apache-2.0
/// Gmsh MSH files. The three versions differ in the headers of sections and blocks and in
/// the binary widths of numbers; ASCII and binary share everything else.
///
///     2.2   $Nodes     N, N x (tag x y z)
///           $Elements  N, N x (tag type #tags tags.. nodes..)        binary: blocks of
///           one type
///     4.0   $Nodes     #blocks N, per block: (entity dim parametric n), n x (tag x y z
///     [u v])
///           $Elements  #blocks N, per block: (entity dim type n), n x (tag nodes..)
///     4.1   $Nodes     #blocks N min max, per block: (dim entity parametric n), n tags,
///     n x (x y z [u v w])
///           $Elements  #blocks N min max, per block: (dim entity type n), n x (tag
///           nodes..)
///
/// Source: Gmsh reference manual, section "MSH file format" and its legacy versions.
#include "mesh/msh_cursor.hpp"
#include "mesh/msh_tags.hpp"
#include "mesh/readers.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace noli::detail {

namespace {

constexpr int kLine = 1, kTriangle = 2, kTet = 4, kPoint = 15;

/// Number of nodes of an element type that is kept, 0 of others.
int nodes_of(int type) {
    switch (type) {
        case kLine:
            return 2;
        case kTriangle:
            return 3;
        case kTet:
            return 4;
        case kPoint:
            return 1;
        default:
            return 0;
    }
}

std::string describe_type(int type) {
    switch (type) {
        case 3:
            return "4-node quadrangles";
        case 5:
            return "8-node hexahedra";
        case 6:
            return "6-node prisms";
        case 7:
            return "5-node pyramids";
        case 8:
            return "second-order lines (3 nodes)";
        case 9:
            return "second-order triangles (6 nodes)";
        case 11:
            return "second-order tetrahedra (10 nodes)";
        default:
            return "elements of another shape or order";
    }
}

class MshReader {
  public:
    MshReader(const std::string& path, std::string_view bytes) : in_(path, bytes) {}

    Mesh read(ReadPart part) {
        in_.read_format();
        for (std::string_view name = in_.token(); !name.empty(); name = in_.token()) {
            if (name == "$Nodes") {
                read_nodes();
                if (part == ReadPart::Positions) return std::move(mesh_);
            } else if (name == "$Elements") {
                read_elements();
            } else if (!skip_section(name)) {
                break;
            }
        }
        if (!have_nodes_ || !have_elements_)
            in_.fail(fmt::format(
                "the file ends without a {} section; it is truncated or holds no "
                "mesh: write it again",
                have_nodes_ ? "$Elements" : "$Nodes"));
        return std::move(mesh_);
    }

  private:
    bool skip_section(std::string_view name);
    void read_nodes();
    void read_node_block();
    void read_node(int index, std::int64_t tag, int num_parameters);
    void read_elements();
    void read_element_block();
    int read_element_run_v22(int total, int done);
    void read_element(int type, std::int64_t tag);
    [[nodiscard]] int find_node(std::int64_t tag, std::int64_t element) const;
    [[nodiscard]] int checked_type(std::int64_t type) const;

    MshCursor in_;
    Mesh mesh_;
    bool have_nodes_ = false, have_elements_ = false;
    std::vector<std::int64_t> node_tags_;
    TagTable table_;
};

bool MshReader::skip_section(std::string_view name) {
    if (name[0] != '$' || name.substr(0, 4) == "$End")
        in_.fail(fmt::format(
            "found {} between sections, expected a line like \"$Nodes\"; a count before "
            "it is wrong: write the file again",
            quoted(name)));
    if (in_.skip_behind(fmt::format("\n$End{}", name.substr(1)))) {
        in_.skip_line();
        return true;
    }
    if (have_nodes_ && have_elements_) return false;  // foreign rest of the file
    in_.fail(
        fmt::format("section {} has no \"$End{}\" line; the file is truncated: write or "
                    "copy it again",
                    quoted(name),
                    name.substr(1)));
}

void MshReader::read_nodes() {
    if (have_nodes_)
        in_.fail("found a second $Nodes section, expected one; merge them in Gmsh");
    if (in_.version() != MshVersion::V22) in_.start_binary_data();
    const std::int64_t blocks =
        in_.version() == MshVersion::V22 ? 1 : in_.read_size("the number of node blocks");
    const int total = in_.checked_count(
        in_.read_section_count("the number of nodes"), in_.node_bytes(), "nodes");
    if (in_.version() == MshVersion::V41) {
        in_.read_size("the smallest node tag");
        in_.read_size("the largest node tag");
    }
    mesh_.x.reserve(static_cast<std::size_t>(total));
    node_tags_.reserve(static_cast<std::size_t>(total));
    if (in_.version() == MshVersion::V22) {
        in_.start_binary_data();
        for (int i = 0; i < total; ++i)
            read_node(i, in_.read_int("a node tag"), 0);
    } else {
        for (std::int64_t b = 0; b < blocks; ++b)
            read_node_block();
    }
    if (mesh_.x.size() != static_cast<std::size_t>(total))
        in_.fail(
            fmt::format("the blocks hold {} nodes, but the section announces {}; write "
                        "the file again",
                        mesh_.x.size(),
                        total));
    in_.expect_section_end("$EndNodes");
    if (const int twice = table_.build(node_tags_); twice >= 0)
        in_.fail(fmt::format(
            "node tag {} occurs twice, expected unique tags; renumber the mesh "
            "(gmsh: Mesh > Renumber) or merge duplicates",
            node_tags_[static_cast<std::size_t>(twice)]));
    have_nodes_ = true;
}

void MshReader::read_node_block() {
    const std::int64_t first = in_.read_int("the entity of a node block");
    const std::int64_t second = in_.read_int("the dimension of a node block");
    const bool parametric = in_.read_int("the parametric flag of a node block") != 0;
    const std::int64_t dim = in_.version() == MshVersion::V41 ? first : second;
    const std::int64_t max_dim = in_.version() == MshVersion::V41 ? 3 : 2;
    const int num_parameters =
        parametric ? static_cast<int>(std::clamp<std::int64_t>(dim, 0, max_dim)) : 0;
    const int count = in_.checked_count(in_.read_size("the number of nodes in a block"),
                                        in_.node_bytes(),
                                        "nodes in a block");
    const std::size_t base = node_tags_.size();
    if (in_.version() == MshVersion::V41)
        for (int i = 0; i < count; ++i)
            node_tags_.push_back(in_.read_tag("a node tag"));
    for (int i = 0; i < count; ++i) {
        const std::size_t index = base + static_cast<std::size_t>(i);
        const std::int64_t tag = in_.version() == MshVersion::V41
                                   ? node_tags_[index]
                                   : in_.read_tag("a node tag");
        read_node(static_cast<int>(index), tag, num_parameters);
    }
}

void MshReader::read_node(int index, std::int64_t tag, int num_parameters) {
    if (static_cast<std::size_t>(index) == node_tags_.size()) node_tags_.push_back(tag);
    const double x = in_.read_double("the x coordinate of a node");
    const double y = in_.read_double("the y coordinate of a node");
    const double z = in_.read_double("the z coordinate of a node");
    mesh_.x.push_back({x, y, z});
    for (int k = 0; k < num_parameters; ++k)
        in_.read_double("a parameter of a node");
}

void MshReader::read_elements() {
    if (!have_nodes_)
        in_.fail(
            "found $Elements before $Nodes, expected nodes first; write the file again");
    if (have_elements_)
        in_.fail("found a second $Elements section, expected one; merge them in Gmsh");
    if (in_.version() != MshVersion::V22) in_.start_binary_data();
    const std::int64_t blocks = in_.version() == MshVersion::V22
                                  ? 0
                                  : in_.read_size("the number of element blocks");
    const int total = in_.checked_count(in_.read_section_count("the number of elements"),
                                        2 * in_.tag_bytes(),
                                        "elements");
    int done = 0;
    if (in_.version() == MshVersion::V22) {
        in_.start_binary_data();
        while (done < total)
            done += read_element_run_v22(total, done);
    } else {
        if (in_.version() == MshVersion::V41) {
            in_.read_size("the smallest element tag");
            in_.read_size("the largest element tag");
        }
        for (std::int64_t b = 0; b < blocks; ++b)
            read_element_block();
    }
    in_.expect_section_end("$EndElements");
    have_elements_ = true;
}

/// One element (ASCII) or one run of elements of one type (binary); returns how many.
int MshReader::read_element_run_v22(int total, int done) {
    std::int64_t tag = in_.is_binary() ? 0 : in_.integer("an element tag");
    const int type = checked_type(in_.read_int("an element type"));
    const std::int64_t count =
        in_.is_binary() ? in_.read_int("the number of elements in a run") : 1;
    const int num_tags = in_.checked_count(
        in_.read_int("the number of tags of an element"), 1, "element tags");
    if (count < 1 || count > total - done)
        in_.fail(fmt::format(
            "found a run of {} elements where at most {} remain; write the file again",
            count,
            total - done));
    for (std::int64_t i = 0; i < count; ++i) {
        if (in_.is_binary()) tag = in_.read_int("an element tag");
        for (int k = 0; k < num_tags; ++k)
            in_.read_int("a tag of an element");
        read_element(type, tag);
    }
    return static_cast<int>(count);
}

void MshReader::read_element_block() {
    in_.read_int("the entity of an element block");
    in_.read_int("the dimension of an element block");
    const int type = checked_type(in_.read_int("the element type of a block"));
    const std::size_t bytes =
        in_.tag_bytes() * (1 + static_cast<std::size_t>(nodes_of(type)));
    const int count = in_.checked_count(
        in_.read_size("the number of elements in a block"), bytes, "elements in a block");
    for (int i = 0; i < count; ++i)
        read_element(type, in_.read_tag("an element tag"));
}

int MshReader::checked_type(std::int64_t type) const {
    if (type < 1 || type > 140)
        in_.fail(
            fmt::format("found element type {}, expected 4 (tetrahedron), 2 (triangle), "
                        "1 (line) or 15 "
                        "(point); the file is damaged: write it again",
                        type));
    if (nodes_of(static_cast<int>(type)) == 0)
        in_.fail(
            fmt::format("found {} (type {}), expected straight-sided tetrahedra, "
                        "triangles and lines; "
                        "mesh again with order 1 and no recombination (gmsh -3 -order 1)",
                        describe_type(static_cast<int>(type)),
                        type));
    return static_cast<int>(type);
}

void MshReader::read_element(int type, std::int64_t tag) {
    int v[4];
    for (int k = 0; k < nodes_of(type); ++k)
        v[k] = find_node(in_.read_tag("a node of an element"), tag);
    if (type == kTet) mesh_.tets.push_back({v[0], v[1], v[2], v[3]});
    if (type == kTriangle) mesh_.triangles.push_back({v[0], v[1], v[2]});
    if (type == kLine) mesh_.segments.push_back({v[0], v[1]});
}

int MshReader::find_node(std::int64_t tag, std::int64_t element) const {
    const int index = table_.find(tag);
    if (index < 0)
        in_.fail(
            fmt::format("element {} uses node {}, which is not among the {} nodes of the "
                        "file; correct "
                        "the element (node tags count from 1) or write the file again",
                        element,
                        tag,
                        node_tags_.size()));
    return index;
}

}  // namespace

Mesh read_msh(const std::string& path, std::string_view bytes, ReadPart part) {
    return MshReader(path, bytes).read(part);
}

}  // namespace noli::detail
