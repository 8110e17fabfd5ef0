// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "mesh/read.hpp"
#include "mesh/write.hpp"

namespace noli {

Status convert_mesh(const std::string& from, const std::string& to) {
    const Result<Mesh> mesh = read_mesh(from);
    if (!mesh) return mesh.error();
    if (std::optional<Error> failed = write_mesh(to, mesh.value())) return *failed;
    return Done{};
}

}  // namespace noli
