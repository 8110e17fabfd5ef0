// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scripts of the field's CPU reference program (.txt), converted into scenes.

#include "noli/scene.hpp"

#include <string>
#include <vector>

namespace noli {

/// Reads the script at `path`. Sizes, shifts and placements are baked into the transforms
/// of the bodies, scripted animations into boundary conditions, so the scene needs none
/// of the script's own notions. Keywords that only concern viewing or the other program's
/// solver give a warning. Errors: InvalidScene (bad line), FileNotReadable (missing
/// script or mesh), BadMesh, Unsupported (a feature that is missing here, by name), each
/// with file:line.
Result<Scene> read_ipc_script(const std::string& path,
                              std::vector<SceneWarning>* warnings);

}  // namespace noli
