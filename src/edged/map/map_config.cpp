// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options/map.hpp"

namespace edged {

void KeyframeMapConfig::visit(ConfigFields& fields) {
  fields.add("max_covered", max_covered,
             {"", 0, 1, "A keyframe is not added when the map covers a larger share of its view."});
  fields.add("min_points", min_points, {"", 4, 1000, "A keyframe with fewer accurate points is not added."});
  fields.add("max_points", max_points, {"", 4, 1000, "Largest number of points per keyframe."});
  fields.add("min_known_s", min_known_s,
             {"s", 0, 100,
              "No keyframe is added earlier than this after a start, because its scale is inaccurate; but after a loss "
              "where the map is empty."});
  fields.add("min_age_s", min_age_s,
             {"s", 0, 100, "Younger keyframes are not matched, because the window has their points."});
  fields.add(
      "max_keyframes", max_keyframes,
      {"", 2, 10000, "Largest number of keyframes. Beyond it the one that was not matched for longest is removed."});
}

void MapFilterConfig::visit(ConfigFields& fields) {
  fields.add("pixel_sigma", pixel_sigma, {"px", 0.01, 100, "Standard deviation of a matched point."});
  fields.add("min_observations", min_observations, {"", 3, 1000, "A match with fewer points is rejected."});
  fields.add("min_found_share", min_found_share,
             {"", 0, 1, "A match with a smaller share of the expected points is rejected."});
  fields.add("max_misfit", max_misfit,
             {"sigma", 0.01, 100, "A match with a larger median residual after the fit is rejected."});
}

void MapConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled, {.effect = "Match the map and correct the pose."});
  fields.add("localize_only", localize_only,
             {.effect = "Only localize in a loaded map, which never changes: the status is Initializing until the body "
                        "is relocalized in it, and Lost from a loss on until it is again."});
  fields.add("min_interval_s", min_interval_s, {"s", 0, 10, "Time between images that are matched with the map."});
  fields.add("max_observations", max_observations,
             {"", 8, 1000, "Largest number of points that are matched in an image. More cost time."});
  fields.add("search_px", search_px,
             {"px", 1, 50, "Upper bound of the search radius, which is 3 sigma of the prediction."});
  fields.group("patch", patch);
  fields.group("keyframes", keyframes);
  fields.group("filter", filter);
}

}  // namespace edged
