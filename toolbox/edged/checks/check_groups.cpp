// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/check_groups.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace edged {
namespace {

void tell_repairs(const CheckInput& input, Findings& out) {
  for (const auto& [kind, count] : input.recording.repairs)
    out.note(fmt::format("repaired while reading: {} ({})", kind, count));
}

constexpr Check kGroups[] = {check_streams, check_imu,   check_pictures, check_external,
                             check_cameras, check_truth, tell_repairs};

}  // namespace

bool is_unusable(Unusable what, const std::vector<Finding>& findings) {
  return std::ranges::find(findings, what, &Finding::unusable) != findings.end();
}

std::vector<Finding> check_recording(const CheckInput& input) {
  Findings out;
  for (const Check group : kGroups) group(input, out);
  return out.list;
}

}  // namespace edged
