// SPDX-License-Identifier: Apache-2.0
/// Every case is a good scene with one thing wrong; the message must say where, what, and
/// how to cure it.
#include "noli/scene.hpp"

#include "unit/scene/scratch_folder.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

constexpr const char* kGoodScene = R"({
  "format_version": 1,
  "name": "good",
  "duration": 1, "dt": 0.01,
  "gravity": [0, -9.81, 0],
  "bodies": [
    {
      "name": "ball",
      "mesh": { "generator": "sphere", "radius": 0.5 },
      "transform": { "scale": 2, "translate": [0, 1, 0] },
      "material": { "density": 1000, "young": 1e5, "poisson": 0.4 },
      "friction": 0.3,
      "boundary": [
        { "kind": "velocity", "select": { "box": [[0, 0, 0], [0.1, 1, 1]] },
          "linear": [1, 0, 0], "t_begin": 0.5, "t_end": 1, "until": { "axis": "x", "above": 2 } }
      ],
      "grid": { "count": [2, 1, 1], "spacing": [3, 0, 0] }
    },
    {
      "name": "tet",
      "mesh": { "file": "tet.mesh" },
      "boundary": [{ "kind": "path", "path": [{ "time": 0 }, { "time": 1 }] }]
    }
  ],
  "half_spaces": [{ "name": "floor", "normal": [0, 1, 0] }],
  "containers": [{ "name": "drum", "shape": "cylinder", "radius": 9, "axis": [0, 0, 2] }],
  "contact": { "dhat": 1e-3, "barrier_exponent": 2, "hessian": "gn+",
               "pairs": [{ "a": "ball", "b": "floor", "friction": 0.5 }] },
  "damping": { "stiffness": 0 },
  "solver": { "integrator": "newmark", "newmark_beta": 0.25, "tolerance": 0.01, "max_newton": 100 },
  "output": { "every": 1, "formats": ["vtu"] }
})";

struct Broken {
    const char* from;  ///< text of the good scene ...
    const char* to;    ///< ... and what replaces it
    const char* pointer;
    std::vector<const char*> parts;  ///< of the message
};

