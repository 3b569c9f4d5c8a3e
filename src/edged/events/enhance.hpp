// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Enhancement of event frames (paper Algorithm 1): blur, equalise, sharpen, find edges, thin them, blend. All gains are
// fixed and do not depend on the content of the frame, so that brightness stays constant for the tracker.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/options/events.hpp"

namespace edged {

/// Algorithm 1 on a CV_8UC1 event frame: saturate(event_weight * I_event + edge_weight * I_edge), CV_8UC1. With
/// EdgeMethod::None the frame itself, not a copy. The config must be valid.
cv::Mat enhance(const cv::Mat& event_frame, const EnhanceConfig& config);

}  // namespace edged
