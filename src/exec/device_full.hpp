// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What an executor throws when the memory of its device does not suffice.

#include <cstddef>
#include <cstdio>
#include <new>
#include <string>

namespace noli {

/// 1234567890 -> "1177.4 MB"
inline std::string megabytes(std::size_t bytes) {
    char text[32];
    std::snprintf(
        text, sizeof text, "%.1f MB", static_cast<double>(bytes) / (1024.0 * 1024.0));
    return text;
}

class DeviceFull : public std::bad_alloc {
  public:
    DeviceFull(std::size_t asked, std::size_t free, std::size_t total)
        : message_("not enough memory on the device: " + megabytes(asked) + " asked for, "
                   + megabytes(free) + " of " + megabytes(total) + " free") {}
    [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }

  private:
    std::string message_;
};

}  // namespace noli
