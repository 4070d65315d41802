#include "support/json_field.h"

#include <gtest/gtest.h>
#include <array>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "support/input_error.h"

namespace lcpbench::testing {
namespace {

using Json = nlohmann::json;

// The text of the InputError that a read throws; without the place, which every text begins with.
std::string ErrorOf(const Json& json, const std::function<void(const JsonField&)>& read) {
  const std::string where = "file:7";
  try {
    read(JsonField(json, where));
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind("file:7: ", 0), 0U) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text.substr(8);
  }
  return "no error";
}

TEST(JsonField, MissingMembersAreRefusedByWhatWasExpected) {
  using Field = const JsonField&;
  const std::pair<std::function<void(Field)>, std::string> kReads[] = {
      {[](Field f) { f["c"].Number(); }, "/c: missing field, expected a number"},
      {[](Field f) { f["a"]["c"].Pair<std::array<double, 2>>(); },
       "/a/c: missing field, expected an array of two numbers"},
      {[](Field f) { f["c"].Items(3); }, "/c: missing field, expected an array of 3"},
      {[](Field f) { f["c"]["d"].Boolean(); }, "/c: missing field, expected an object"},
      {[](Field f) { f["c"].NumberOrNull(); }, "/c: missing field, expected a number or null"},
      {[](Field f) { f["c"].IndexBelow(2); }, "/c: missing field, expected an integer in [0, 2)"},
      {[](Field f) {
         f["c"].Choice<int>({{"x", 1}, {"y", 2}});
       },
       "/c: missing field, expected one of x, y"},
      {[](Field f) { f["c"].RequireOnlyKeys({"x"}); }, "/c: missing field, expected an object"},
      {[](Field f) { f["a"]["b"]["c"].String(); }, "/a/b: expected an object, found 1"}};
  for (const auto& [read, error] : kReads) EXPECT_EQ(ErrorOf({{"a", {{"b", 1}}}}, read), error);
}

TEST(JsonField, HasTellsMembersOfObjectsOnly) {
  const Json json = {{"a", nullptr}, {"b", {1, 2}}};
  const std::string where = "file";
  const JsonField field(json, where);
  EXPECT_TRUE(field.Has("a"));
  EXPECT_TRUE(field["a"].IsNull());
  EXPECT_FALSE(field.Has("c"));
  EXPECT_FALSE(field["c"].IsNull());
  EXPECT_FALSE(field["c"].Has("d"));
  EXPECT_FALSE(field["b"].Has("0"));
  EXPECT_EQ(field.Path(), "/");
  EXPECT_EQ(field["b"].Items()[1].Path(), "/b/1");
}

TEST(JsonField, UnknownKeysAreRefusedNamingThemAndTheKnownOnes) {
  const Json json = {{"bodies", {{{"mass", 1}, {"x", 2}}}}};
  const auto body = [](const JsonField& f) { return f["bodies"].Items()[0]; };
  EXPECT_EQ(ErrorOf(json, [&](const JsonField& f) { body(f).RequireOnlyKeys({"x", "y", "mass"}); }), "no error");
  EXPECT_EQ(ErrorOf(json,
                    [&](const JsonField& f) {
                      body(f).RequireOnlyKeys({"mas", "y", "x"});
                    }),
            "/bodies/0: unknown key \"mass\", expected one of mas, y, x");
  EXPECT_EQ(ErrorOf(json, [&](const JsonField& f) { f["bodies"].RequireOnlyKeys({"x"}); }),
            "/bodies: expected an object, found an array of 1");
  EXPECT_EQ(ErrorOf({{"a\n\u00e9", 1}}, [](const JsonField& f) { f.RequireOnlyKeys({"x"}); }),
            "/: unknown key \"a\\n\\u00e9\", expected one of x");
}

TEST(JsonField, IntegersAreThoseOfAnIntAndOfNoOtherKind) {
  const auto read = [](const Json& json) {
    int value = 0;
    const std::string error = ErrorOf(json, [&](const JsonField& f) { value = f.Integer(); });
    return error == "no error" ? std::to_string(value) : error;
  };
  constexpr long long kMost = std::numeric_limits<int>::max();
  EXPECT_EQ(read(0), "0");
  EXPECT_EQ(read(-7), "-7");
  EXPECT_EQ(read(kMost), std::to_string(kMost));
  EXPECT_EQ(read(-kMost - 1), std::to_string(-kMost - 1));
  EXPECT_EQ(read(kMost + 1), "/: expected an integer, found 2147483648");
  EXPECT_EQ(read(-kMost - 2), "/: expected an integer, found -2147483649");
  EXPECT_EQ(read(2.0), "/: expected an integer, found 2.0");
  EXPECT_EQ(read("2"), "/: expected an integer, found \"2\"");
}

TEST(JsonField, ChoicesAreStringsOfTheListOnly) {
  const auto read = [](const Json& json) {
    char value = 'x';
    const std::string error = ErrorOf(json, [&](const JsonField& f) {
      value = f.Choice<char>({{"left", 'l'}, {"right", 'r'}});
    });
    return error == "no error" ? std::string(1, value) : error;
  };
  EXPECT_EQ(read("left"), "l");
  EXPECT_EQ(read("right"), "r");
  EXPECT_EQ(read("Left"), "/: expected one of left, right, found \"Left\"");
  EXPECT_EQ(read(nullptr), "/: expected one of left, right, found null");
}

}  // namespace
}  // namespace lcpbench::testing