const std::vector<Broken> kBroken{
    // keys
    {"\"young\"",
     "\"yuong\"",
     "/bodies/0/material/yuong",
     {"unknown key \"yuong\"", "\"young\"", "did you mean \"young\"?"}},
    {"\"dhat\"",
     "\"dHatt\"",
     "/contact/dHatt",
     {"unknown key", "did you mean \"dhat\"?"}},
    {"\"bodies\"", "\"boddies\"", "", {"no key \"bodies\"", "list at least one"}},
    {"\"output\"", "\"outputs\"", "/outputs", {"did you mean \"output\"?"}},
    {"\"above\"",
     "\"abov\"",
     "/bodies/0/boundary/0/until/abov",
     {"did you mean \"above\"?"}},
    {"\"count\"", "\"cuont\"", "/bodies/0/grid", {"no key \"count\"", "[nx, ny, nz]"}},
    {"\"radius\"",
     "\"raduis\"",
     "/bodies/0/mesh/raduis",
     {"unknown key", "did you mean \"radius\"?"}},
    {"\"scale\"",
     "\"scales\"",
     "/bodies/0/transform/scales",
     {"did you mean \"scale\"?"}},
    {"\"mesh\": { \"file\": \"tet.mesh\" },",
     "",
     "/bodies/1",
     {"no key \"mesh\"", "name a file or a generator"}},
    {"\"kind\": \"path\", ",
     "",
     "/bodies/1/boundary/0",
     {"no key \"kind\"", "\"kind\": \"fixed\""}},
    {"\"friction\": 0.3",
     "\"friction\": 0.3, \"friction\": 0.4",
     "/bodies/0/friction",
     {"twice", "remove one"}},
    {"\"linear\": [1, 0, 0]",
     "\"path\": []",
     "/bodies/0/boundary/0/path",
     {"only with \"kind\": \"path\"", "remove it"}},
    {"\"integrator\": \"newmark\"",
     "\"integrator\": \"bdf2\"",
     "/solver/newmark_beta",
     {"only with \"integrator\": \"newmark\""}},
    {"\"format_version\": 1",
     "\"format_version\": 2",
     "/format_version",
     {"found 2", "expected 1", "newer program"}},
    {"\"format_version\": 1,",
     "",
     "",
     {"no key \"format_version\"", "\"format_version\": 1"}},
    // types
    {"\"duration\": 1,",
     "\"duration\": true,",
     "/duration",
     {"found true", "a time > 0 in s", "\"10 ms\""}},
    {"\"duration\": 1,",
     "\"duration\": null,",
     "/duration",
     {"found null", "a time > 0"}},
    {"\"name\": \"good\"",
     "\"name\": 5",
     "/name",
     {"found 5", "expected text", "quotes"}},
    {"[0, -9.81, 0]",
     "[0, -9.81]",
     "/gravity",
     {"a list of 2", "a list of 3", "[x, y, z]"}},
    {"[0, -9.81, 0]", "-9.81", "/gravity", {"found -9.81", "an acceleration"}},
    {"[0, -9.81, 0]",
     "[0, \"down\", 0]",
     "/gravity/1",
     {"\"down\"", "an acceleration", "9.81 m/s^2"}},
    {"\"max_newton\": 100",
     "\"max_newton\": 1.5",
     "/solver/max_newton",
     {"found 1.5", "a whole number >= 1"}},
    {"\"max_newton\": 100",
     "\"max_newton\": \"100\"",
     "/solver/max_newton",
     {"\"100\"", "a whole number >= 1"}},
    {"\"a\": \"ball\"",
     "\"enabled\": 1, \"a\": \"ball\"",
     "/contact/pairs/0/enabled",
     {"found 1", "true or false"}},
    {"\"damping\": { \"stiffness\": 0 }",
     "\"damping\": 0",
     "/damping",
     {"found 0", "an object", "{ ... }"}},
    {"\"formats\": [\"vtu\"]",
     "\"formats\": \"vtu\"",
     "/output/formats",
     {"\"vtu\"", "expected a list", "[ ... ]"}},
    // values
    {"\"density\": 1000",
     "\"density\": -5",
     "/bodies/0/material/density",
     {"found -5", "a density > 0", "g/cm^3"}},
    {"\"young\": 1e5",
     "\"young\": 0",
     "/bodies/0/material/young",
     {"found 0", "a pressure > 0 in Pa", "5 MPa"}},
    {"\"young\": 1e5",
     "\"young\": \"5 mm\"",
     "/bodies/0/material/young",
     {"a length (\"5 mm\")", "expected a pressure"}},
    {"\"young\": 1e5",
     "\"young\": \"5 MPaa\"",
     "/bodies/0/material/young",
     {"unknown unit", "did you mean \"MPa\"?"}},
    {"\"poisson\": 0.4",
     "\"poisson\": 0.5",
     "/bodies/0/material/poisson",
     {"found 0.5", "> -1 and < 0.5"}},
    {"\"material\": {",
     "\"material\": { \"preset\": \"ruber\",",
     "/bodies/0/material/preset",
     {"\"ruber\"", "did you mean \"rubber\"?"}},
    {"\"dt\": 0.01", "\"dt\": 0", "/dt", {"found 0", "a time > 0"}},
    {"\"dt\": 0.01", "\"dt\": 1e-12", "/dt", {"too many steps", "enlarge"}},
    {"\"duration\": 1,", "\"duration\": -2,", "/duration", {"found -2", "a time > 0"}},
    {"\"friction\": 0.3",
     "\"friction\": -0.1",
     "/bodies/0/friction",
     {"found -0.1", "a number >= 0"}},
    {"\"barrier_exponent\": 2",
     "\"barrier_exponent\": 3",
     "/contact/barrier_exponent",
     {"found 3", ">= 1 and <= 2"}},
    {"\"hessian\": \"gn+\"",
     "\"hessian\": \"gnn\"",
     "/contact/hessian",
     {"\"gnn\"", "\"gn\", \"gn+\", \"exact\" or \"numeric\"", "did you mean"}},
    {"\"barrier_exponent\": 2",
     "\"barrier_exponent\": 1, \"model\": \"ipc\"",
     "/contact/model",
     {"found \"ipc\"", "one or the other"}},
    {"\"dhat\": 1e-3", "\"dhat\": 0", "/contact/dhat", {"found 0", "a number > 0"}},
    {"\"dhat\": 1e-3",
     "\"dhat\": \"1 mm\", \"dhat_absolute\": false",
     "/contact/dhat_absolute",
     {"found false", "expected true", "remove"}},
    {"\"dhat\": 1e-3",
     "\"dhat\": \"1 s\"",
     "/contact/dhat",
     {"a time", "expected a length"}},
    {"\"t_end\": 1,",
     "\"t_end\": 0.5,",
     "/bodies/0/boundary/0/t_end",
     {"not after \"t_begin\"", "later time"}},
    {"\"kind\": \"velocity\"",
     "\"kind\": \"velocty\"",
     "/bodies/0/boundary/0/kind",
     {"\"velocty\"", "did you mean \"velocity\"?"}},
    {"[[0, 0, 0], [0.1, 1, 1]]",
     "[[0, 2, 0], [0.1, 1, 1]]",
     "/bodies/0/boundary/0/select/box",
     {"empty box", "2 > 1 along y", "exchange"}},
    {"[[0, 0, 0], [0.1, 1, 1]]",
     "[0, 0, 0, 0.1, 1, 1]",
     "/bodies/0/boundary/0/select/box",
     {"a list of 6", "two corners"}},
    {"\"box\": [[0, 0, 0], [0.1, 1, 1]]",
     "\"vertices\": []",
     "/bodies/0/boundary/0/select/vertices",
     {"no vertices", "at least one"}},
    {"\"box\": [[0, 0, 0], [0.1, 1, 1]]",
     "\"vertices\": [3, -1]",
     "/bodies/0/boundary/0/select/vertices/1",
     {"found -1", ">= 0"}},
    {"\"box\": [[0, 0, 0], [0.1, 1, 1]]",
     "",
     "/bodies/0/boundary/0/select",
     {"neither \"box\" nor \"vertices\"", "add one"}},
    {"{ \"axis\": \"x\", \"above\": 2 }",
     "{ \"axis\": \"x\", \"above\": 2, \"below\": 3 }",
     "/bodies/0/boundary/0/until",
     {"both", "remove one"}},
    {"\"axis\": \"x\"",
     "\"axis\": \"w\"",
     "/bodies/0/boundary/0/until/axis",
     {"\"w\"", "\"x\", \"y\" or \"z\""}},
    {"[{ \"time\": 0 }, { \"time\": 1 }]",
     "[{ \"time\": 1 }, { \"time\": 1 }]",
     "/bodies/1/boundary/0/path",
     {"out of order", "ascending", "sort"}},
    {"[{ \"time\": 0 }, { \"time\": 1 }]",
     "[]",
     "/bodies/1/boundary/0/path",
     {"no key frames", "at least one"}},
    {"\"kind\": \"path\", \"path\": [{ \"time\": 0 }, { \"time\": 1 }]",
     "\"kind\": \"sequence\", \"sequence\": [\"tet.mehs\"]",
     "/bodies/1/boundary/0/sequence/0",
     {"no file \"tet.mehs\"", "did you mean \"tet.mesh\"?"}},
    {"\"scale\": 2",
     "\"scale\": 0",
     "/bodies/0/transform",
     {"flattens", "correct \"scale\""}},
    {"\"scale\": 2",
     "\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]",
     "/bodies/0/transform/matrix",
     {"beside other keys", "remove"}},
    {"\"scale\": 2, \"translate\": [0, 1, 0]",
     "\"matrix\": [[1,0,0],[0,1,0],[0,0,1]]",
     "/bodies/0/transform/matrix",
     {"3 rows of 4 numbers"}},
    {"\"count\": [2, 1, 1]",
     "\"count\": [0, 1, 1]",
     "/bodies/0/grid/count/0",
     {"found 0", "whole number >= 1"}},
    {"\"spacing\": [3, 0, 0]",
     "\"spacing\": [0, 0, 0]",
     "/bodies/0/grid/spacing",
     {"spacing of 0 along x", "lie on each other"}},
    {"\"normal\": [0, 1, 0]",
     "\"normal\": [0, 0, 0]",
     "/half_spaces/0/normal",
     {"[0, 0, 0]", "a direction"}},
    {"\"axis\": [0, 0, 2]",
     "\"axis\": [0, 0, 0]",
     "/containers/0/axis",
     {"[0, 0, 0]", "a direction"}},
    {"\"radius\": 9",
     "\"radius\": 0",
     "/containers/0/radius",
     {"found 0", "a length > 0"}},
    {"\"radius\": 9",
     "\"radius\": \"-2 cm\"",
     "/containers/0/radius",
     {"-2 cm", "a length > 0"}},
    {"\"radius\": 9, ", "", "/containers/0", {"no key \"radius\"", "inner radius"}},
    {"\"shape\": \"cylinder\", ", "", "/containers/0", {"say what bodies stay in"}},
    {"\"shape\": \"cylinder\"",
     "\"shape\": \"sphere\"",
     "/containers/0/axis",
     {"\"shape\": \"cylinder\""}},
    {"\"shape\": \"cylinder\"",
     "\"shape\": \"cilinder\"",
     "/containers/0/shape",
     {"did you mean \"cylinder\"?"}},
    {"\"name\": \"drum\"", "\"name\": \"floor\"", "/containers/0/name", {"second time"}},
    {"\"b\": \"floor\"",
     "\"b\": \"drun\"",
     "/contact/pairs/0/b",
     {"container of this scene", "did you mean \"drum\"?"}},
    {"\"newmark_beta\": 0.25",
     "\"newmark_beta\": 0",
     "/solver/newmark_beta",
     {"found 0", "> 0 and <= 0.5"}},
    {"[\"vtu\"]",
     "[\"vtk\"]",
     "/output/formats/0",
     {"\"vtk\"", "\"vtu\", \"obj\" or \"ply\"", "did you mean \"vtu\"?"}},
    {"[\"vtu\"]",
     "[\"vtu\", \"vtu\"]",
     "/output/formats/1",
     {"second time", "remove it"}},
    // generators and files
    {"\"generator\": \"sphere\"",
     "\"generator\": \"shpere\"",
     "/bodies/0/mesh/generator",
     {"\"shpere\"", "\"torus\"", "did you mean \"sphere\"?"}},
    {"\"radius\": 0.5",
     "\"radius\": -1",
     "/bodies/0/mesh/radius",
     {"found -1", "a length > 0"}},
    {"\"generator\": \"sphere\", \"radius\": 0.5",
     "\"generator\": \"box\", \"cells\": [4, 4]",
     "/bodies/0/mesh/cells",
     {"a list of 2", "3 numbers"}},
    {"\"generator\": \"sphere\", \"radius\": 0.5",
     "\"generator\": \"box\", \"cells\": [4, 4, 0.5]",
     "/bodies/0/mesh/cells/2",
     {"found 0.5", "a whole number"}},
    {"\"generator\": \"sphere\", \"radius\": 0.5",
     "\"generator\": \"tube_surface\", \"capped\": 1",
     "/bodies/0/mesh/capped",
     {"found 1", "true or false"}},
    {"\"file\": \"tet.mesh\"",
     "\"file\": \"tat.mesh\"",
     "/bodies/1/mesh/file",
     {"no file \"tat.mesh\"", "did you mean \"tet.mesh\"?", "put the file there"}},
    {"\"file\": \"tet.mesh\"",
     "\"file\": \"tet.mesh\", \"generator\": \"box\"",
     "/bodies/1/mesh",
     {"both \"file\" and \"generator\"", "remove one"}},
    {"\"file\": \"tet.mesh\"",
     "",
     "/bodies/1/mesh",
     {"neither \"file\" nor \"generator\"", "add one"}},
    {"\"name\": \"good\"",
     "\"base_folder\": \"nowhere\"",
     "/base_folder",
     {"no folder", "correct the path"}},
    // names
    {"\"name\": \"tet\"",
     "\"name\": \"ball\"",
     "/bodies/1/name",
     {"\"ball\" for the second time", "rename"}},
    {"\"name\": \"tet\"",
     "\"name\": \"*\"",
     "/bodies/1/name",
     {"\"*\"", "choose another"}},
    {"\"name\": \"floor\"", "\"name\": \"ball\"", "/half_spaces/0/name", {"second time"}},
    {"\"a\": \"ball\"",
     "\"a\": \"bal\"",
     "/contact/pairs/0/a",
     {"\"bal\"", "did you mean \"ball\"?"}},
    {"\"a\": \"ball\"",
     "\"a\": \"ball[2,0,0]\"",
     "/contact/pairs/0/a",
     {"\"ball[2,0,0]\"", "expected a body"}},
    {"\"b\": \"floor\", \"friction\": 0.5",
     "\"b\": \"floor\"",
     "/contact/pairs/0",
     {"changes nothing", "\"enabled\""}},
};

