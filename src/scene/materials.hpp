// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

namespace noli {

/// A named material: typical constants of a real one, to start from.
struct MaterialPreset {
    const char* name;
    double density;  ///< kg/m^3
    double young;    ///< Pa
    double poisson;
    const char* doc;  ///< what it stands for, with the usual range of Young's modulus
};

/// Sources: docs/scene-format.md.
std::span<const MaterialPreset> material_presets();

}  // namespace noli
