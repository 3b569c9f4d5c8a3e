// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files of a reconstruction. COLMAP's pixels begin at the corner of the first one, half a pixel before its centre.
#include "scene/reconstruction.hpp"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "common/files.hpp"
#include "common/json_text.hpp"
#include "report/point_cloud.hpp"

namespace edged {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary model is written as it lies in memory");

constexpr double kCorner_px = 0.5;
constexpr int kPinhole = 1;  // COLMAP's number of the model
using Image = Reconstruction::Image;

/// Numbers of COLMAP begin at 1.
std::uint32_t number_of(std::size_t index) { return static_cast<std::uint32_t>(index + 1); }

/// A file of a model: as text, and binary.
struct ModelFile {
  std::string text, binary;

  /// A number for both.
  template <typename T>
  ModelFile& add(const T& number) {
    return word(fmt::format("{}", number)).raw(number);
  }
  ModelFile& word(const std::string& word) {
    text += (text.back() == '\n' ? "" : " ") + word;
    return *this;
  }
  template <typename T>
  ModelFile& raw(const T& number) {
    binary.append(reinterpret_cast<const char*>(&number), sizeof(number));
    return *this;
  }
  ModelFile& count(std::size_t n) { return raw(static_cast<std::uint64_t>(n)); }
  void end_line() { text += '\n'; }
};

ModelFile cameras_file(const Reconstruction& model) {
  ModelFile out{"# CAMERA_ID MODEL WIDTH HEIGHT fx fy cx cy\n", ""};
  out.count(model.cameras.size());
  for (std::size_t i = 0; i < model.cameras.size(); ++i) {
    const CameraModel& c = model.cameras[i].pinhole;
    out.add(number_of(i)).word("PINHOLE").raw(kPinhole);
    for (const int pixels : {c.width(), c.height()}) out.add(static_cast<std::uint64_t>(pixels));
    for (const double x : {c.fx(), c.fy(), c.cx() + kCorner_px, c.cy() + kCorner_px}) out.add(x);
    out.end_line();
  }
  return out;
}

ModelFile images_file(const Reconstruction& model) {
  ModelFile out{"# IMAGE_ID QW QX QY QZ TX TY TZ (of T_C_W) CAMERA_ID NAME, then its X Y POINT3D_ID\n", ""};
  out.count(model.images.size());
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const Image& image = model.images[i];
    const SE3 T_C_W = image.T_W_C.inverse();
    const Eigen::Quaterniond& q = T_C_W.rotation();
    const Eigen::Vector3d& p = T_C_W.translation();
    out.add(number_of(i));
    for (const double x : {q.w(), q.x(), q.y(), q.z(), p.x(), p.y(), p.z()}) out.add(x);
    out.add(number_of(image.camera)).word(image.file);
    out.end_line();
    out.binary.append(image.file.c_str(), image.file.size() + 1);
    out.count(image.observations.size());
    for (const auto& [feature, pixel, grey, point] : image.observations) {
      const bool none = point == Reconstruction::kNone;
      out.add(pixel.x() + kCorner_px).add(pixel.y() + kCorner_px).word(none ? "-1" : fmt::format("{}", point + 1));
      out.raw(none ? ~std::uint64_t{0} : static_cast<std::uint64_t>(point + 1));
    }
    out.end_line();
  }
  return out;
}

ModelFile points_file(const Reconstruction& model) {
  ModelFile out{"# POINT3D_ID X Y Z R G B ERROR, then its IMAGE_ID POINT2D_IDX\n", ""};
  out.count(model.points.size());
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const auto& [p, covariance, normal, grey, error_px, all] = model.points[i];
    out.add(static_cast<std::uint64_t>(i + 1)).add(p.x()).add(p.y()).add(p.z());
    out.add(grey).add(grey).add(grey).add(error_px).count(all.size());
    for (const auto& [image, observation] : all) out.add(number_of(image)).add(static_cast<std::uint32_t>(observation));
    out.end_line();
  }
  return out;
}

}  // namespace

void write_colmap(const std::filesystem::path& folder, const Reconstruction& model) {
  const std::filesystem::path binary = folder / "sparse" / "0", text = folder / "sparse_text" / "0";
  for (const std::filesystem::path& each : {binary, text}) make_picture_folder(each);
  const auto write = [&](const std::string& name, const ModelFile& file) {
    write_file(binary / (name + ".bin"), file.binary);
    write_file(text / (name + ".txt"), file.text);
  };
  write("cameras", cameras_file(model));
  write("images", images_file(model));
  write("points3D", points_file(model));
}

std::string transforms_json(const Reconstruction& model) {
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  for (const Image& image : model.images) {
    const CameraModel& c = model.cameras[image.camera].pinhole;
    Eigen::Matrix4d T = image.T_W_C.matrix();
    T.middleCols<2>(1) *= -1.0;  // axes of OpenGL: y up, z backwards
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (int row = 0; row < 4; ++row) rows.push_back({T(row, 0), T(row, 1), T(row, 2), T(row, 3)});
    frames.push_back({{"file_path", "images/" + image.file},
                      {"w", c.width()},
                      {"h", c.height()},
                      {"fl_x", c.fx()},
                      {"fl_y", c.fy()},
                      {"cx", c.cx() + kCorner_px},
                      {"cy", c.cy() + kCorner_px},
                      {"transform_matrix", rows}});
  }
  return json_text({{"camera_model", "OPENCV"}, {"ply_file_path", "points.ply"}, {"frames", frames}}) + "\n";
}

std::string points_ply(const Reconstruction& model) {
  std::string text = ply_header(
      false,
      {"points in the world (z up) [m]; normal: towards the cameras; p_*: covariance [m^2] with observations of 1 px"},
      model.points.size(),
      "float x, float y, float z, float nx, float ny, float nz, uchar red, uchar green, uchar blue, float p_xx, float "
      "p_xy, float p_xz, float p_yy, float p_yz, float p_zz");
  for (const Reconstruction::Point& point : model.points) {
    const Eigen::Vector3d &p = point.p_W, &n = point.towards_cameras;
    const Eigen::Matrix3d& P = point.covariance;
    text +=
        fmt::format("{:.5f} {:.5f} {:.5f} {:.4f} {:.4f} {:.4f} {} {} {} {:.3g} {:.3g} {:.3g} {:.3g} {:.3g} {:.3g}\n",
                    p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), point.grey, point.grey, point.grey, P(0, 0), P(0, 1),
                    P(0, 2), P(1, 1), P(1, 2), P(2, 2));
  }
  return text;
}

}  // namespace edged
