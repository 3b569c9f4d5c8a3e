// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

enum class Edge { Canny, Sobel };

struct Inner {
  int count = 40;
  Edge edge = Edge::Canny;
  void visit(ConfigFields& fields) {
    fields.add("count", count, {.unit = "px", .min = 1, .max = 100, .effect = "how many"});
    fields.choice("edge", edge, {{"canny", Edge::Canny}, {"sobel", Edge::Sobel}}, {.effect = "edge filter"});
  }
};

struct Outer {
  bool enabled = true;
  double rate = 0.1;
  std::string label = "plain";
  Inner inner;
  void visit(ConfigFields& fields) {
    fields.add("enabled", enabled, {.effect = "on or off"});
    fields.add("rate", rate, {.unit = "Hz", .min = 0.0, .effect = "how often"});
    fields.group("inner", inner);
    fields.add("label", label, {});
  }
};

class Config : public ::testing::Test {
 protected:
  std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }

  std::filesystem::path write(const std::string& text) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    const auto file = std::filesystem::temp_directory_path() / ("edged_" + std::string(test->name()) + ".yaml");
    std::ofstream(file) << text;
    return file;
  }

  Outer config;
  ConfigFields fields = ConfigFields::of(config);
};

TEST_F(Config, SetsEveryKindOfOptionFromText) {
  fields.set("enabled=off");
  fields.set("rate=2.5e-3");
  fields.set("label=a=b");
  fields.set("inner.count=7");
  fields.set("inner.edge=sobel");
  EXPECT_FALSE(config.enabled);
  EXPECT_EQ(config.rate, 2.5e-3);
  EXPECT_EQ(config.label, "a=b");
  EXPECT_EQ(config.inner.count, 7);
  EXPECT_EQ(config.inner.edge, Edge::Sobel);
}

struct ForFew {
  Inner inner;
  int depth = 3;
  void visit(ConfigFields& fields) {
    static constexpr std::string_view kForEveryone[] = {"inner.edge"};
    fields.expert_but(kForEveryone, [&] {
      fields.group("inner", inner);
      fields.add("depth", depth, {.max = 5});
    });
  }
};

TEST_F(Config, OptionsForExpertsComeLastUnderKeysThatSaySo) {
  struct {
    ForFew few;
    bool late = false;
    void visit(ConfigFields& fields) {
      fields.group("few", few);
      fields.add("late", late, {});
    }
  } outer;
  ConfigFields of_outer = ConfigFields::of(outer);
  std::vector<std::string> keys;
  for (const ConfigField& field : of_outer.all()) keys.push_back(field.key);
  EXPECT_THAT(keys, testing::ElementsAre("few.inner.edge", "late", "few.expert.inner.count", "few.expert.depth"));
  of_outer.set("few.expert.inner.count=9");
  EXPECT_EQ(outer.few.inner.count, 9);
  EXPECT_THAT(error_of([&] { of_outer.set("few.inner.count=9"); }),
              HasSubstr("did you mean 'few.expert.inner.count'?"));
  EXPECT_THAT(error_of([&] { of_outer.set("few.expert.depth=9"); }), HasSubstr("option 'few.expert.depth' is 9"));
}

TEST_F(Config, RefusesANumberOutsideItsRangeAndNamesTheRange) {
  EXPECT_THAT(error_of([&] { fields.set("inner.count=101"); }),
              AllOf(HasSubstr("inner.count"), HasSubstr("101"), HasSubstr("1 .. 100"), HasSubstr("px")));
  EXPECT_THAT(error_of([&] { fields.set("rate=-1"); }), AllOf(HasSubstr("rate"), HasSubstr(">= 0")));
  EXPECT_EQ(config.inner.count, 40);
}

TEST_F(Config, RefusesTextOfTheWrongKind) {
  for (const char* bad :
       {"inner.count=3.5", "inner.count=", "rate=1x", "rate=nan", "enabled=maybe", "inner.edge=roberts"}) {
    EXPECT_NE(error_of([&] { fields.set(bad); }), "no error") << bad;
  }
  EXPECT_THAT(error_of([&] { fields.set("inner.edge=roberts"); }), HasSubstr("canny | sobel"));
  EXPECT_THAT(error_of([&] { fields.set("rate"); }), HasSubstr("key=value"));
}

