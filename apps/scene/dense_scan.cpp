// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "scene/dense_scan.hpp"

#include <algorithm>
#include <bit>

#include "edged/camera/undistort.hpp"
#include "report/point_cloud.hpp"

namespace edged {

std::vector<RigCamera> image_cameras(const Rig& given) {
  std::vector<RigCamera> images = given.cameras;
  for (RigCamera& camera : images)
    if (camera.modality == Modality::Events) camera.model = ideal_pinhole(camera.model);
  return images;
}

DenseInstant dense_instant(const Step& step, const std::vector<RigCamera>& images, const Rig& found) {
  const SE3 T_O_M = step.T_M_O.inverse();
  DenseInstant instant{.t = step.t, .keyframe = step.keyframe, .T_O_B = T_O_M * step.state.T_W_B};
  instant.scene_depth = step.scene_depth;
  for (const KeyframeRecord& keyframe : step.marginalized_keyframes)
    instant.refined.push_back({keyframe.t, T_O_M * keyframe.T_W_B});
  if (step.keyframe)
    for (const Landmark& landmark : step.landmarks) instant.landmarks_O.push_back(T_O_M * landmark.p_W);
  for (const CameraStep& camera : step.cameras) {
    if (camera.image.empty()) continue;
    const RigCamera& now = found.camera(camera.name);
    const auto given = std::ranges::find(images, camera.name, &RigCamera::name);
    const bool events = camera.modality == Modality::Events && given != images.end();
    instant.images.push_back(
        {camera.name, camera.modality, events ? given->model : now.model, now.T_B_C, camera.image});
  }
  return instant;
}

DenseScans place(const std::vector<DepthMap>& maps, const Trajectory& poses, const Rig& rig) {
  DenseScans scans;
  for (const DepthMap& map : maps) {
    const auto pose = std::ranges::lower_bound(poses, map.t, {}, &StampedPose::t);
    if (pose == poses.end() || pose->t != map.t) continue;
    const RigCamera& camera = rig.camera(map.camera);
    const SE3 T_W_C = pose->T * camera.T_B_C;
    DenseScan& scan = scans.emplace_back();
    scan.modality = camera.modality;
    scan.from_W = T_W_C.translation();
    for (const DensePoint& point : map.points) {
      const Eigen::Vector3d p_C = point.in_camera(map.pinhole);
      scan.points.push_back({T_W_C * p_C, p_C.norm() * point.sigma / point.inverse_depth, point.grey});
    }
  }
  return scans;
}

std::string dense_ply(const DenseScans& scans) {
  static_assert(std::endian::native == std::endian::little, "points are written as they lie in memory");
  std::size_t count = 0;
  for (const DenseScan& scan : scans) count += scan.points.size();
  std::string ply = ply_header(true, {"points in the world (z up) [m]; sigma: along the ray [m]"}, count,
                               "float x, float y, float z, float sigma, uchar red, uchar green, uchar blue");
  for (const DenseScan& scan : scans) {
    for (const auto& [p_W, sigma_m, grey] : scan.points) {
      const Eigen::Vector4f numbers = Eigen::Vector4d(p_W.x(), p_W.y(), p_W.z(), sigma_m).cast<float>();
      ply.append(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
      ply.append(3, static_cast<char>(grey));
    }
  }
  return ply;
}

}  // namespace edged