TEST(BrokenScene, GoodSceneIsGood) {
    const test::ScratchFolder folder;
    folder.write("tet.mesh", test::kTetMesh);
    const auto scene = read_scene(folder.write("scene.json", kGoodScene));
    EXPECT_TRUE(scene) << scene.error().where << ": " << scene.error().message;
}

TEST(BrokenScene, SaysWhereWhatAndCure) {
    const test::ScratchFolder folder;
    folder.write("tet.mesh", test::kTetMesh);
    for (const Broken& broken : kBroken) {
        std::string text = kGoodScene;
        const auto at = text.find(broken.from);
        ASSERT_NE(at, std::string::npos) << broken.from;
        text.replace(at, std::string(broken.from).size(), broken.to);
        const std::string file = folder.write("scene.json", text);
        const auto scene = read_scene(file);
        ASSERT_FALSE(scene) << broken.from << " -> " << broken.to << " was accepted";
        const Error& error = scene.error();
        EXPECT_EQ(error.where, file + ":" + broken.pointer) << broken.to << "\n"
                                                            << error.message;
        const std::string first_line = error.message.substr(0, error.message.find('\n'));
        for (const char* part : broken.parts)
            EXPECT_NE(first_line.find(part), std::string::npos)
                << broken.to << ": no " << part << " in\n"
                << error.message;
        const bool missing_file = first_line.starts_with("found no file");
        EXPECT_EQ(error.code,
                  missing_file ? Error::Code::FileNotReadable : Error::Code::InvalidScene)
            << broken.to;
    }
}

