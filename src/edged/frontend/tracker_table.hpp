// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The table of kinds of trackers, which the option tracker.kind follows.
#pragma once

#include <memory>
#include <string>

#include "edged/frontend/tracker.hpp"

namespace edged {

/// Of the kind in config; arguments as for FeatureTracker.
std::unique_ptr<FeatureTracker> make_tracker(std::string camera_name, const CameraModel& camera,
                                             const TrackerConfig& config);

}  // namespace edged
