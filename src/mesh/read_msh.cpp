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
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
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

/// Node numbers of the file -> indices into Mesh::x.
class TagTable {
  public:
    /// Returns the position of a tag that occurs twice, or -1.
    int build(const std::vector<std::int64_t>& tags) {
        if (tags.empty()) return -1;
        const auto [lo, hi] = std::minmax_element(tags.begin(), tags.end());
        first_ = *lo;
        const std::uint64_t range =
            static_cast<std::uint64_t>(*hi) - static_cast<std::uint64_t>(*lo);
        return range < 4 * tags.size() + 1024 ? build_dense(tags, range + 1)
                                              : build_sparse(tags);
    }

    /// Index of a tag, or -1.
    [[nodiscard]] int find(std::int64_t tag) const {
        if (!dense_.empty()) {
            const std::uint64_t k =
                static_cast<std::uint64_t>(tag) - static_cast<std::uint64_t>(first_);
            return k < dense_.size() ? dense_[k] : -1;
        }
        const auto it =
            std::lower_bound(sparse_.begin(), sparse_.end(), std::pair{tag, 0});
        return it != sparse_.end() && it->first == tag ? it->second : -1;
    }

  private:
    int build_dense(const std::vector<std::int64_t>& tags, std::uint64_t range) {
        dense_.assign(range, -1);
        for (std::size_t i = 0; i < tags.size(); ++i) {
            int& slot = dense_[static_cast<std::uint64_t>(tags[i] - first_)];
            if (slot >= 0) return static_cast<int>(i);
            slot = static_cast<int>(i);
        }
        return -1;
    }

    int build_sparse(const std::vector<std::int64_t>& tags) {
        for (std::size_t i = 0; i < tags.size(); ++i)
            sparse_.emplace_back(tags[i], static_cast<int>(i));
        std::sort(sparse_.begin(), sparse_.end());
        for (std::size_t i = 1; i < sparse_.size(); ++i)
            if (sparse_[i].first == sparse_[i - 1].first) return sparse_[i].second;
        return -1;
    }

    std::int64_t first_ = 0;
    std::vector<int> dense_;
    std::vector<std::pair<std::int64_t, int>> sparse_;
};

class MshReader {
  public:
    MshReader(const std::string& path, std::string_view bytes) : in_(path, bytes) {}

