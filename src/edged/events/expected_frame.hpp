// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The event frame that an event camera in the place of a standard camera would give: with it, frames and event frames
// are matched with each other.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// Events occur where brightness changes: its logarithm by the slope along the image motion, without its sign. frame,
/// and the result in its pixels: CV_8UC1; the scale of the result follows its content. T_later_now: the camera now to
/// the camera a short time later, of which only the direction of the image motion counts; depth: z-depth of the scene
/// [m]. Without a known motion: the slope in its steepest direction.
cv::Mat expected_event_frame(const cv::Mat& frame, const CameraModel& camera, const std::optional<SE3>& T_later_now,
                             double depth);

}  // namespace edged
