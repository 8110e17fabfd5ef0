// SPDX-License-Identifier: Apache-2.0
#include "scene/materials.hpp"

#include <array>

namespace noli {

namespace {

// Rubber-like materials are nearly incompressible (0.4999); 0.49 keeps linear tetrahedra
// from locking.
constexpr std::array kPresets{
    MaterialPreset{
        "soft_tissue", 1050, 1e4, 0.45, "muscle, liver, fat at rest; 1 to 50 kPa"},
    MaterialPreset{"gelatin", 1050, 5e4, 0.45, "gelatin of about 10 %; 20 to 120 kPa"},
    MaterialPreset{"soft_silicone",
                   1070,
                   7e4,
                   0.48,
                   "casting silicone of Shore 00-30; 50 to 125 kPa"},
    MaterialPreset{"foam", 40, 1e5, 0.3, "flexible polyurethane foam; 0.03 to 1 MPa"},
    MaterialPreset{"silicone", 970, 2e6, 0.48, "PDMS (Sylgard 184); 1.3 to 3 MPa"},
    MaterialPreset{"rubber", 950, 2e6, 0.49, "natural rubber, unfilled; 1 to 5 MPa"},
    MaterialPreset{"cork", 180, 2.5e7, 0.1, "cork; 13 to 50 MPa"},
    MaterialPreset{"polyethylene", 950, 8e8, 0.42, "polyethylene; 0.6 to 0.9 GPa"},
    MaterialPreset{"abs", 1050, 2.2e9, 0.37, "ABS plastic; 1.1 to 2.9 GPa"},
    MaterialPreset{
        "wood", 500, 1e10, 0.35, "pine along the grain, taken as isotropic; 6 to 20 GPa"},
    MaterialPreset{"concrete", 2400, 3e10, 0.2, "concrete; 25 to 38 GPa"},
    MaterialPreset{"glass", 2500, 7e10, 0.22, "soda-lime glass; 68 to 72 GPa"},
    MaterialPreset{"aluminium", 2700, 7e10, 0.33, "aluminium alloys; 68 to 82 GPa"},
    MaterialPreset{"steel", 7850, 2.1e11, 0.29, "carbon steel; 200 to 216 GPa"},
};

}  // namespace

std::span<const MaterialPreset> material_presets() {
    return kPresets;
}

}  // namespace noli
