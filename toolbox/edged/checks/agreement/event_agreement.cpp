// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/event_agreement.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "edged/camera/field_of_view.hpp"

namespace edged {
namespace {

constexpr int kMostComparisons = 12, kFewestComparisons = 6;
constexpr Duration kBetweenPictures = std::chrono::milliseconds(500);
constexpr double kLeastFilled = 0.05, kMostFilled = 0.2;  // a pixel: with fewer there is no edge, with more it is wide
constexpr int kPictureColumns = 64;                       // of the pictures that are compared
constexpr int kAreaCells = 7;                             // of their cells; details are smaller
// Unrelated pictures correlate by one over the root of their independent cells, of which neighbours make about 800 of
// 64 x 48; two such numbers differ by 0.05. Three times that. (Flights of the simulator: 0.15 to 0.52 as given, at most
// 0.03 when changed.)
constexpr double kClearlyCloser = 0.15;
// The best of hundreds of shifts is 0.1 closer by chance.
constexpr double kClearlyMoved = 0.25;
constexpr int kMostMoved = 16;  // cells, each way

struct Change {
  int flip;  ///< of cv::flip
  const char* text;
};
constexpr Change kChanges[] = {{-1, "turned by 180 deg"}, {1, "mirrored left to right"}, {0, "mirrored top to bottom"}};

/// Without what is larger than an area: light and contrast differ over the image.
cv::Mat details_of(const cv::Mat& image) {
  cv::Mat cells, areas;
  cv::resize(image, cells, cv::Size(kPictureColumns, kPictureColumns * image.rows / image.cols), 0, 0, cv::INTER_AREA);
  cv::blur(cells, areas, cv::Size(kAreaCells, kAreaCells));
  return cells - areas;
}

/// Products of a with b moved by -kMostMoved to kMostMoved cells.
cv::Mat shifted_products(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat wider, products;
  cv::copyMakeBorder(a, wider, kMostMoved, kMostMoved, kMostMoved, kMostMoved, cv::BORDER_CONSTANT, 0.0);
  cv::matchTemplate(wider, b, products, cv::TM_CCORR);
  return products;
}

}  // namespace

EventAgreement::EventAgreement(std::span<const RigCamera> cameras) {
  const auto events = std::ranges::find(cameras, Modality::Events, &RigCamera::modality);
  const auto frames = std::ranges::find(cameras, Modality::Frames, &RigCamera::modality);
  if (events == cameras.end() || frames == cameras.end() || !is_same_lens(*events, *frames)) return;
  events_ = *events;
  frames_ = frames->name;
  counts_ = cv::Mat::zeros(events->model.height(), events->model.width(), CV_32F);
  shifted_ = cv::Mat::zeros(2 * kMostMoved + 1, 2 * kMostMoved + 1, CV_32F);
}

void EventAgreement::add(const Measurement& measurement) {
  if (!events_ || compared_ == kMostComparisons) return;
  const auto* batch = std::get_if<EventBatch>(&measurement);
  if (batch && batch->camera == events_->name && !batch->events.empty() && batch->events.back().t >= due_)
    count(*batch);
  if (const auto* frame = std::get_if<Frame>(&measurement); frame && frame->camera == frames_) compare(*frame);
}

void EventAgreement::count(const EventBatch& batch) {
  for (const Event& event : batch.events) {
    if (event.x >= counts_.cols || event.y >= counts_.rows) continue;
    if (static_cast<double>(counted_) >= kMostFilled * static_cast<double>(counts_.total())) {
      counts_.setTo(0.0F);
      counted_ = 0;
    }
    counts_.at<float>(event.y, event.x) += 1.0F;
    ++counted_;
  }
}

void EventAgreement::compare(const Frame& frame) {
  if (static_cast<double>(counted_) < kLeastFilled * static_cast<double>(counts_.total())) return;
  if (frame.image.size() != counts_.size()) return;
  cv::Mat dx, dy, slopes, changed;
  cv::Sobel(frame.image, dx, CV_32F, 1, 0);
  cv::Sobel(frame.image, dy, CV_32F, 0, 1);
  cv::magnitude(dx, dy, slopes);
  const cv::Mat edges = details_of(slopes), events = details_of(counts_);
  const double norm = std::max(cv::norm(edges) * cv::norm(events), 1e-9);  // of any change
  correlations_[0] += edges.dot(events) / norm;
  for (std::size_t i = 0; i < std::size(kChanges); ++i) {
    cv::flip(events, changed, kChanges[i].flip);
    correlations_.at(i + 1) += edges.dot(changed) / norm;
  }
  shifted_ += shifted_products(edges, events) / norm;
  ++compared_;
  due_ = frame.t + kBetweenPictures;
  counts_.setTo(0.0F);
  counted_ = 0;
}

std::optional<std::string> EventAgreement::better() const {
  if (compared_ < kFewestComparisons) return std::nullopt;
  const auto best = std::ranges::max_element(correlations_);
  if (*best - correlations_[0] >= kClearlyCloser * compared_) return kChanges[best - correlations_.begin() - 1].text;
  double most = 0.0;
  cv::Point at;
  cv::minMaxLoc(shifted_, nullptr, &most, nullptr, &at);
  if (most - correlations_[0] < kClearlyMoved * compared_) return std::nullopt;
  const double cell_px = static_cast<double>(counts_.cols) / kPictureColumns;
  return fmt::format("moved by about ({:+.0f}, {:+.0f}) px", cell_px * (at.x - kMostMoved),
                     cell_px * (at.y - kMostMoved));
}

}  // namespace edged
