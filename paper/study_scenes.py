# SPDX-License-Identifier: Apache-2.0
"""The scenes of the Newton-count study: native ones from the generators, and scripts of the field.

SCENES maps a name to (maker, steps, class); maker(noli) gives a scene or None if its files are missing.
"""
from runs import script_scene


def body(name, generator, at=(0, 0, 0), rotate=(0, 0, 0), young=1e5, velocity=None, density=1000,
         boundary=None, poisson=0.4, **mesh):
    out = {"name": name, "mesh": {"generator": generator, **mesh},
           "transform": {"rotate_deg": list(rotate), "translate": list(at)},
           "material": {"young": young, "poisson": poisson, "density": density}}
    if velocity:
        out["velocity"] = list(velocity)
    if boundary:
        out["boundary"] = boundary
    return out


def scene(name, bodies, dt=0.02, floor=True, gravity=True, friction=0.0):
    out = {"format_version": 1, "name": name, "dt": dt, "duration": 1000 * dt, "bodies": bodies}
    if floor:
        out["half_spaces"] = [{"name": "floor", "friction": friction}]
    if not gravity:
        out["gravity"] = [0, 0, 0]
    return out


def stack(young, cells=1):
    boxes = [body(f"box{k}", "box", (0, 0.51 + 1.01 * k, 0), (0, 7 * k, 0), young,
                  cells=[cells] * 3) for k in range(5)]
    return scene(f"stack {young:g}", boxes, dt=0.025)


def heavy_top():
    boxes = [body("light", "box", (0, 0.51, 0), cells=[2, 2, 2]),
             body("heavy", "box", (0.1, 1.53, 0.05), (0, 20, 0), young=1e6, density=20000,
                  cells=[2, 2, 2])]
    return scene("heavy on light", boxes)


def drop(young):
    rings = [body(f"ring{k}", "torus", (0.1 * k, 0.4 + 0.45 * k, 0), (10 * k, 0, 15 * k), young,
                  major_radius=0.3, minor_radius=0.12, edge_length=0.09) for k in range(3)]
    return scene(f"rings {young:g}", rings)


def impact():
    return scene("impact", [
        body("left", "sphere", (-0.55, 0, 0), velocity=(8, 0, 0), radius=0.5, edge_length=0.16),
        body("right", "sphere", (0.55, 0.15, 0.05), velocity=(-8, 0, 0), radius=0.5, edge_length=0.16)],
        dt=0.005, floor=False, gravity=False)


def mats(young):
    two = [body(f"mat{k}", "slab", (0.02 * k, 0.2 + 0.12 * k, 0), (3 * k, 30 * k, 0), young,
                width=1, depth=1, thickness=0.05, cells=[16, 16]) for k in range(2)]
    return scene(f"mats {young:g}", two)


def log_pile(young):
    logs = []
    for layer in range(2):
        for k in range(2):
            shift = -0.3 + 0.6 * k
            at = (shift, 0.13 + 0.24 * layer, 0) if layer == 0 else (0, 0.13 + 0.24 * layer, shift)
            size = [0.2, 0.2, 1.0] if layer == 0 else [1.0, 0.2, 0.2]
            cells = [2, 2, 8] if layer == 0 else [8, 2, 2]
            logs.append(body(f"log{layer}{k}", "box", at, young=young, size=size, cells=cells))
    return scene(f"crossing rods {young:g}", logs)


def combs():
    teeth = [body(f"lower{k}", "box", (0.3 * k, 0.31, 0), size=[0.12, 0.6, 0.6], cells=[1, 4, 4])
             for k in range(4)]
    bars = [body(f"upper{k}", "box", (0.3 * k, 0.93, 0), size=[0.12, 0.6, 0.6], cells=[1, 4, 4])
            for k in range(4)]
    return scene("aligned combs", teeth + bars)


def twist(young):
    turn = [{"kind": "velocity", "angular_deg": [rate, 0, 0],
             "select": {"box": [[low, -0.1, -0.1], [high, 1.1, 1.1]]}}
            for rate, low, high in ((-90, -0.01, 0.02), (90, 0.98, 1.01))]
    return scene(f"twist {young:g}", [
        body("mat", "slab", young=young, boundary=turn, width=1.0, depth=0.5, thickness=0.04,
             cells=[24, 12])],
        dt=0.04, floor=False, gravity=False)


def press(young):
    plates = []
    for name, y, speed in (("lower", -0.62, 0.3), ("upper", 0.62, -0.3)):
        hold = [{"kind": "velocity", "linear": [0, speed, 0]}]
        plates.append(body(name, "box", (0, y, 0), boundary=hold, size=[1.4, 0.1, 1.4], cells=[4, 1, 4]))
    ball = body("ball", "sphere", young=young, radius=0.5, edge_length=0.14)
    return scene(f"press {young:g}", [ball, *plates], floor=False, gravity=False)


def script(path):
    return lambda noli: script_scene(path, noli)


def native(make, *arguments):
    return lambda noli: make(*arguments)


ERLEBEN = "input/paperExamples/11_erleben/"
SCENES = {
    "rings_1e4": (native(drop, 1e4), 40, "drop"),
    "rings_1e6": (native(drop, 1e6), 40, "drop"),
    "impact": (native(impact), 40, "impact"),
    "stack_1e5": (native(stack, 1e5), 100, "stack"),
    "stack_1e7": (native(stack, 1e7), 100, "stack"),
    "stack_1e8": (native(stack, 1e8), 100, "stack"),
    "heavy_top": (native(heavy_top), 60, "stack"),
    "mats_1e4": (native(mats, 1e4), 30, "drop"),
    "mats_1e6": (native(mats, 1e6), 30, "drop"),
    "crossing_1e6": (native(log_pile, 1e6), 40, "parallel edges"),
    "combs": (native(combs), 40, "parallel edges"),
    "twist_1e5": (native(twist, 1e5), 75, "twist"),
    "press_1e5": (native(press, 1e5), 40, "press"),
    "cube_stack": (script("input/paperExamples/10_cubeStack.txt"), 200, "stack"),
    "spike_spike": (script(ERLEBEN + "spikeSpikeCO.txt"), 60, "Erleben"),
    "wedge_wedge": (script(ERLEBEN + "wedgeWedgoCO.txt"), 60, "Erleben"),
    "cube_cliff": (script(ERLEBEN + "cubeCliffCO.txt"), 60, "Erleben"),
    "spike_hole": (script(ERLEBEN + "spikeHoleCO.txt"), 60, "Erleben"),
    "rods_twist": (script("timed/rodsTwist_120.txt"), 60, "twist"),
    "rollers": (script("timed/sphere1K_rollers_25.txt"), 6, "rollers"),
}
