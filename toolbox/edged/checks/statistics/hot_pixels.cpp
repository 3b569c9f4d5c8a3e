// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/hot_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace edged {
namespace {

constexpr double kLeastSigmas = 6.0;
constexpr double kFlood = 0.01;  // of all events
// By texture, neighbours differ by about half of their events; by noise, by the square root of that number.
constexpr float kTextureSpread = 0.5F;

}  // namespace

/// Windows without any event are ignored: the recording probably has a gap there.
void HotPixelFinder::end_window(Timestamp t) {
  if (window_end_ == Timestamp::min()) {
    const std::size_t pixels = place(0, grid_.height);
    total_.resize(pixels), window_.resize(pixels), excess_.resize(pixels);
    window_end_ = t + kWindow;
    first_ = t;
    return;
  }
  const double seconds = to_seconds(kWindow);
  for (int y = 0; y < extent_.height; ++y)
    for (int x = 0; x < extent_.width; ++x) excess_[place(x, y)] = excess_with_window(x, y, seconds);
  judged_ = extent_;
  silent_weight_ += static_cast<float>(seconds * seconds);
  std::ranges::fill(window_, std::uint16_t{0});
  window_end_ += ((t - window_end_) / kWindow + 1) * kWindow;
}

HotPixelFinder::Excess HotPixelFinder::excess_with_window(int x, int y, double seconds) const {
  const auto dt = static_cast<float>(seconds);
  const auto beside = static_cast<float>(neighbours(x, y));
  const float variance = 1.0F + beside + kTextureSpread * kTextureSpread * beside * beside;
  Excess excess = excess_[place(x, y)];
  if (x >= judged_.width || y >= judged_.height) excess.weight = silent_weight_;
  const float sum = dt * (static_cast<float>(window_[place(x, y)]) - beside) / variance, weight = dt * dt / variance;
  excess.sum += sum;
  excess.weight += weight;
  if (sum > excess.most_sum) excess.most_sum = sum, excess.most_weight = weight;
  return excess;
}

/// Events of the second most active of the eight neighbours: an edge or moving object has two or more of them, and a
/// hot pixel may have another one beside it.
int HotPixelFinder::neighbours(int x, int y) const {
  int most = 0, second = 0, count = 0;
  for (int v = std::max(0, y - 1); v < std::min(extent_.height, y + 2); ++v)
    for (int u = std::max(0, x - 1); u < std::min(extent_.width, x + 2); ++u) {
      if (u == x && v == y) continue;
      const int events = window_[place(u, v)];
      second = std::max(second, std::min(most, events));
      most = std::max(most, events);
      ++count;
    }
  return count == 8 ? second : most;
}

std::vector<HotPixel> HotPixelFinder::result() const {
  std::vector<HotPixel> hot;
  if (last_ == Timestamp::min()) return hot;
  // The last window is a part of one: a tenth is enough to count.
  const double seconds = std::max(to_seconds(last_ - (window_end_ - kWindow)), 0.1 * to_seconds(kWindow));
  for (int y = 0; y < extent_.height; ++y)
    for (int x = 0; x < extent_.width; ++x) {
      const Excess excess = excess_with_window(x, y, seconds);
      const double rate_hz = excess.sum / excess.weight, sigmas = excess.sum / std::sqrt(excess.weight);
      const std::uint32_t events = total_[place(x, y)];
      const bool flood = events > kFlood * static_cast<double>(events_);
      if (rate_hz >= kLeastHz && sigmas >= kLeastSigmas && (excess.without_most_hz() >= kLeastHz || flood))
        hot.push_back({x, y, events, rate_hz});
    }
  std::ranges::stable_sort(hot, std::greater<>(), &HotPixel::rate_hz);
  return hot;
}

std::size_t HotPixelFinder::active() const {
  return static_cast<std::size_t>(std::ranges::count_if(total_, [](std::uint32_t count) { return count > 0; }));
}

}  // namespace edged
