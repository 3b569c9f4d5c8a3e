// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/archive/source_path.hpp"

#include <gtest/gtest.h>

#include "edged/io/test_support.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

std::string unpacked(const SourcePath& file) { return std::string(as_text(file.read(100))); }

TEST(ZipWriter, PacksAFolderUnderItsNameAndReplacesAnEarlierArchiveInIt) {
  const TempFolder folder;
  folder.write("run/a.txt", "first");
  folder.write("run/sub/b.txt", "second");
  const fs::path file = folder.path() / "run" / "all.zip";
  for (int repeat = 0; repeat < 2; ++repeat) zip_folder(file, folder.path() / "run/");
  const SourcePath run = SourcePath::in_archive(file) / "run";
  EXPECT_EQ(run.names(), (std::vector<std::string>{"a.txt", "sub"}));
  EXPECT_EQ(unpacked(run / "a.txt"), "first");
  EXPECT_EQ(unpacked(run / "sub/b.txt"), "second");
}

TEST(ZipWriter, SaysWhichFileCannotBeWritten) {
  const TempFolder folder;
  folder.write("run/a.txt", "first");
  const fs::path file = folder.path() / "none" / "all.zip";
  const std::string refusal = input_error([&] { zip_folder(file, folder.path() / "run"); });
  EXPECT_NE(refusal.find(file.string() + ": cannot be written"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace edged
