// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/binning.hpp"

#include <cstdint>
#include <vector>

namespace edged {

CameraModel binned(const CameraModel& camera, int n) {
  if (n == 1) return camera;
  const int width = camera.width() / n, height = camera.height() / n;
  const auto centre = [n](double at) { return (at + 0.5) / n - 0.5; };
  const CameraModel coarse(width, height, camera.fx() / n, camera.fy() / n, centre(camera.cx()), centre(camera.cy()),
                           camera.distortion(), camera.coefficients());
  if (!camera.is_masked()) return coarse;
  std::vector<std::uint8_t> used(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 1);
  for (int y = 0; y < height * n; ++y)
    for (int x = 0; x < width * n; ++x)
      if (!camera.uses(x, y)) used[static_cast<std::size_t>((y / n) * width + x / n)] = 0;
  return coarse.masked(used);
}

int bin_for(int width, int widest_px) {
  int n = 1;
  while (width / n > widest_px) n *= 2;
  return n;
}

}  // namespace edged
