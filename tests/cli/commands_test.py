# SPDX-License-Identifier: Apache-2.0
"""The command line itself, `noli check`, `noli info`, `noli convert`."""
import json
import os
import pathlib
import unittest

from noli_program import ProgramTest, noli

IPC_SCRIPT = pathlib.Path(os.environ.get("NOLI_SHARED_DIR", "")) / "ipc-scenes/input/tutorialExamples/2cubesFall.txt"


def write_box_mesh(path):
    """Two tetrahedra that share a face, as a MEDIT file."""
    path.write_text("MeshVersionFormatted 2\nDimension 3\nVertices\n5\n"
                    "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
                    "Tetrahedra\n2\n1 2 3 4 0\n2 5 3 4 0\nEnd\n")


class CommandLine(ProgramTest):
    def test_version_is_that_of_the_project(self):
        expected = "noli " + os.environ.get("NOLI_PROJECT_VERSION", "0.1.0")
        self.assertEqual(self.expect(noli("--version"), 0).stdout.strip(), expected)

    def test_help_explains_exit_codes_and_gives_examples(self):
        self.expect(noli("--help"), 0, "Exit codes", "run", "check", "info", "convert")
        for command in ("run", "check", "info", "convert"):
            self.expect(noli(command, "--help"), 0, "Example", "noli " + command)

    def test_wrong_command_lines_end_with_2_and_say_what_is_meant(self):
        cases = [
            ((), "subcommand"),
            (("rum", "x.json"), "did you mean run?"),
            (("chekc", "x.json"), "did you mean check?"),
            (("run",), "SCENE"),
            (("run", self.scene, "--setps", "3"), "did you mean --steps?"),
            (("run", self.scene, "--resum"), "did you mean --resume?"),
            (("run", self.scene, "--frame-every=3"), "did you mean --frames-every?"),
            (("run", self.scene, "--qqqqqqqqqqqq"), "unknown option --qqqqqqqqqqqq"),
            (("run", self.scene, "--steps", "-3"), "--steps"),
            (("run", self.scene, "--steps", "many"), "many"),
            (("run", self.scene, "--threads", "-1"), "--threads"),
            (("run", self.scene, "--device", "tpu"), "tpu"),
            (("run", self.scene, "--linear", "magic"), "cholmod"),
            (("run", self.scene, "--format", "vtu,stl"), "stl"),
            (("run", self.scene, "--dt", "0"), "--dt"),
            (("run", self.scene, "--resume", "--overwrite"), "--overwrite"),
            (("run", self.scene, "extra.json"), "extra.json"),
            (("convert", self.scene), "--output"),
            (("info",), "PATH"),
        ]
        for arguments, part in cases:
            with self.subTest(arguments=arguments):
                result = self.expect(noli(*arguments), 2, part)
                self.assertTrue(result.stderr.startswith("error: "), result.stderr)
                self.assertEqual(result.stdout, "")

    def test_wrong_inputs_end_with_2_and_name_the_place(self):
        broken = self.folder / "broken.json"
        broken.write_text('{"format_version": 1, "bodies": [{"mesh": {"generator": "bxo"}}]}')
        cases = [
            (("run", self.folder / "none.json"), "none.json"),
            (("run", broken), "/bodies/0/mesh/generator"),
            (("check", broken), "/bodies/0/mesh/generator"),
            (("check", self.folder / "none.json"), "none.json"),
            (("info", self.folder / "none.msh"), "none.msh"),
            (("info", self.folder), "run.json"),
            (("run", self.folder), "folder"),
        ]
        for arguments, part in cases:
            with self.subTest(arguments=arguments):
                result = self.expect(noli(*arguments, cwd=self.folder), 2, part)
                self.assertTrue(result.stderr.startswith("error: "), result.stderr)

    def test_output_that_cannot_be_written_ends_with_1(self):
        with open("/dev/full", "w") as full:
            self.expect(noli("info", self.scene, stdout=full), 1, "standard output", "No space left")


class Check(ProgramTest):
    def test_accepts_a_good_scene(self):
        self.expect(noli("check", self.scene, cwd=self.folder), 0, "ready to run", "dhat", "MB")

    def test_lists_and_marks_intersections(self):
        bodies = [{"name": "a", "mesh": {"generator": "box"}},
                  {"name": "b", "mesh": {"generator": "box"}, "transform": {"translate": [0.51, 0.43, 0.37]}}]
        scene = self.write_scene("bad.json", bodies=bodies, half_spaces=[])
        result = self.expect(noli("check", scene, cwd=self.folder), 2, "not ready to run", " of a ", " of b")
        self.assertTrue(list(self.folder.glob("*.ply")), result.stdout)
        self.expect(noli("run", scene, "-o", self.folder / "run"), 2, "intersections before the first step")
        self.assertFalse((self.folder / "run").exists())

    def test_refuses_bodies_that_touch_as_run_does(self):
        bodies = [{"name": "a", "mesh": {"generator": "box"}},
                  {"name": "b", "mesh": {"generator": "box"}, "transform": {"translate": [0.1, 1 + 1e-15, 0]}}]
        scene = self.write_scene("touching.json", bodies=bodies, half_spaces=[])
        said = ('error: "a" and "b": touch: ', "e-15 m apart", "leave a gap of more than ")
        self.expect(noli("check", scene, cwd=self.folder), 2, "not ready to run", *said)
        self.expect(noli("run", scene, "-o", self.folder / "run"), 2, *said)
        self.assertFalse((self.folder / "run").exists())

    def test_names_vertices_beyond_half_spaces_and_containers(self):
        bodies = [{"name": "sunk", "mesh": {"generator": "box"}}]
        drum = {"name": "drum", "shape": "sphere", "radius": 0.8}
        scene = self.write_scene("sunk.json", bodies=bodies, half_spaces=[{"name": "floor"}], containers=[drum])
        parts = ('vertices of "sunk" are behind half-space "floor": the deepest is vertex ', ", 0.5 m deep; move the body by ")
        result = self.expect(noli("check", scene, cwd=self.folder), 2, "not ready to run", *parts,
                             'vertices of "sunk" are outside of container "drum"')
        self.assertNotIn("-1 -1", result.stdout + result.stderr)
        self.assertNotIn("more intersections", result.stderr)
        self.assertTrue(list(self.folder.glob("*.ply")), result.stdout)
        self.expect(noli("run", scene, "-o", self.folder / "run"), 2, *parts)
        self.assertFalse((self.folder / "run").exists())


