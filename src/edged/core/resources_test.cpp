// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/resources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace edged {
namespace {

namespace fs = std::filesystem;

class Resources : public testing::Test {
 protected:
  Resources() : folder_(fs::temp_directory_path() / ("edged_resources_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    for (const char* name : {"mine.yaml", "davis240c_ecd.yaml", "notes.txt"}) std::ofstream(folder_ / name) << "#\n";
    ::setenv("EDGED_RIGS", folder_.c_str(), 1);
  }
  ~Resources() override {
    ::unsetenv("EDGED_RIGS");
    fs::remove_all(folder_);
  }

  fs::path folder_;
};

TEST_F(Resources, WhatTheEnvironmentNamesComesFirst) {
  EXPECT_EQ(resource_folders("rigs").front(), fs::canonical(folder_));
  EXPECT_EQ(find_resource("rigs", "mine", ".yaml"), fs::canonical(folder_ / "mine.yaml"));
  EXPECT_EQ(find_resource("rigs", "davis240c_ecd", ".yaml")->parent_path(), fs::canonical(folder_));
  EXPECT_EQ(find_resource("rigs", "notes", ".yaml"), std::nullopt);
}

TEST_F(Resources, WhatComesWithTheProgramIsFoundToo) {
  std::vector<std::string> names;
  for (const fs::path& file : resources("rigs", ".yaml")) names.push_back(file.stem());
  EXPECT_THAT(names, testing::IsSupersetOf({"davis240c_ecd", "mine", "hku_mono"}));
  EXPECT_TRUE(std::ranges::is_sorted(names));
  EXPECT_EQ(std::ranges::count(names, "davis240c_ecd"), 1);
  EXPECT_TRUE(find_resource("depth", "small", ".onnx"));
}

TEST_F(Resources, NoFolderIsNoError) {
  ::setenv("EDGED_RIGS", "/nowhere", 1);
  EXPECT_NE(resource_folders("rigs").front(), "/nowhere");
  EXPECT_TRUE(resource_folders("none of this kind").empty());
  EXPECT_EQ(find_resource("none of this kind", "mine", ".yaml"), std::nullopt);
}

}  // namespace
}  // namespace edged
