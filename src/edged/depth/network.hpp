// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A depth network from an ONNX file: voxel grid in, z-depth in metres out. One thread, deterministic.
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace edged {

/// The properties of a model, from the json file beside it.
struct DepthModel {
  std::string name, note;
  int bins = 5;
  int shrink = 1;         ///< the network input is the mean of shrink x shrink pixels of the grid
  int multiple = 8;       ///< sides of its input are multiples of this
  double d_max_m = 80.0;  ///< depth = d_max exp(-alpha (1 - output))
  double alpha = 3.70378;
  double focal_px = 0.0;   ///< that of the camera in training; 0: not known, depths are not scaled
  double window_s = 0.05;  ///< length of the windows in training
  double sigma_ln = 0.7;   ///< rms error of ln depth to expect
  struct State {
    std::string name;  ///< input NAME_in, output NAME_out
    int channels = 0;
    int divisor = 1;  ///< divides the input's sides
  };
  std::vector<State> states;  ///< empty: not recurrent
};

/// NAME (core/resources.hpp: depth/NAME.onnx) or the path of an ONNX file. Throws an InputError that lists the known
/// models.
std::filesystem::path find_depth_model(const std::string& name_or_path);

/// Reads MODEL.json for MODEL.onnx. Throws InputError naming the file and key.
DepthModel read_depth_model(const std::filesystem::path& onnx);

class DepthNetwork {
 public:
  /// Throws InputError when a file is missing, is no ONNX or does not fit its json.
  explicit DepthNetwork(const std::filesystem::path& onnx);
  ~DepthNetwork();

  const DepthModel& model() const { return model_; }

  /// z-depth [m], CV_32FC1, of every pixel of a normalised grid (events/voxel_grid.hpp) of any size that is at least
  /// `shrink` times `multiple` on both sides. A recurrent network continues from the state of the previous window,
  /// unless the size changed.
  cv::Mat infer(const cv::Mat& grid);

  /// Resets the state.
  void reset() { states_.clear(); }

 private:
  cv::Mat forward(const cv::Mat& padded);

  struct Runtime;  // cv::dnn stays in network.cpp

  DepthModel model_;
  std::filesystem::path file_;
  std::unique_ptr<Runtime> runtime_;
  std::vector<cv::Mat> states_;
};

}  // namespace edged