    Mesh read() {
        read_format();
        for (std::string_view name = in_.token(); !name.empty(); name = in_.token()) {
            if (name == "$Nodes") {
                read_nodes();
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
    enum class Version { V22, V40, V41 };

    void read_format();
    void read_byte_order();
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
    void expect_section_end(const char* name);
    void start_binary_data() {
        if (binary_) in_.skip_line();
    }

    // Numbers of the three widths that the format knows.
    std::int64_t read_int(const char* what) {
        return binary_ ? in_.take<std::int32_t>(what) : in_.integer(what);
    }
    std::int64_t read_size(const char* what) {
        if (!binary_) return in_.integer(what);
        if (size_bytes_ == 4) return in_.take<std::uint32_t>(what);
        return in_.take<std::int64_t>(what);
    }
    std::int64_t read_tag(const char* what) {
        return version_ == Version::V41 ? read_size(what) : read_int(what);
    }
    double read_double(const char* what) {
        return binary_ ? in_.checked_finite(in_.take<double>(what), what)
                       : in_.number(what);
    }
    /// Count that binary 2.2 files write as text.
    std::int64_t read_section_count(const char* what) {
        return version_ == Version::V22 ? in_.integer(what) : read_size(what);
    }
    [[nodiscard]] std::size_t tag_bytes() const {
        if (!binary_) return 2;
        return version_ == Version::V41 ? static_cast<std::size_t>(size_bytes_) : 4;
    }
    [[nodiscard]] std::size_t node_bytes() const {
        return tag_bytes() + (binary_ ? 24 : 6);
    }

    Cursor in_;
    Mesh mesh_;
    Version version_ = Version::V41;
    bool binary_ = false;
    int size_bytes_ = 8;
    bool have_nodes_ = false, have_elements_ = false;
    std::vector<std::int64_t> node_tags_;
    TagTable table_;
};

void MshReader::read_format() {
    const std::string_view head = in_.token();
    if (head != "$MeshFormat")
        in_.fail(fmt::format(
            "found {}, expected \"$MeshFormat\"; {}",
            quoted(head),
            head == "$NOD"
                ? "this is version 1: save it as version 4.1 (gmsh -format msh41)"
                : "this is no Gmsh file: check its extension"));
    const std::string_view version = in_.token();
    const std::string shown = quoted(version);
    const bool v2 =
        version == "2.2" || version == "2.1" || version == "2" || version == "2.0";
    if (!v2 && version != "4" && version != "4.0" && version != "4.1")
        in_.fail(fmt::format(
            "found MSH version {}, expected 2.2, 4.0 or 4.1; save the mesh as version "
            "4.1 (gmsh -format msh41)",
            shown));
    version_ = v2 ? Version::V22 : (version == "4.1" ? Version::V41 : Version::V40);
    const std::int64_t type = in_.integer("the file type");
    if (type != 0 && type != 1)
        in_.fail(fmt::format(
            "found file type {}, expected 0 (ASCII) or 1 (binary); write the file again",
            type));
    const std::int64_t size = in_.integer("the data size");
    if (size != 8 && !(size == 4 && version_ == Version::V41))
        in_.fail(fmt::format(
            "found data size {}, expected 8; write the file in double precision", size));
    binary_ = type == 1;
    size_bytes_ = static_cast<int>(size);
    if (binary_) read_byte_order();
    expect_section_end("$EndMeshFormat");
}

void MshReader::read_byte_order() {
    in_.skip_line();
    in_.set_binary(false);
    const auto one = in_.take<std::uint32_t>("the byte-order mark");
    if (one != 1 && one != 0x01000000U)
        in_.fail(
            "the header says binary (file type 1), but no binary number 1 follows it; "
            "the file is "
            "ASCII under a binary flag (set it to 0) or damaged: write it again");
    in_.set_binary(one != 1);
}

void MshReader::expect_section_end(const char* name) {
    const std::string_view found = in_.token();
    if (found.empty()) in_.fail_truncated(name);
    if (found != name)
        in_.fail(fmt::format(
            "found {}, expected \"{}\"; a count in this section is wrong, or the file is "
            "binary under an ASCII flag: write it again",
            quoted(found),
            name));
}

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
    if (version_ != Version::V22) start_binary_data();
    const std::int64_t blocks =
        version_ == Version::V22 ? 1 : read_size("the number of node blocks");
    const int total = in_.checked_count(
        read_section_count("the number of nodes"), node_bytes(), "nodes");
    if (version_ == Version::V41) {
        read_size("the smallest node tag");
        read_size("the largest node tag");
    }
    mesh_.x.reserve(static_cast<std::size_t>(total));
    node_tags_.reserve(static_cast<std::size_t>(total));
    if (version_ == Version::V22) {
        start_binary_data();
        for (int i = 0; i < total; ++i)
            read_node(i, read_int("a node tag"), 0);
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
    expect_section_end("$EndNodes");
    if (const int twice = table_.build(node_tags_); twice >= 0)
        in_.fail(fmt::format(
            "node tag {} occurs twice, expected unique tags; renumber the mesh "
            "(gmsh: Mesh > Renumber) or merge duplicates",
            node_tags_[static_cast<std::size_t>(twice)]));
    have_nodes_ = true;
}

void MshReader::read_node_block() {
    const std::int64_t first = read_int("the entity of a node block");
    const std::int64_t second = read_int("the dimension of a node block");
    const bool parametric = read_int("the parametric flag of a node block") != 0;
    const std::int64_t dim = version_ == Version::V41 ? first : second;
    const std::int64_t max_dim = version_ == Version::V41 ? 3 : 2;
    const int num_parameters =
        parametric ? static_cast<int>(std::clamp<std::int64_t>(dim, 0, max_dim)) : 0;
    const int count = in_.checked_count(
        read_size("the number of nodes in a block"), node_bytes(), "nodes in a block");
    const std::size_t base = node_tags_.size();
    if (version_ == Version::V41)
        for (int i = 0; i < count; ++i)
            node_tags_.push_back(read_tag("a node tag"));
    for (int i = 0; i < count; ++i) {
        const std::size_t index = base + static_cast<std::size_t>(i);
        const std::int64_t tag =
            version_ == Version::V41 ? node_tags_[index] : read_tag("a node tag");
        read_node(static_cast<int>(index), tag, num_parameters);
    }
}

void MshReader::read_node(int index, std::int64_t tag, int num_parameters) {
    if (static_cast<std::size_t>(index) == node_tags_.size()) node_tags_.push_back(tag);
    const double x = read_double("the x coordinate of a node");
    const double y = read_double("the y coordinate of a node");
    const double z = read_double("the z coordinate of a node");
    mesh_.x.push_back({x, y, z});
    for (int k = 0; k < num_parameters; ++k)
        read_double("a parameter of a node");
}

void MshReader::read_elements() {
    if (!have_nodes_)
        in_.fail(
            "found $Elements before $Nodes, expected nodes first; write the file again");
    if (have_elements_)
        in_.fail("found a second $Elements section, expected one; merge them in Gmsh");
    if (version_ != Version::V22) start_binary_data();
    const std::int64_t blocks =
        version_ == Version::V22 ? 0 : read_size("the number of element blocks");
    const int total = in_.checked_count(
        read_section_count("the number of elements"), 2 * tag_bytes(), "elements");
    int done = 0;
    if (version_ == Version::V22) {
        start_binary_data();
        while (done < total)
            done += read_element_run_v22(total, done);
    } else {
        if (version_ == Version::V41) {
            read_size("the smallest element tag");
            read_size("the largest element tag");
        }
        for (std::int64_t b = 0; b < blocks; ++b)
            read_element_block();
    }
    expect_section_end("$EndElements");
    have_elements_ = true;
}

/// One element (ASCII) or one run of elements of one type (binary); returns how many.
int MshReader::read_element_run_v22(int total, int done) {
    std::int64_t tag = binary_ ? 0 : in_.integer("an element tag");
    const int type = checked_type(read_int("an element type"));
    const std::int64_t count = binary_ ? read_int("the number of elements in a run") : 1;
    const int num_tags = in_.checked_count(
        read_int("the number of tags of an element"), 1, "element tags");
    if (count < 1 || count > total - done)
        in_.fail(fmt::format(
            "found a run of {} elements where at most {} remain; write the file again",
            count,
            total - done));
    for (std::int64_t i = 0; i < count; ++i) {
        if (binary_) tag = read_int("an element tag");
        for (int k = 0; k < num_tags; ++k)
            read_int("a tag of an element");
        read_element(type, tag);
    }
    return static_cast<int>(count);
}

void MshReader::read_element_block() {
    read_int("the entity of an element block");
    read_int("the dimension of an element block");
    const int type = checked_type(read_int("the element type of a block"));
    const std::size_t bytes =
        tag_bytes() * (1 + static_cast<std::size_t>(nodes_of(type)));
    const int count = in_.checked_count(
        read_size("the number of elements in a block"), bytes, "elements in a block");
    for (int i = 0; i < count; ++i)
        read_element(type, read_tag("an element tag"));
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
        v[k] = find_node(read_tag("a node of an element"), tag);
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

Mesh read_msh(const std::string& path, std::string_view bytes) {
    return MshReader(path, bytes).read();
}

}  // namespace noli::detail
