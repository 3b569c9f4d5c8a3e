// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// In place of network.cpp where the library is built without opencv_dnn.
#include "edged/core/check.hpp"
#include "edged/depth/network.hpp"

namespace edged {

struct DepthNetwork::Runtime {};

DepthNetwork::DepthNetwork(const std::filesystem::path& onnx) {
  throw InputError::format(
      "{}: built without depth networks (EDGED_DEPTH_NETWORK=OFF): set depth.source = landmarks or constant, and "
      "estimator.depth_factor.enabled = false",
      onnx.string());
}

DepthNetwork::~DepthNetwork() = default;

cv::Mat DepthNetwork::infer(const cv::Mat&) { EDGED_CHECK(false, "there is no network"); }

}  // namespace edged
