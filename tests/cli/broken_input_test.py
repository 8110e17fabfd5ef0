# SPDX-License-Identifier: Apache-2.0
"""Broken scenes and meshes through the program: exit code 2, and a message that names the place,
what is wrong, and what to do. One row per case."""
import copy
import json
import pathlib
import tempfile
import unittest

from noli_program import noli

BASE = {
    "format_version": 1,
    "duration": 1,
    "dt": 0.01,
    "bodies": [
        {"name": "ball", "mesh": {"generator": "sphere", "edge_length": 0.25}, "material": {"young": 1e5}},
        {"name": "box", "mesh": {"generator": "box"}, "transform": {"translate": [3, 0, 0]},
         "boundary": [{"kind": "fixed", "select": {"box": [[-0.1, -0.1, -0.1], [1.1, 0.1, 1.1]]}}]},
    ],
    "half_spaces": [{"name": "ground", "point": [0, -2, 0]}],
}


def put(path, value):
    """A change of the base scene: sets the value at a path like bodies/0/name."""

    def change(scene):
        *front, last = [int(p) if p.isdigit() else p for p in path.split("/")]
        for part in front:
            scene = scene.setdefault(part, {}) if isinstance(scene, dict) else scene[part]
        scene[last] = value

    return change


def drop(path):
    def change(scene):
        *front, last = [int(p) if p.isdigit() else p for p in path.split("/")]
        for part in front:
            scene = scene[part]
        del scene[last]

    return change


# (change of the scene, words that the message must hold: the place, and a part of the cure)
SCENES = [
    (put("gravty", [0, -1, 0]), ["/gravty", "gravity"]),
    (put("durations", 2), ["/durations", "duration"]),
    (put("dt", -0.01), ["/dt", "expected"]),
    (put("dt", 0), ["/dt", "expected"]),
    (put("dt", "1 kg"), ["/dt", "time"]),
    (put("dt", "10 mz"), ["/dt", "expected"]),
    (put("duration", -1), ["/duration", "expected"]),
    (put("gravity", [0, 1]), ["/gravity", "expected"]),
    (put("gravity", "down"), ["/gravity", "expected"]),
    (put("format_version", 99), ["/format_version", "expected"]),
    (drop("format_version"), ["format_version"]),
    (drop("bodies"), ["bodies"]),
    (put("bodies", []), ["/bodies", "at least one"]),
    (put("bodies", {}), ["/bodies", "expected"]),
    (put("bodies/0/mesh", {"generator": "spher"}), ["/bodies/0/mesh", "sphere"]),
    (put("bodies/0/mesh/radus", 1), ["/bodies/0/mesh/radus", "radius"]),
    (put("bodies/0/mesh/radius", -1), ["/bodies/0/mesh", "radius"]),
    (put("bodies/0/mesh/edge_length", 0), ["/bodies/0/mesh", "edge_length"]),
    (put("bodies/0/mesh/edge_length", 1e-6), ["/bodies/0/mesh", "edge_length"]),
    (put("bodies/0/mesh", {"file": "nowhere.msh"}), ["/bodies/0/mesh", "nowhere.msh"]),
    (put("bodies/0/mesh", {}), ["/bodies/0/mesh", "generator"]),
    (put("bodies/0/mesh", 7), ["/bodies/0/mesh", "expected"]),
    (drop("bodies/0/mesh"), ["/bodies/0", "mesh"]),
    (put("bodies/0/material", "rubbr"), ["/bodies/0/material", "rubber"]),
    (put("bodies/0/material/young", -5), ["/bodies/0/material/young", "expected"]),
    (put("bodies/0/material/young", "5 mm"), ["/bodies/0/material/young", "pressure"]),
    (put("bodies/0/material/youngs", 1e5), ["/bodies/0/material/youngs", "young"]),
    (put("bodies/0/material/poisson", 0.5), ["/bodies/0/material/poisson", "expected"]),
    (put("bodies/0/material/poisson", -1), ["/bodies/0/material/poisson", "expected"]),
    (put("bodies/0/material/density", 0), ["/bodies/0/material/density", "expected"]),
    (put("bodies/0/material/model", "neohookean"), ["/bodies/0/material/model", "neo_hookean"]),
    (put("bodies/0/friction", -0.1), ["/bodies/0/friction", "expected"]),
    (put("bodies/0/velocity", [1, 2, "x"]), ["/bodies/0/velocity", "expected"]),
    (put("bodies/0/transform", {"scale": 0}), ["/bodies/0/transform", "scale"]),
    (put("bodies/0/transform", {"rotate": [1, 2, 3]}), ["/bodies/0/transform/rotate", "rotate_deg"]),
    (put("bodies/0/transform", {"matrix": [[1, 0, 0, 0]]}), ["/bodies/0/transform/matrix", "expected"]),
    (put("bodies/1/name", "ball"), ["/bodies/1/name", "ball"]),
    (put("bodies/1/boundary/0/kind", "fix"), ["/bodies/1/boundary/0/kind", "fixed"]),
    (drop("bodies/1/boundary/0/kind"), ["/bodies/1/boundary/0", "kind"]),
    (put("bodies/1/boundary/0/select/box", [[0, 0, 0]]), ["/bodies/1/boundary/0/select/box", "expected"]),
    (put("bodies/1/boundary/0/select", {"vertices": [99999]}), ["/bodies/1/boundary/0", "99999"]),
    (put("bodies/1/boundary/0/select", {"vertices": [-1]}), ["/bodies/1/boundary/0/select", "expected"]),
    (put("bodies/1/boundary/0/t_end", -1), ["/bodies/1/boundary/0/t_end", "expected"]),
    (put("bodies/1/boundary/0", {"kind": "path"}), ["/bodies/1/boundary/0", "path"]),
    (put("bodies/1/boundary/0", {"kind": "sequence"}), ["/bodies/1/boundary/0", "sequence"]),
    (put("half_spaces/0/normal", [0, 0, 0]), ["/half_spaces/0/normal", "expected"]),
    (put("half_spaces/0/friction", -1), ["/half_spaces/0/friction", "expected"]),
    (put("contact/dhat", 0), ["/contact/dhat", "expected"]),
    (put("contact/dhat", "2 s"), ["/contact/dhat", "length"]),
    (put("contact/barrier_exponent", 3), ["/contact/barrier_exponent", "expected"]),
    (put("contact/hessian", "gnplus"), ["/contact/hessian", "gn+"]),
    (put("contact/epsv", -1), ["/contact/epsv", "expected"]),
    (put("contact/pairs", [{"a": "bal", "b": "box"}]), ["/contact/pairs/0", "ball"]),
    (put("contact/pairs", [{"a": "ball"}]), ["/contact/pairs/0", "b"]),
    (put("solver/integrator", "euler"), ["/solver/integrator", "implicit_euler"]),
    (put("solver/tolerance", 0), ["/solver/tolerance", "expected"]),
    (put("solver/max_newton", 0), ["/solver/max_newton", "expected"]),
    (put("solver/max_newton", 1.5), ["/solver/max_newton", "expected"]),
    (put("output/formats", ["stl"]), ["/output/formats", "vtu"]),
    (put("output/every", -1), ["/output/every", "expected"]),
]

