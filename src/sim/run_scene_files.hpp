// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The files that a scene refers to, and what makes two scenes the same for a resume.

#include "noli/scene.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace noli {

/// Calls `visit` on every path of a mesh file in the scene; it may change it.
void for_each_file(Scene& scene, const std::function<void(std::string&)>& visit);

/// `file` as the scene means it: relative paths start at its base folder. Absolute.
std::string absolute_file(const Scene& scene, const std::string& file);

/// The scene with absolute paths, which means the same wherever its JSON text lies.
Scene with_absolute_files(const Scene& scene);

/// The files there are of a mesh given by its absolute path: itself and those that the
/// mesh reader may look at with it (.node with .ele, the .obj beside a .seg or .pt).
/// Empty if there is none.
std::vector<std::string> companion_files(const std::string& absolute);

/// Hash of all that decides the motion: the scene without its names, duration and output
/// settings, and the content (not the place) of its mesh files. FileNotReadable if one is
/// missing.
Result<std::uint64_t> scene_fingerprint(const Scene& scene);

}  // namespace noli
