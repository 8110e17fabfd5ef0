# SPDX-License-Identifier: Apache-2.0
"""The scene of tables 1-5: soft rings and balls thrown onto a heap. The paper's own (its Fig. 10) is not
available; this one has its parameters (density 1e3, nu 0.49, dt 0.01, dhat 1e-3, no friction) and, at
full size, about its numbers of vertices, tetrahedra and surface triangles (32k, 135k, 38k)."""
import study_scenes

EDGE_LENGTH = {"small": 0.1, "reduced": 0.08, "full": 0.033}


def soft_drop(young, size, dt=0.01):
    bodies = []
    for layer in range(2):
        for k in range(4):
            at = (0.36 * (k % 2 * 2 - 1) + 0.06 * layer, 0.36 + 0.72 * layer, 0.36 * (k // 2 * 2 - 1))
            tilt = (20 * k - 30, 15 * layer, 25 - 18 * k)
            if (k + layer) % 2:
                bodies.append(study_scenes.body(
                    f"ball{layer}{k}", "sphere", at, tilt, young, velocity=(0, -3, 0), poisson=0.49,
                    radius=0.3, edge_length=EDGE_LENGTH[size]))
            else:
                bodies.append(study_scenes.body(
                    f"ring{layer}{k}", "torus", at, tilt, young, velocity=(0, -3, 0), poisson=0.49,
                    major_radius=0.22, minor_radius=0.1, edge_length=EDGE_LENGTH[size]))
    return study_scenes.scene(f"soft drop {young:g} {size}", bodies, dt=dt)