class Info(ProgramTest):
    def test_describes_a_scene_with_contact_settings_in_metres(self):
        self.expect(noli("info", self.scene), 0, "lower", "upper", "686 vertices", "50 steps", "dhat", " m,")

    def test_describes_a_mesh(self):
        mesh = self.folder / "two.mesh"
        write_box_mesh(mesh)
        self.expect(noli("info", mesh), 0, "5 vertices, 2 tetrahedra", "0 0 0 to 1 1 1 m", " 0.5 m^3, surface",
                    " none")

    def test_describes_several_and_keeps_the_worst_code(self):
        result = self.expect(noli("info", self.scene, self.folder / "none.msh"), 2, "none.msh")
        self.assertIn("lower", result.stdout)


class Convert(ProgramTest):
    def test_keeps_mesh_paths_true_in_another_folder(self):
        (self.folder / "meshes").mkdir()
        (self.folder / "out").mkdir()
        write_box_mesh(self.folder / "meshes/two.mesh")
        scene = self.write_scene("file.json", bodies=[{"mesh": {"file": "meshes/two.mesh"}}])
        converted = self.folder / "out/file.json"
        self.expect(noli("convert", scene, "-o", converted), 0)
        self.assertEqual(json.loads(converted.read_text())["bodies"][0]["mesh"]["file"], "../meshes/two.mesh")
        self.expect(noli("info", converted), 0, "5 vertices")

    def test_writes_a_mesh_in_another_format(self):
        mesh = self.folder / "two.mesh"
        write_box_mesh(mesh)
        self.expect(noli("convert", mesh, "-o", self.folder / "two.msh"), 0)
        self.expect(noli("info", self.folder / "two.msh"), 0, "5 vertices, 2 tetrahedra", " 0.5 m^3, surface")

    def test_refuses_to_replace_files_unasked(self):
        other = self.write_scene("other.json")
        before = other.read_text()
        self.expect(noli("convert", self.scene, "-o", other), 2, "--overwrite")
        self.assertEqual(other.read_text(), before)
        self.expect(noli("convert", self.scene, "-o", other, "--overwrite"), 0)
        self.expect(noli("convert", self.scene, "-o", self.scene, "--overwrite"), 2, "input itself")
        self.expect(noli("convert", self.scene, "-o", self.folder / "x.yaml"), 2, ".json")
        self.expect(noli("convert", self.scene, "-o", self.folder / "none/x.json"), 1, "No such file")

    @unittest.skipUnless(IPC_SCRIPT.is_file(), "needs the IPC scenes of NOLI_SHARED_DIR")
    def test_makes_an_ipc_script_a_native_scene_that_runs_alike(self):
        native = self.folder / "native.json"
        self.expect(noli("convert", IPC_SCRIPT, "-o", native), 0)
        states = []
        for scene, name in ((IPC_SCRIPT, "a"), (native, "b")):
            run = self.folder / name
            self.expect(noli("run", scene, "-o", run, "--steps", 2, "--frames-every", 0, "--quiet"), 0)
            states.append(json.loads((run / "run.json").read_text())["state_hash"])
        self.assertEqual(states[0], states[1])


class VerticesWithoutElement(ProgramTest):
    def test_all_commands_say_the_same_about_them(self):
        mesh = self.folder / "stray.mesh"
        write_box_mesh(mesh)
        mesh.write_text(mesh.read_text().replace("Vertices\n5\n", "Vertices\n6\n")
                        .replace("1 1 1 0\n", "1 1 1 0\n70 80 90 0\n"))
        scene = self.folder / "stray.json"
        scene.write_text(json.dumps({"format_version": 1, "duration": 0.01, "dt": 0.01,
                                     "bodies": [{"name": "body", "mesh": "stray.mesh"}]}))
        said = "has 1 vertices that no tetrahedron uses (first: 5)"
        box = "0 0 0 to 1 1 1 m"
        self.expect(noli("info", mesh), 0, said, box)
        self.expect(noli("info", scene), 0, said, box)
        self.expect(noli("check", scene), 0, said)
        self.expect(noli("run", scene, "-o", self.folder / "out"), 0, said)


if __name__ == "__main__":
    unittest.main()