TEST_F(Config, SuggestsTheNearestKeyForATypingError) {
  EXPECT_THAT(error_of([&] { fields.set("inner.cuont=3"); }), HasSubstr("'inner.count'"));
  EXPECT_THAT(error_of([&] { fields.set("edge=sobel"); }), HasSubstr("'inner.edge'"));
}

TEST_F(Config, LoadsNestedMapsAndDottedKeys) {
  fields.load(write("rate: 5\ninner.count: 9\ninner:\n  edge: sobel\n"));
  EXPECT_EQ(config.rate, 5.0);
  EXPECT_EQ(config.inner.count, 9);
  EXPECT_EQ(config.inner.edge, Edge::Sobel);
}

TEST_F(Config, AcceptsAnEmptyFile) {
  fields.load(write("# nothing\n"));
  EXPECT_EQ(config.rate, 0.1);
}

TEST_F(Config, NamesFileLineAndKeyOfAYamlError) {
  const auto unknown = write("rate: 5\ninner:\n  count: 9\n  egde: sobel\n");
  EXPECT_THAT(error_of([&] { fields.load(unknown); }),
              AllOf(HasSubstr(unknown.string() + ":4"), HasSubstr("inner.egde"), HasSubstr("'inner.edge'")));
  const auto range = write("\nrate: -3\n");
  EXPECT_THAT(error_of([&] { fields.load(range); }), AllOf(HasSubstr(":2"), HasSubstr("rate"), HasSubstr(">= 0")));
  const auto list = write("rate: [1, 2]\n");
  EXPECT_THAT(error_of([&] { fields.load(list); }), AllOf(HasSubstr(":1"), HasSubstr("rate")));
  const auto twice = write("rate: 1\nrate: 2\n");
  EXPECT_THAT(error_of([&] { fields.load(twice); }), AllOf(HasSubstr(":2"), HasSubstr("twice")));
  const auto broken = write("rate: 1\ninner: {count\n");
  EXPECT_THAT(error_of([&] { fields.load(broken); }), HasSubstr("not valid yaml"));
  EXPECT_THAT(error_of([&] { fields.load("/nowhere/x.yaml"); }), HasSubstr("/nowhere/x.yaml"));
}

TEST_F(Config, WritesYamlThatLoadsBackToTheSameValues) {
  config =
      Outer{.enabled = false, .rate = 1.0 / 3.0, .label = "a \"b\": #c \\", .inner = {.count = 3, .edge = Edge::Sobel}};
  const std::string yaml = fields.to_yaml();
  Outer loaded;
  ConfigFields::of(loaded).load(write(yaml));
  EXPECT_EQ(loaded.enabled, config.enabled);
  EXPECT_EQ(loaded.rate, config.rate);
  EXPECT_EQ(loaded.label, config.label);
  EXPECT_EQ(loaded.inner.count, config.inner.count);
  EXPECT_EQ(loaded.inner.edge, config.inner.edge);
  EXPECT_THAT(yaml, AllOf(HasSubstr("[Hz] >= 0"), HasSubstr("how often"), HasSubstr("default 0.1")));
}

TEST_F(Config, DescribesEveryOption) {
  ASSERT_EQ(fields.all().size(), 5u);
  const ConfigField& count = fields.all()[2];
  EXPECT_EQ(count.key, "inner.count");
  EXPECT_EQ(count.type, "int");
  EXPECT_EQ(count.range, "1 .. 100");
  EXPECT_EQ(count.default_value, "40");
  EXPECT_EQ(fields.all()[3].type, "canny | sobel");
}

TEST(ConfigDeclaration, RefusesTheSameKeyTwiceAndAValueOutOfRange) {
  int value = 5;
  ConfigFields fields;
  fields.add("a", value, {});
  EXPECT_THROW(fields.add("a", value, {}), CheckError);
  EXPECT_THROW(fields.add("b", value, {.max = 4}), InputError);
}

}  // namespace
}  // namespace edged
