// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Enhancement of event frames (paper Algorithm 1): blur, equalise, sharpen, find edges, thin them, blend. All gains are
// fixed and do not depend on the content of the frame, so that brightness stays constant for the tracker.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/options/events.hpp"

namespace edged {

/// A row of the table of edge filters.
struct EdgeFilter {
  EdgeMethod method;
  std::string_view name;                                               ///< the option's choice
  cv::Mat (*find)(const cv::Mat& image, const EnhanceConfig& config);  ///< I_edge; null: no enhancement
};
std::span<const EdgeFilter> edge_filters();

/// Algorithm 1 on a CV_8UC1 event frame: saturate(event_weight * I_event + edge_weight * I_edge), CV_8UC1. With
/// EdgeMethod::None the frame itself, not a copy. The config must be valid.
cv::Mat enhance(const cv::Mat& event_frame, const EnhanceConfig& config);

struct EnhanceStage {
  std::string name;  ///< fit for a file name
  cv::Mat image;     ///< CV_8UC1
};

/// The image after each step, in order: event_frame, blur, clahe, sharpened, edge, eroded, result. Steps that are off
/// are left out; EdgeMethod::None gives event_frame and result.
std::vector<EnhanceStage> enhancement_stages(const cv::Mat& event_frame, const EnhanceConfig& config);

}  // namespace edged
