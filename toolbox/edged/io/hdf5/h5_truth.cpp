// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Poses as seven numbers or as matrices, converted to T_W_X.
#include "edged/io/hdf5/h5_truth.hpp"

#include <array>
#include <cmath>

#include "edged/core/check.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

constexpr double kMostDeviation = 1e-2;

/// x y z qx qy qz qw
std::optional<SE3> pose_of_seven(const double* v) {
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1.0) < kMostDeviation) || !Eigen::Vector3d(v).allFinite()) return std::nullopt;
  return SE3(q, Eigen::Vector3d(v));
}

/// 4 x 4, row by row.
std::optional<SE3> pose_of_matrix(const double* v) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(v);
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!T.allFinite() || !(deviation < kMostDeviation) || R.determinant() < 0) return std::nullopt;
  return SE3(R, T.topRightCorner<3, 1>());
}

/// The place and the meaning of poses.
struct H5Poses {
  fs::path file;
  std::string poses, stamps;
  std::string frame;     ///< X of T_W_X
  bool inverse = false;  ///< the file has T_X_W
};

GroundTruth read_poses(const H5Poses& where, const H5Array& poses, const H5Stamps& stamps, Repairs& repairs) {
  constexpr std::uint64_t kPosesAtOnce = 1024;
  GroundTruth truth{{}, where.frame};
  const std::size_t columns = poses.columns();
  const auto bad = [&](const char* kind, const std::string& detail) {
    repairs.add(std::string("groundtruth: ") + kind, where.file.string() + ": " + detail);
  };
  const std::uint64_t rows = std::min(poses.rows(), stamps.rows());
  for (std::uint64_t at = 0; at < rows; at += kPosesAtOnce) {
    const std::uint64_t count = std::min(kPosesAtOnce, rows - at);
    try {
      const auto t = stamps.read(at, count);
      const auto values = poses.read<double>(at, count);
      for (std::size_t i = 0; i < count; ++i) {
        const double* v = &values[columns * i];
        const auto T = columns == 7 ? pose_of_seven(v) : pose_of_matrix(v);
        const bool late = !truth.trajectory.empty() && t[i] <= truth.trajectory.back().t;
        if (!T || t[i] == Timestamp::min() || late)
          bad("bad pose", fmt::format("pose {} is no pose, or its stamp is not after the one before", at + i));
        else
          truth.trajectory.push_back({t[i], where.inverse ? T->inverse() : *T});
      }
    } catch (const Damage& damage) {
      bad("part unreadable", damage.what());
    }
  }
  return truth;
}

std::optional<GroundTruth> read_truth(const H5Poses& where, Repairs& repairs) try {
  const H5File file(where.file);
  const auto poses = file.find(where.poses);
  auto stamps = file.find(where.stamps);
  if (!poses || !stamps || (poses->columns() != 7 && poses->columns() != 16)) return std::nullopt;
  GroundTruth truth = read_poses(where, *poses, H5Stamps(std::move(*stamps)), repairs);
  return truth.trajectory.empty() ? std::nullopt : std::optional(std::move(truth));
} catch (const InputError& error) {
  repairs.add("groundtruth: unreadable", error.what());
  return std::nullopt;
}

/// The ground truth files that the data sets have in the folder of the event file.
std::vector<H5Poses> candidates(const H5File& file, const Hdf5Layout& layout) {
  const fs::path folder = fs::absolute(file.path()).parent_path();
  std::string stem = file.path().stem().string();
  if (stem.ends_with("_data")) stem.resize(stem.size() - 5);
  if (layout.name == "mvsec")
    return {{folder / (stem + "_gt.hdf5"), "/davis/left/pose", "/davis/left/pose_ts", "events"}};
  if (layout.name == "m3ed")
    return {{folder / (stem + "_pose_gt.h5"), "/Cn_T_C0", "/ts", "events", true},
            {folder / (stem + "_depth_gt.h5"), "/Cn_T_C0", "/ts", "events", true}};
  return {};
}

}  // namespace

TruthSource find_h5_truth(const H5File& events_file, const Hdf5Layout& layout) {
  const auto reader = [](H5Poses where) {
    TruthSource source{where.frame};
    source.read = [where = std::move(where)](Repairs& repairs) { return read_truth(where, repairs); };
    return source;
  };
  const std::string poses(layout.poses);
  if (!poses.empty() && events_file.has(poses))
    return reader({events_file.path(), poses, std::string(layout.pose_stamps),
                   events_file.text_attribute(poses, "frame").value_or("body")});
  for (H5Poses& where : candidates(events_file, layout)) {
    std::error_code ignored;
    if (fs::is_regular_file(where.file, ignored)) return reader(std::move(where));
  }
  return {};
}

}  // namespace edged
