// SPDX-License-Identifier: Apache-2.0
#include "mesh/msh_cursor.hpp"

#include <fmt/format.h>

namespace noli::detail {

void MshCursor::read_format() {
    std::string_view head = token();
    while (head.substr(0, 1) == "$" && head != "$MeshFormat"
           && skip_behind(fmt::format("\n$End{}", head.substr(1)))) {
        skip_line();
        head = token();
    }
    if (head != "$MeshFormat")
        fail(fmt::format(
            "found {}, expected \"$MeshFormat\"; {}",
            quoted(head),
            head == "$NOD"
                ? "this is version 1: save it as version 4.1 (gmsh -format msh41)"
                : "this is no Gmsh file: check its extension"));
    const std::string_view version = token();
    const std::string shown = quoted(version);
    const bool v2 =
        version == "2.2" || version == "2.1" || version == "2" || version == "2.0";
    if (!v2 && version != "4" && version != "4.0" && version != "4.1")
        fail(fmt::format(
            "found MSH version {}, expected 2.2, 4.0 or 4.1; save the mesh as version "
            "4.1 (gmsh -format msh41)",
            shown));
    version_ =
        v2 ? MshVersion::V22 : (version == "4.1" ? MshVersion::V41 : MshVersion::V40);
    const std::int64_t type = integer("the file type");
    if (type != 0 && type != 1)
        fail(fmt::format(
            "found file type {}, expected 0 (ASCII) or 1 (binary); write the file again",
            type));
    const std::int64_t size = integer("the data size");
    if (size != 8 && !(size == 4 && version_ == MshVersion::V41))
        fail(fmt::format(
            "found data size {}, expected 8; write the file in double precision", size));
    binary_ = type == 1;
    size_bytes_ = static_cast<int>(size);
    if (binary_) read_byte_order();
    expect_section_end("$EndMeshFormat");
}

void MshCursor::read_byte_order() {
    skip_line();
    set_binary(false);
    const auto one = take<std::uint32_t>("the byte-order mark");
    if (one != 1 && one != 0x01000000U)
        fail(
            "the header says binary (file type 1), but no binary number 1 follows it; "
            "the file is "
            "ASCII under a binary flag (set it to 0) or damaged: write it again");
    set_binary(one != 1);
}

void MshCursor::expect_section_end(const char* name) {
    const std::string_view found = token();
    if (found.empty()) fail_truncated(name);
    if (found != name)
        fail(fmt::format(
            "found {}, expected \"{}\"; a count in this section is wrong, or the file is "
            "binary under an ASCII flag: write it again",
            quoted(found),
            name));
}

}  // namespace noli::detail
