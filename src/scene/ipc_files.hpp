// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The mesh files of an IPC script: beside it or, as its authors keep them, in a folder
/// above it.

#include "mesh/mesh.hpp"
#include "scene/ipc_lines.hpp"

#include <map>
#include <optional>
#include <string>

namespace noli {

/// Finds the files that a script names, and reads each of them once.
class ScriptFiles {
  public:
    explicit ScriptFiles(const std::string& script);

    /// The path to write into the scene: relative to the base folder if it lies there.
    /// Throws ScriptFailure, as `load`.
    std::string locate(const std::string& path,
                       const ScriptWords& place,
                       bool folder = false);

    const Mesh& load(const std::string& path, const ScriptWords& place);

    [[nodiscard]] std::string base_folder() const {
        return base_.value_or(script_folder_);
    }

  private:
    std::string named(const std::string& path, const std::string& root);

    std::string script_folder_;
    std::optional<std::string> base_;
    std::map<std::string, Mesh> meshes_;
};

}  // namespace noli
