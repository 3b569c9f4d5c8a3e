// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Prints the poses of a recording with a calibration as they are published, each final, in the form of trajectory.tum.
#include <cstdio>

#include "edged/io/open_recording.hpp"
#include "edged/odometry.hpp"

int main(int /*argc*/, char** argv) {
  const edged::Recording recording = edged::open_recording(argv[1]);
  const auto truth = recording.dataset->ground_truth();
  const edged::Calibration& calibration = recording.calibration.value();
  edged::Odometry odometry(calibration.rig, calibration.imu, edged::Mode::Frames, {}, {edged::kInOrder});
  edged::drive(
      odometry, [&] { return recording.dataset->next(); },
      [&](const edged::Step& step) {
        if (!edged::is_tracking(step.status)) return true;
        const edged::StampedPose pose = step.pose_of(truth ? truth->frame : "body");
        const Eigen::Vector3d p = pose.T.translation();
        const Eigen::Quaterniond q = pose.T.rotation();
        std::printf("%.9f %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", edged::to_seconds(pose.t), p.x(), p.y(), p.z(),
                    q.x(), q.y(), q.z(), q.w());
        return true;
      });
  return 0;
}
