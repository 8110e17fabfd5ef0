// SPDX-License-Identifier: Apache-2.0
#include "scene/json_text.hpp"
#include "scene/suggest.hpp"

#include <gtest/gtest.h>

#include <random>

namespace noli {
namespace {

TEST(EditDistance, CountsSlips) {
    EXPECT_EQ(edit_distance("young", "young"), 0);
    EXPECT_EQ(edit_distance("yuong", "young"), 1);  // neighbours exchanged
    EXPECT_EQ(edit_distance("Young", "young"), 0);  // case does not matter
    EXPECT_EQ(edit_distance("yong", "young"), 1);
    EXPECT_EQ(edit_distance("", "abc"), 3);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
}

TEST(NearestWord, SuggestsOnlyWhatIsNear) {
    EXPECT_EQ(nearest_word("frictoin", {"friction", "fraction"}).value_or(""),
              "friction");
    EXPECT_FALSE(nearest_word("banana", {"friction", "dhat"}).has_value());
    EXPECT_EQ(did_you_mean("dht", {"dhat", "dt"}), "; did you mean \"dhat\"?");
}

TEST(ParseJson, NamesLineAndColumnOfBadSyntax) {
    const auto where = [](const char* text) {
        return parse_json(text, "s.json").error().where;
    };
    EXPECT_EQ(where("{\n  \"a\": 1,\n  \"b\" 2\n}"), "s.json:3:7");
    EXPECT_EQ(where("{\"a\": [1, 2,]}"), "s.json:1:13");
    EXPECT_EQ(where("{\"a\": 01}"), "s.json:1:8");
    EXPECT_NE(
        parse_json("{\"a\": [1, 2,]}", "s").error().message.find("remove the comma"),
        std::string::npos);
    EXPECT_NE(parse_json("{\"a\": 1", "s").error().message.find("ends too early"),
              std::string::npos);
    EXPECT_NE(parse_json("", "s").error().message.find("format_version"),
              std::string::npos);
    EXPECT_NE(parse_json("{\"a\": 1e999}", "s").error().message.find("1.8e308"),
              std::string::npos);
}

TEST(ParseJson, FindsKeysThatAppearTwice) {
    const auto twice =
        parse_json(R"({"a": [{"x": 1}, {"y/z": 1, "b": {"x": 1}, "y/z": 2}]})", "s.json");
    ASSERT_FALSE(twice);
    EXPECT_EQ(twice.error().where, "s.json:/a/1/y~1z");
    EXPECT_NE(twice.error().message.find("twice"), std::string::npos);
    EXPECT_TRUE(parse_json(R"({"a": [{"x": 1}, {"x": 1}], "x": 2})", "s.json"));
}

TEST(ParseJson, AllowsComments) {
    const auto tree = parse_json("// a scene\n{ \"a\": /* one */ 1 } // end", "s.json");
    ASSERT_TRUE(tree);
    EXPECT_EQ(tree.value()["a"], 1);
}

TEST(PrintJson, ReadsBackBitForBit) {
    std::mt19937_64 random(7);
    Json list = Json::array();
    for (int i = 0; i < 2000; ++i) {
        const auto value = std::bit_cast<double>(random());
        if (std::isfinite(value)) list.push_back(value);
    }
    for (const double value :
         {0.0, -0.0, 0.1, 1e22, 5e-324, 1.7976931348623157e308, 123456789012345680.0})
        list.push_back(value);
    const auto back = parse_json(print_json(Json{{"list", list}}), "s.json");
    ASSERT_TRUE(back);
    ASSERT_EQ(back.value()["list"].size(), list.size());
    for (std::size_t i = 0; i < list.size(); ++i)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(back.value()["list"][i].get<double>()),
                  std::bit_cast<std::uint64_t>(list[i].get<double>()));
}

TEST(PrintJson, KeepsShortThingsOnOneLineAndLongOnesNarrow) {
    Json numbers = Json::array();
    for (int i = 0; i < 200; ++i)
        numbers.push_back(i);
    const std::string text = print_json(Json{{"short", {1, 2, 3}}, {"long", numbers}});
    EXPECT_NE(text.find("\"short\": [1, 2, 3],"), std::string::npos);
    std::size_t longest = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        longest = std::max(longest, end - begin);
        begin = end + 1;
    }
    EXPECT_LE(longest, 100u);
    EXPECT_GT(longest, 80u);  // filled, not one number per line
}

}  // namespace
}  // namespace noli
