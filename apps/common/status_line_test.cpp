// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/status_line.hpp"

#include <gtest/gtest.h>

#include "common/text.hpp"

namespace edged {
namespace {

TEST(StatusLine, CutsItsTextToOneLineOfTheTerminal) {
  EXPECT_EQ(fit_columns("abc", 10), "abc");
  EXPECT_EQ(fit_columns("abcdef", 3), "abc");
  EXPECT_EQ(fit_columns("ab\ncd", 10), "ab");
}

TEST(Wrapped, BreaksBetweenWordsAndIndentsWhatFollows) {
  const std::string word(30, 'x'), line = word + " " + word + " " + word;
  EXPECT_EQ(wrapped(word, 4), word);
  EXPECT_EQ(wrapped(line, 4), word + " " + word + "\n    " + word);
  const std::string endless(100, 'y');
  EXPECT_EQ(wrapped(endless, 4), endless);
  EXPECT_EQ(wrapped("    " + endless + " z", 4), "    " + endless + "\n    z");
}

TEST(StatusLine, TellsTheTimeLeftOnceTheSpeedIsKnown) {
  EXPECT_EQ(share_text(std::nullopt, 10.0), "");
  EXPECT_EQ(share_text(0.5, 0.1), "50 %  ");
  EXPECT_EQ(share_text(0.005, 100.0), "0 %  ");
  EXPECT_EQ(share_text(0.25, 30.0), "25 %, 1:30 left  ");
  EXPECT_EQ(share_text(0.01, 100.0), "1 %, 2:45:00 left  ");
  EXPECT_EQ(share_text(1.0, 100.0), "100 %, 0:00 left  ");
}

TEST(StatusLine, KnowsTheShareOfARecordingWhoseEndIsKnown) {
  DatasetInfo info;
  info.begin = timestamp_from_ns(1'000'000'000);
  EXPECT_EQ(share_done(timestamp_from_ns(2'000'000'000), info), std::nullopt);
  info.end = timestamp_from_ns(5'000'000'000);
  EXPECT_EQ(share_done(timestamp_from_ns(2'000'000'000), info), 0.25);
  EXPECT_EQ(share_done(timestamp_from_ns(9'000'000'000), info), 1.0);
}

TEST(StatusLine, IsNeverDueWhenQuiet) { EXPECT_FALSE(StatusLine(true).due()); }

TEST(SiNumber, TakesThePrefixThatFits) {
  EXPECT_EQ(si_number(12.0), "12 ");
  EXPECT_EQ(si_number(12345.0), "12.3 k");
  EXPECT_EQ(si_number(1234567.0), "1.23 M");
  EXPECT_EQ(si_number(2.5e9), "2.50 G");
}

}  // namespace
}  // namespace edged
