// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/external_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "edged/checks/check_groups.hpp"

namespace edged {
namespace {

/// Heights at 10 Hz for 20 s.
ExternalStatistics statistics_of(const std::function<double(double)>& height_m, double sigma_m = 0.0) {
  ExternalCollector collector;
  for (int i = 0; i < 200; ++i)
    collector.add(HeightSample{timestamp_from_seconds(0.1 * i), height_m(0.1 * i), sigma_m});
  return collector.result();
}

std::vector<Finding> findings(const ExternalStatistics& statistics) {
  RecordingStatistics recording;
  recording.external["height"] = statistics;
  Findings out;
  check_external({recording}, out);
  return out.list;
}

bool says(const ExternalStatistics& statistics, Severity severity, const std::string& text) {
  return std::ranges::any_of(findings(statistics), [&](const Finding& finding) {
    return finding.severity == severity && finding.text.find(text) != std::string::npos;
  });
}

double noisy(double t, double noise) {
  static std::mt19937 random(1);
  return 0.5 * t + std::normal_distribution(0.0, noise)(random);
}

TEST(ExternalStatistics, FindsRateRangeAndNoiseOfAClimb) {
  const ExternalStatistics statistics = statistics_of([](double t) { return noisy(t, 0.2); }, 0.2);
  EXPECT_NEAR(statistics.stream.rate_hz(), 10.0, 0.1);
  EXPECT_NEAR(statistics.most[0] - statistics.least[0], 10.0, 1.5);
  EXPECT_NEAR(statistics.noise, 0.2, 0.03);
  EXPECT_NEAR(statistics.sigma, 0.2, 1e-9);
  ASSERT_EQ(findings(statistics).size(), 1U);
  EXPECT_TRUE(says(statistics, Severity::Good, "height at 10 Hz"));
}

TEST(ExternalStatistics, AFrozenSensorIsFound) {
  EXPECT_TRUE(says(statistics_of([](double t) { return t < 8.0 ? noisy(t, 0.1) : 3.0; }), Severity::Warning,
                   "the same numbers"));
}

TEST(ExternalStatistics, MillimetresAreFoundByTheSpeedOfTheClimb) {
  EXPECT_TRUE(says(statistics_of([](double t) { return 1000.0 * noisy(t, 0.01); }), Severity::Error, "in a second"));
}

TEST(ExternalStatistics, ASigmaThatIsTooSmallIsFound) {
  EXPECT_TRUE(
      says(statistics_of([](double t) { return noisy(t, 0.2); }, 0.02), Severity::Warning, "its samples state"));
}

TEST(ExternalStatistics, GapsAndSlowSensorsAreFound) {
  ExternalCollector holed, slow;
  for (int i = 0; i < 200; ++i)
    if (i < 50 || i > 100) holed.add(HeightSample{timestamp_from_seconds(0.1 * i), 0.01 * i, 0.0});
  for (int i = 0; i < 20; ++i) slow.add(HeightSample{timestamp_from_seconds(1.0 * i), 0.01 * i, 0.0});
  EXPECT_TRUE(says(holed.result(), Severity::Warning, "1 gaps"));
  EXPECT_TRUE(says(slow.result(), Severity::Warning, "at 1.0 Hz"));
}

}  // namespace
}  // namespace edged
