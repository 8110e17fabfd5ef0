// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the sections of all Gmsh MSH files share: version, encoding, numbers.

#include "mesh/cursor.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace noli::detail {

enum class MshVersion { V22, V40, V41 };

/// A cursor that knows the encoding of the file once it has read the header.
class MshCursor : public Cursor {
  public:
    MshCursor(const std::string& path, std::string_view bytes) : Cursor(path, bytes) {}

    /// The section $MeshFormat; only sections of comments may stand before it.
    void read_format();
    void expect_section_end(const char* name);
    [[nodiscard]] MshVersion version() const { return version_; }
    [[nodiscard]] bool is_binary() const { return binary_; }
    /// Binary data start behind the end of a line.
    void start_binary_data() {
        if (binary_) skip_line();
    }

    // Numbers of the three widths that the format knows.
    std::int64_t read_int(const char* what) {
        return binary_ ? take<std::int32_t>(what) : integer(what);
    }
    std::int64_t read_size(const char* what) {
        if (!binary_) return integer(what);
        if (size_bytes_ == 4) return take<std::uint32_t>(what);
        return take<std::int64_t>(what);
    }
    std::int64_t read_tag(const char* what) {
        return version_ == MshVersion::V41 ? read_size(what) : read_int(what);
    }
    double read_double(const char* what) {
        return binary_ ? checked_finite(take<double>(what), what) : number(what);
    }
    /// Count that binary 2.2 files write as text.
    std::int64_t read_section_count(const char* what) {
        return version_ == MshVersion::V22 ? integer(what) : read_size(what);
    }
    /// Bytes that a tag takes, in ASCII at least.
    [[nodiscard]] std::size_t tag_bytes() const {
        if (!binary_) return 2;
        return version_ == MshVersion::V41 ? static_cast<std::size_t>(size_bytes_) : 4;
    }
    [[nodiscard]] std::size_t node_bytes() const {
        return tag_bytes() + (binary_ ? 24 : 6);
    }

  private:
    void read_byte_order();

    MshVersion version_ = MshVersion::V41;
    bool binary_ = false;
    int size_bytes_ = 8;
};

}  // namespace noli::detail
