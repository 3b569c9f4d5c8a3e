// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Takes the place of OpenCV's optical flow (LD_PRELOAD) for scripts/test_arm64.sh: keeps what it finds in the file that
// EDGED_FLOW_TAPE names, or where that file is there, gives what it holds instead: the flow of one machine on another.
#include <dlfcn.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

namespace {

struct Flow {
  std::uint64_t inputs = 0;  ///< hash of images, points and seeds
  std::vector<cv::Point2f> points;
  std::vector<uchar> found;
};

class Tape {
 public:
  Tape() : name_(std::getenv("EDGED_FLOW_TAPE")), plays_(std::filesystem::exists(name_)) {
    file_.open(name_, std::ios::binary | (plays_ ? std::ios::in : std::ios::out));
  }
  ~Tape() {
    if (plays_) {
      std::fprintf(stderr,
                   "flow_tape: of %zu coordinates from equal images, points and seeds %zu differ, by up to %.2g px\n",
                   compared_, different_, largest_px_);
    }
  }

  void pass(Flow& own) {
    std::uint64_t size = own.points.size();
    if (!plays_) {
      file_.write(reinterpret_cast<const char*>(&own.inputs), sizeof own.inputs);
      file_.write(reinterpret_cast<const char*>(&size), sizeof size);
      file_.write(reinterpret_cast<const char*>(own.points.data()), std::streamsize(size * sizeof(cv::Point2f)));
      file_.write(reinterpret_cast<const char*>(own.found.data()), std::streamsize(size));
      return;
    }
    Flow kept = own;
    file_.read(reinterpret_cast<char*>(&kept.inputs), sizeof kept.inputs);
    file_.read(reinterpret_cast<char*>(&size), sizeof size);
    if (!file_ || size != own.points.size()) {
      std::fprintf(stderr, "flow_tape: FAILED: other tracks than on the tape\n");
      std::abort();
    }
    file_.read(reinterpret_cast<char*>(kept.points.data()), std::streamsize(size * sizeof(cv::Point2f)));
    file_.read(reinterpret_cast<char*>(kept.found.data()), std::streamsize(size));
    if (kept.inputs == own.inputs) compare(own, kept);
    own = kept;
  }

 private:
  void compare(const Flow& own, const Flow& kept) {
    for (std::size_t i = 0; i < own.points.size(); ++i) {
      if (own.found[i] == 0 || kept.found[i] == 0) continue;
      const cv::Point2f d = own.points[i] - kept.points[i];
      compared_ += 2;
      different_ += std::size_t(d.x != 0.0F) + std::size_t(d.y != 0.0F);
      largest_px_ = std::max({largest_px_, std::abs(d.x), std::abs(d.y)});
    }
  }

  std::string name_;
  bool plays_;
  std::fstream file_;
  std::size_t compared_ = 0, different_ = 0;
  float largest_px_ = 0.0F;
};

/// FNV-1a.
void hash(const cv::Mat& image, std::uint64_t& h) {
  for (int y = 0; y < image.rows; ++y) {
    const uchar* row = image.ptr(y);
    for (std::size_t i = 0; i < std::size_t(image.cols) * image.elemSize(); ++i) h = (h ^ row[i]) * 1099511628211U;
  }
}

}  // namespace

void cv::calcOpticalFlowPyrLK(InputArray from, InputArray to, InputArray points, InputOutputArray next,
                              OutputArray status, OutputArray err, Size window, int levels, TermCriteria stop,
                              int flags, double min_eigenvalue) {
  static Tape tape;
  static const auto original = reinterpret_cast<decltype(&cv::calcOpticalFlowPyrLK)>(
      dlsym(RTLD_NEXT,
            "_ZN2cv20calcOpticalFlowPyrLKERKNS_11_InputArrayES2_S2_RKNS_17_InputOutputArrayERKNS_12_OutputArrayES8_"
            "NS_5Size_IiEEiNS_12TermCriteriaEid"));
  Flow flow{14695981039346656037U, {}, {}};
  for (const _InputArray* pyramid : {&from, &to}) {
    std::vector<Mat> images;
    pyramid->getMatVector(images);
    for (const Mat& image : images) hash(image, flow.inputs);
  }
  hash(points.getMat(), flow.inputs);
  hash(next.getMat(), flow.inputs);
  original(from, to, points, next, status, err, window, levels, stop, flags, min_eigenvalue);
  Mat next_points = next.getMat(), found = status.getMat();
  flow.points.assign(next_points.ptr<Point2f>(), next_points.ptr<Point2f>() + next_points.total());
  flow.found.assign(found.ptr(), found.ptr() + found.total());
  tape.pass(flow);
  std::copy(flow.points.begin(), flow.points.end(), next_points.ptr<Point2f>());
  std::copy(flow.found.begin(), flow.found.end(), found.ptr());
}