TEST(BrokenScene, IsManyKinds) {
    EXPECT_GE(kBroken.size(), 60u);
}

TEST(BrokenScene, ListsSeveralErrorsAtOnce) {
    const test::ScratchFolder folder;
    const std::string file = folder.write(
        "scene.json", R"({ "format_version": 1, "dt": -1, "gravit": [0, 0, 0],
        "bodies": [{ "mesh": { "generator": "box" }, "friction": -1 }] })");
    const auto scene = read_scene(file);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().where, file + ":/dt");
    EXPECT_NE(scene.error().message.find("\n" + file + ":/bodies/0/friction: found -1"),
              std::string::npos);
    EXPECT_NE(scene.error().message.find("did you mean \"gravity\"?"), std::string::npos);
}

TEST(ReadScene, RefusesWhatIsNoSceneFile) {
    const test::ScratchFolder folder;
    const auto message = [&](const std::string& path) {
        const auto scene = read_scene(path);
        return scene ? std::string("accepted") : scene.error().message;
    };
    folder.write("drop.json", kGoodScene);
    EXPECT_NE(message(folder.path() + "/dorp.json").find("did you mean \"drop.json\"?"),
              std::string::npos);
    EXPECT_NE(message(folder.path()).find("a folder"), std::string::npos);
    EXPECT_NE(message(folder.write("a.yaml", "x")).find("\".yaml\""), std::string::npos);
    EXPECT_NE(message(folder.write("a.json", "[1, 2]")).find("expected an object"),
              std::string::npos);
    EXPECT_NE(message(folder.write("b.json", "{ \"a\": }")).find("not JSON"),
              std::string::npos);
    EXPECT_NE(message(folder.write("c.json", "{ \"format_version\": 1, \"bodies\": [] }"))
                  .find("no bodies"),
              std::string::npos);
}

}  // namespace
}  // namespace noli
