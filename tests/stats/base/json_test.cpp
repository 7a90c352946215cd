#include "stats/base/json.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <sstream>

namespace base {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Json, AListOfPairsThatBeginWithATextIsAnObject) {
  EXPECT_EQ((Json{{"n", 3}, {"mean", 2.5}}).dump(), R"({"n":3,"mean":2.5})");
  EXPECT_EQ((Json{{"n", 3}, {4, 2.5}}).dump(), R"([["n",3],[4,2.5]])");
  EXPECT_EQ((Json{1, "two", nullptr, true}).dump(), R"([1,"two",null,true])");
  EXPECT_EQ(Json::array({"n", 3}).dump(), R"(["n",3])");
  EXPECT_THAT(
      [] {
        Json::object({{"n", 3}, {"mean"}});
      },
      ThrowsMessage<JsonError>(HasSubstr("not a pair of a key and a value")));
}

TEST(Json, TakesContainersAndOptionalValues) {
  EXPECT_EQ(Json(std::vector<double>{1, 2.5}).dump(), "[1.0,2.5]");
  EXPECT_EQ(Json(std::vector<bool>{true, false}).dump(), "[true,false]");
  EXPECT_EQ(Json(std::map<std::string, int>{{"b", 2}, {"a", 1}}).dump(), R"({"a":1,"b":2})");
  EXPECT_EQ(Json(std::set<std::string>{"y", "x"}).dump(), R"(["x","y"])");
  EXPECT_EQ((Json{{"some", std::optional<int>(3)}, {"none", std::optional<double>()}}).dump(),
            R"({"some":3,"none":null})");
}

TEST(Json, WhatIsPrintedIsReadBack) {
  const std::string text = R"({"z":1,"a":[null,true,-3,18446744073709551615,0.1,"\"\\ü"],"empty":[{},[]]})";
  EXPECT_EQ(Json::parse(text).dump(), text) << "members keep their order";
  EXPECT_EQ(Json::parse(Json::parse(text).dump(2)), Json::parse(text));
  std::istringstream stream(text);
  EXPECT_EQ(Json::parse(stream), Json::parse(text));
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(Json::parse(Json(least).dump()).get<double>(), least);
  EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
  EXPECT_EQ(Json("a\xff").dump(), "\"a\uFFFD\"") << "bytes that are not UTF-8";
}

TEST(Json, TextThatIsNoJsonIsRefusedWithItsPlace) {
  EXPECT_THAT([] { Json::parse("{\"a\":\n1,}"); }, ThrowsMessage<JsonError>(HasSubstr("line 2, column 3")));
  for (const char* text : {"", " ", "{", "[1,]", "nul", "1 2", "{\"a\":01}", "\"\xff\""}) {
    EXPECT_THROW(Json::parse(text), JsonError) << text;
    EXPECT_TRUE(parse_json(text).is_null()) << text;
  }
}