TEXTS = [  # (file name, content, words)
    ("cut.json", '{"format_version": 1, "bodies": [', ["cut.json"]),
    ("empty.json", "", ["empty.json"]),
    ("list.json", "[1, 2]", ["list.json", "expected"]),
    ("twice.json", '{"format_version": 1, "dt": 1, "dt": 2, "bodies": []}', ["dt"]),
    ("unknown.xyz", "?", ["unknown.xyz"]),
    ("missing_mesh.txt", "shapes input 1\nno/such.msh 0 0 0  0 0 0  1 1 1\n", ["missing_mesh.txt", "no/such.msh"]),
    ("sqp.txt", "constraintSolver SQP\n", ["sqp.txt", "SQP"]),
]

TET = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 0 1 {}\n$EndElements\n"
MESHES = [  # (file name, content, words)
    ("range.msh", TET.format("1 2 3 9"), ["range.msh"]),
    ("inverted.msh", TET.format("1 3 2 4"), ["inverted.msh", "fix_orientation"]),
    ("repeated.msh", TET.format("1 2 3 3"), ["repeated.msh"]),
    ("cut.msh", TET.format("1 2 3 4")[:60], ["cut.msh"]),
    ("nan.msh", TET.format("1 2 3 4").replace("4 0 0 1", "4 0 0 nan"), ["nan.msh"]),
    ("flat.msh", TET.format("1 2 3 4").replace("4 0 0 1", "4 1 1 0"), ["flat.msh"]),
    ("empty.msh", "", ["empty.msh"]),
    ("words.msh", "this is no mesh\n", ["words.msh"]),
    ("index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 7\n", ["index.obj"]),
    ("letters.obj", "v 0 0 x\n", ["letters.obj"]),
]


class BrokenInput(unittest.TestCase):
    def expect_refused(self, path, words):
        done = noli("check", str(path))
        self.assertEqual(done.returncode, 2, f"{path.name}: {done.stdout}{done.stderr}")
        for word in words:
            self.assertIn(word, done.stderr, path.name)
        message = done.stderr.strip()
        self.assertTrue(message.startswith("error: "), message)
        self.assertGreater(len(message), 40, message)

    def test_scenes(self):
        with tempfile.TemporaryDirectory() as folder:
            for number, (change, words) in enumerate(SCENES):
                with self.subTest(number=number, words=words):
                    scene = copy.deepcopy(BASE)
                    change(scene)
                    path = pathlib.Path(folder) / f"scene{number}.json"
                    path.write_text(json.dumps(scene))
                    self.expect_refused(path, words)

    def test_texts(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, content, words in TEXTS:
                with self.subTest(name=name):
                    path = pathlib.Path(folder) / name
                    path.write_text(content)
                    self.expect_refused(path, words)

    def test_meshes(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, content, words in MESHES:
                with self.subTest(name=name):
                    (pathlib.Path(folder) / name).write_text(content)
                    scene = copy.deepcopy(BASE)
                    scene["bodies"][0]["mesh"] = {"file": name}
                    path = pathlib.Path(folder) / (name + ".json")
                    path.write_text(json.dumps(scene))
                    self.expect_refused(path, ["/bodies/0/mesh", *words])

    def test_the_base_scene_is_fine(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "base.json"
            path.write_text(json.dumps(BASE))
            done = noli("check", str(path))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
