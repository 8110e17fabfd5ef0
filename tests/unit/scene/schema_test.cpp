// SPDX-License-Identifier: Apache-2.0
/// The reader, docs/scene.schema.json and docs/scene-format.md must tell the same story.
#include "mesh/source.hpp"
#include "scene/materials.hpp"
#include "scene/schema_builder.hpp"
#include "unit/scene/random_scene.hpp"
#include "unit/scene/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fmt/format.h>
#include <map>
#include <set>
#include <sstream>

namespace noli {
namespace {

namespace fs = std::filesystem;
const std::string kSource = NOLI_SOURCE_DIR;

const char* schema_hint() {
    return "update docs/scene.schema.json: NOLI_UPDATE_SCHEMA=1 unit_scene "
           "--gtest_filter='SceneSchema.*'";
}

TEST(SceneSchema, PublishedFileIsWhatTheReaderAccepts) {
    const std::string path = kSource + "/docs/scene.schema.json";
    if (std::getenv("NOLI_UPDATE_SCHEMA") != nullptr)
        std::ofstream(path) << scene_schema();
    EXPECT_EQ(test::read_text(path), scene_schema()) << schema_hint();
}

/// All objects of the schema by their place: "bodies[]", "bodies[].mesh(box)", ...
void collect(const Json& schema,
             const std::string& place,
             std::map<std::string, Json>& objects) {
    if (schema.contains("properties")) {
        std::string name = place;
        const Json& properties = schema["properties"];
        if (properties.contains("generator"))
            name += "(" + properties["generator"]["const"].get<std::string>() + ")";
        objects[name] = properties;
        for (const auto& [key, value] : properties.items())
            collect(value, (place.empty() ? "" : place + ".") + key, objects);
    }
    if (schema.contains("items")) collect(schema["items"], place + "[]", objects);
    if (schema.contains("anyOf"))
        for (const Json& form : schema["anyOf"])
            collect(form, place, objects);
}

std::map<std::string, Json> schema_objects() {
    std::map<std::string, Json> objects;
    collect(Json::parse(scene_schema()), "", objects);
    return objects;
}

/// Tables of the page after each `<!-- keys: PLACE -->`: first cell (without backquotes)
/// -> whole row.
std::map<std::string, std::map<std::string, std::string>> documented_keys() {
    std::map<std::string, std::map<std::string, std::string>> tables;
    std::istringstream page(test::read_text(kSource + "/docs/scene-format.md"));
    std::string place;
    bool active = false;
    for (std::string line; std::getline(page, line);) {
        if (line.starts_with("<!-- keys: ")) {
            place = line.substr(11, line.find(" -->") - 11);
            if (place == "top") place.clear();
            tables[place];
            active = true;
        } else if (active && line.starts_with("| `")) {
            const auto end = line.find('`', 3);
            tables[place][line.substr(3, end - 3)] = line;
        } else if (active && line.empty() && !tables[place].empty()) {
            active = false;
        }
    }
    return tables;
}

TEST(SceneFormatPage, HasATableForEveryObjectWithExactlyItsKeys) {
    const auto tables = documented_keys();
    const auto objects = schema_objects();
    for (const auto& [place, properties] : objects) {
        if (place.find('(') != std::string::npos) continue;  // generators: next test
        ASSERT_TRUE(tables.contains(place)) << "no table for " << place;
        std::set<std::string> expected, found;
        for (const auto& [key, value] : properties.items())
            expected.insert(key);
        for (const auto& [key, row] : tables.at(place))
            found.insert(key);
        EXPECT_EQ(found, expected) << place;
    }
    for (const auto& [place, rows] : tables)
        EXPECT_TRUE(objects.contains(place))
            << place << " is documented but does not exist";
}

TEST(SceneFormatPage, StatesTheDefaultsOfTheReader) {
    for (const auto& [place, properties] : schema_objects()) {
        if (place.find('(') != std::string::npos) continue;
        const auto tables = documented_keys();
        for (const auto& [key, value] : properties.items()) {
            if (!value.contains("default")) continue;
            Json fallback = value["default"];
            std::string text = print_json(Json{{"x", fallback}});
            text = text.substr(text.find(": ") + 2);
            text = text.substr(0, text.rfind('\n'));
            const std::string& row = tables.at(place).at(key);
            EXPECT_NE(row.find("| `" + text + "` |"), std::string::npos)
                << place << "." << key << " has default " << text << "\n"
                << row;
        }
    }
}

TEST(SceneFormatPage, ListsEveryGeneratorParameterAndPreset) {
    const std::string page = test::read_text(kSource + "/docs/scene-format.md");
    for (const GeneratorEntry& entry : generator_table())
        for (const GeneratorParameter& p : entry.parameters) {
            std::string fallback;
            for (const double value : p.fallback)
                fallback += (fallback.empty() ? "" : ", ") + fmt::format("{}", value);
            if (p.fallback.size() > 1) fallback = "[" + fallback + "]";
            if (p.kind == GeneratorParameter::Kind::Flag)
                fallback = p.fallback[0] != 0 ? "true" : "false";
            const std::string row =
                fmt::format("| `{}` | `{}` | `{}` |", entry.name, p.name, fallback);
            EXPECT_NE(page.find(row), std::string::npos) << row;
        }
    for (const MaterialPreset& m : material_presets()) {
        const std::string row = fmt::format("| `{}` | {} | {:g} | {} | {} |",
                                            m.name,
                                            m.density,
                                            m.young,
                                            m.poisson,
                                            m.doc);
        EXPECT_NE(page.find(row), std::string::npos) << row;
    }
}

/// The examples of the page, in order.
std::vector<std::string> page_examples() {
    std::vector<std::string> examples;
    const std::string page = test::read_text(kSource + "/docs/scene-format.md");
    for (std::size_t at = page.find("```json\n"); at != std::string::npos;
         at = page.find("```json\n", at)) {
        const std::size_t end = page.find("```", at + 8);
        examples.push_back(page.substr(at + 8, end - at - 8));
        at = end;
    }
    return examples;
}

TEST(SceneFormatPage, ExamplesAreValidScenes) {
    const test::ScratchFolder folder;
    folder.write("bunny.msh", "");  // only looked for
    const auto examples = page_examples();
    ASSERT_GE(examples.size(), 2u);
    for (const std::string& example : examples) {
        const auto scene = read_scene(folder.write("example.json", example));
        EXPECT_TRUE(scene) << scene.error().where << ": " << scene.error().message << "\n"
                           << example;
    }
}

TEST(ShippedScenes, AreValid) {
    int count = 0;
    std::error_code ec;
    for (const auto& entry : fs::recursive_directory_iterator(kSource + "/scenes", ec)) {
        if (entry.path().extension() != ".json") continue;
        const auto scene = read_scene(entry.path().string());
        EXPECT_TRUE(scene) << scene.error().where << ": " << scene.error().message;
        ++count;
    }
    if (count == 0) GTEST_SKIP() << "no scenes/*.json in this tree";
}

TEST(SceneSchema, AcceptsWrittenScenesAndRefusesUnknownKeysInAValidator) {
    const std::string script = kSource + "/tests/unit/scene/validate_schema.py";
    if (std::system("python3 -c 'import jsonschema' > /dev/null 2>&1") != 0)
        GTEST_SKIP() << "python3 with jsonschema is not installed";
    const test::ScratchFolder folder;
    for (unsigned seed = 0; seed < 40; ++seed)
        folder.write(fmt::format("good/{}.json", seed),
                     scene_to_json(test::RandomScene(seed).make()));
    const std::string body = R"("bodies": [{ "mesh": { "generator": "box" } }])";
    folder.write("bad/top.json", R"({ "format_version": 1, "bodys": [], )" + body + "}");
    folder.write("bad/version.json", "{" + body + "}");
    folder.write("bad/type.json", R"({ "format_version": 1, "dt": true, )" + body + "}");
    folder.write("bad/range.json", R"({ "format_version": 1, "dt": 0, )" + body + "}");
    folder.write("bad/contact.json",
                 R"({ "format_version": 1, "contact": { "dHat": 1 }, )" + body + "}");
    folder.write(
        "bad/generator.json",
        R"({ "format_version": 1, "bodies": [{ "mesh": { "generator": "box", "radius": 1 } }] })");
    folder.write("bad/choice.json",
                 R"({ "format_version": 1, "solver": { "linear": "lu" }, )" + body + "}");
    const std::string command =
        fmt::format("python3 {} {}/docs/scene.schema.json {}/good {}/bad",
                    script,
                    kSource,
                    folder.path(),
                    folder.path());
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

}  // namespace
}  // namespace noli