TEST(Json, DeepNestingIsRefusedBeforeItIsRead) {
  const auto nested = [](int levels) {
    const auto count = static_cast<std::size_t>(levels);
    return std::string(count, '[') + std::string(count, ']');
  };
  EXPECT_EQ(Json::parse(nested(most_json_levels)).dump(), nested(most_json_levels));
  EXPECT_THAT([&] { Json::parse(nested(most_json_levels + 1)); },
              ThrowsMessage<JsonError>(HasSubstr("nested deeper than 32 levels")));
  EXPECT_THROW(Json::parse(nested(10'000'000)), JsonError);
  EXPECT_TRUE(parse_json(nested(3), 2).is_null());
  EXPECT_TRUE(parse_json("\"[[[\"", 2).is_string()) << "brackets of a text are not counted";
  EXPECT_TRUE(parse_json(R"("\"[[[")", 2).is_string());
}

TEST(Json, AMissingMemberIsNamed) {
  Json json = {{"n", 3}, {"list", Json::array({1})}};
  const Json& constant = json;
  EXPECT_THAT([&] { json.at("m"); }, ThrowsMessage<JsonError>(HasSubstr("no member \"m\"")));
  EXPECT_THAT([&] { constant["m"]; }, ThrowsMessage<JsonError>(HasSubstr("no member \"m\"")));
  EXPECT_THAT([&] { json["list"].at(1); },
              ThrowsMessage<JsonError>(HasSubstr("no element 1 in an array of 1")));
  EXPECT_THAT([&] { json.at("n").at("m"); },
              ThrowsMessage<JsonError>(HasSubstr("the value is a number, not an object")));
  EXPECT_THAT([&] { json.at("n").get<std::string>(); }, ThrowsMessage<JsonError>(HasSubstr("not a text")));
  EXPECT_THROW(json.push_back(1), JsonError);
  EXPECT_EQ(json.value("m", 7), 7);
  EXPECT_EQ(json.value("n", 7), 3);
  EXPECT_THROW(json.value("n", "text"), JsonError);
  EXPECT_FALSE(json.contains("m"));
  json["m"] = 4;
  EXPECT_EQ(json.dump(), R"({"n":3,"list":[1],"m":4})");
}

TEST(Json, MembersAreUpdatedAndErased) {
  Json json = {{"a", 1}, {"b", 2}};
  json.update({{"b", 3}, {"c", 4}});
  EXPECT_EQ(json.dump(), R"({"a":1,"b":3,"c":4})");
  EXPECT_EQ(json.erase("a"), 1u);
  EXPECT_EQ(json.erase("a"), 0u);
  EXPECT_EQ(json.at("c"), 4) << "keys and values go together";
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_THAT(keys, ElementsAre("b", "c"));
  json = Json();
  json.push_back("x");
  EXPECT_EQ(json.dump(), R"(["x"])") << "null becomes an array";
}

TEST(Json, PointersNamePlaces) {
  Json json = Json::parse(R"({"a/b":{"~":[10,11]},"n":3})");
  const JsonPointer place("/a~1b/~0/1");
  EXPECT_EQ(json.at(place), 11);
  EXPECT_EQ(place.text(), "/a~1b/~0/1");
  EXPECT_EQ(json.at(JsonPointer("")), json);
  for (const char* missing : {"/a", "/a~1b/~0/2", "/a~1b/~0/x", "/a~1b/~0/-1", "/n/0"}) {
    EXPECT_FALSE(json.contains(JsonPointer(missing))) << missing;
    EXPECT_THROW(json.at(JsonPointer(missing)), JsonError) << missing;
    EXPECT_EQ(json.value(JsonPointer(missing), 5), 5) << missing;
  }
  EXPECT_THROW(JsonPointer("a"), JsonError);
  json[JsonPointer("/new/member")] = 1;
  EXPECT_EQ(json.at("new").dump(), R"({"member":1})");
}

TEST(Json, NumbersAreEqualByTheirValue) {
  EXPECT_EQ(Json(3), Json(3u));
  EXPECT_EQ(Json(3), Json(3.0));
  EXPECT_EQ(Json(3), 3);
  EXPECT_NE(Json(-1), Json(std::numeric_limits<std::uint64_t>::max())) << "the same bits";
  EXPECT_NE(Json(0), Json(false));
  EXPECT_NE(Json(0), Json());
  EXPECT_LT(Json(-1), Json(0.5));
  EXPECT_LT(Json("a"), Json("b"));
  EXPECT_FALSE(Json("a") < Json(1) || Json(1) < Json("a")) << "they have no order";
  EXPECT_EQ((Json{{"a", 1}, {"b", 2}}), (Json{{"b", 2}, {"a", 1}})) << "whatever the members' order";
  EXPECT_NE((Json{{"a", 1}, {"b", 2}}), (Json{{"a", 1}, {"c", 2}}));
}

}  // namespace
}  // namespace base
