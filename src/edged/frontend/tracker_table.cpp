// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/tracker_table.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/frontend/trackers/descriptor_tracker.hpp"
#include "edged/frontend/trackers/klt_tracker.hpp"

namespace edged {
namespace {

using MakeTracker = std::unique_ptr<FeatureTracker>(std::string, const CameraModel&, const TrackerConfig&);

template <typename Tracker>
std::unique_ptr<FeatureTracker> make(std::string camera_name, const CameraModel& camera, const TrackerConfig& config) {
  return std::make_unique<Tracker>(std::move(camera_name), camera, config);
}

struct TrackerRow {
  TrackerKind kind;
  std::string_view name;  ///< the option's choice
  MakeTracker* make;
};

constexpr TrackerRow kTrackers[] = {{TrackerKind::Klt, "klt", make<KltTracker>},
                                    {TrackerKind::Descriptors, "descriptors", make<DescriptorTracker>}};

}  // namespace

void ReferencePatchConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled,
             {.effect = "Align features to their reference patches, which removes the drift of optical flow."});
  patch.visit(fields);
}

void TrackerConfig::visit(ConfigFields& fields) {
  std::vector<std::pair<std::string_view, TrackerKind>> kinds;
  for (const TrackerRow& row : kTrackers) kinds.emplace_back(row.name, row.kind);
  fields.choice(
      "kind", kind, kinds,
      {.effect = "How features are found in the next image: by optical flow (KLT) and reference patches, or by "
                 "ORB descriptors of corners."});
  fields.group("detector", detector);
  fields.group("klt", klt);
  fields.group("outliers", outliers);
  fields.group("templates", reference_patches);
  fields.add("forward_backward_px", forward_backward_px,
             {"px", 0.01, 100, "A track that is followed backwards must return this close to its start."});
  fields.add("min_correlation", min_correlation,
             {"1", -1, 1, "Least correlation of a track's patch with the one in the previous image."});
  fields.add("sigma_px", sigma_px, {"px", 0.01, 20, "Standard deviation of an observation in the estimator."});
}

std::unique_ptr<FeatureTracker> make_tracker(std::string camera_name, const CameraModel& camera,
                                             const TrackerConfig& config) {
  const auto row = std::ranges::find(kTrackers, config.kind, &TrackerRow::kind);
  EDGED_CHECK(row != std::end(kTrackers), "tracker kind {}", static_cast<int>(config.kind));
  return row->make(std::move(camera_name), camera, config);
}

}  // namespace edged
