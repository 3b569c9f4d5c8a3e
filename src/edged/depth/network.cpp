// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/network.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "edged/core/check.hpp"
#include "edged/events/voxel_grid.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

/// OpenCV also prints its exceptions to the terminal; the exception is enough.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

}  // namespace

struct DepthNetwork::Runtime {
  cv::dnn::Net net;
};

DepthNetwork::DepthNetwork(const fs::path& onnx) : file_(onnx), runtime_(std::make_unique<Runtime>()) {
  if (!fs::is_regular_file(onnx))
    throw InputError::format("{}: there is no such file; `edged depth fetch` lists where to get models", onnx.string());
  model_ = read_depth_model(onnx);
  const QuietOpenCv quiet;
  try {
    runtime_->net = cv::dnn::readNetFromONNX(onnx.string());
    runtime_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    runtime_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    const int side = 2 * model_.shrink * model_.multiple;
    infer(cv::Mat(std::vector<int>{1, model_.bins, side, side}, CV_32FC1, cv::Scalar(0)));
  } catch (const cv::Exception& e) {
    throw InputError::format("{}: cannot be used as a depth network ({}); make it with tools/depth", onnx.string(),
                             first_line(e.err));
  }
  reset();
}

DepthNetwork::~DepthNetwork() = default;

cv::Mat DepthNetwork::forward(const cv::Mat& padded) {
  cv::dnn::Net& net = runtime_->net;
  const int height = padded.size[2], width = padded.size[3];
  std::vector<cv::String> names{"depth"};
  net.setInput(padded, "events");
  for (std::size_t i = 0; i < model_.states.size(); ++i) {
    const DepthModel::State& state = model_.states[i];
    const std::vector<int> size{1, state.channels, height / state.divisor, width / state.divisor};
    if (states_.size() <= i) states_.emplace_back();
    if (states_[i].dims != 4 || states_[i].size[2] != size[2] || states_[i].size[3] != size[3])
      states_[i] = cv::Mat(size, CV_32FC1, cv::Scalar(0));
    net.setInput(states_[i], state.name + "_in");
    names.push_back(state.name + "_out");
  }
  std::vector<cv::Mat> outputs;
  net.forward(outputs, names);
  for (std::size_t i = 0; i < states_.size(); ++i)
    states_[i] = outputs[i + 1].clone();  // the network reuses its memory
  return outputs[0];
}

cv::Mat DepthNetwork::infer(const cv::Mat& grid) {
  EDGED_CHECK(grid.dims == 4 && grid.size[1] == model_.bins, "a grid of {} dimensions for {} bins", grid.dims,
              model_.bins);
  const int height = grid.size[2], width = grid.size[3], multiple = model_.shrink * model_.multiple;
  const cv::Mat padded = pad_voxels(grid, multiple);
  const cv::Mat input = model_.shrink > 1 ? shrink_voxels(padded, model_.shrink) : padded;
  const cv::Mat output = forward(input);
  if (output.dims != 4 || output.size[1] != 1 || output.size[2] != input.size[2] || output.size[3] != input.size[3])
    throw InputError::format("{}: its output 'depth' does not have the size of its input; make it with tools/depth",
                             file_.string());
  const cv::Mat log_depth(output.size[2], output.size[3], CV_32FC1, const_cast<float*>(output.ptr<float>()));
  const int left = padding_to_multiple(width, multiple).before, top = padding_to_multiple(height, multiple).before;
  cv::Mat depth(height, width, CV_32FC1);
  for (int y = 0; y < height; ++y) {
    const float* from = log_depth.ptr<float>((y + top) / model_.shrink);
    for (int x = 0; x < width; ++x)
      depth.at<float>(y, x) =
          static_cast<float>(model_.d_max_m * std::exp(model_.alpha * (from[(x + left) / model_.shrink] - 1.0)));
  }
  return depth;
}

}  // namespace edged
