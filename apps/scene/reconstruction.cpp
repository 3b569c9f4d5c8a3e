// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files of a reconstruction. COLMAP's pixels begin at the corner of the first one, half a pixel before its centre.
#include "scene/reconstruction.hpp"

#include <spdlog/fmt/fmt.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "common/files.hpp"
#include "common/json_text.hpp"

namespace edged {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary model is written as it lies in memory");

constexpr double kCorner_px = 0.5;
constexpr int kPinhole = 1;  // COLMAP's number of the model
using Image = Reconstruction::Image;

/// Numbers of COLMAP begin at 1.
std::uint32_t number_of(std::size_t index) { return static_cast<std::uint32_t>(index + 1); }

class Binary {
 public:
  template <typename T>
  Binary& operator<<(const T& x) {
    bytes.append(reinterpret_cast<const char*>(&x), sizeof(x));
    return *this;
  }
  Binary& count(std::size_t n) { return *this << static_cast<std::uint64_t>(n); }
  std::string bytes;
};

std::string cameras_text(const Reconstruction& model) {
  std::string text = "# CAMERA_ID MODEL WIDTH HEIGHT fx fy cx cy\n";
  for (std::size_t i = 0; i < model.cameras.size(); ++i) {
    const CameraModel& c = model.cameras[i].pinhole;
    text += fmt::format("{} PINHOLE {} {} {} {} {} {}\n", number_of(i), c.width(), c.height(), c.fx(), c.fy(),
                        c.cx() + kCorner_px, c.cy() + kCorner_px);
  }
  return text;
}

std::string cameras_binary(const Reconstruction& model) {
  Binary out;
  out.count(model.cameras.size());
  for (std::size_t i = 0; i < model.cameras.size(); ++i) {
    const CameraModel& c = model.cameras[i].pinhole;
    out << number_of(i) << kPinhole;
    out.count(static_cast<std::size_t>(c.width())).count(static_cast<std::size_t>(c.height()));
    out << c.fx() << c.fy() << c.cx() + kCorner_px << c.cy() + kCorner_px;
  }
  return out.bytes;
}

std::string images_text(const Reconstruction& model) {
  std::string text = "# IMAGE_ID QW QX QY QZ TX TY TZ (of T_C_W) CAMERA_ID NAME, then its X Y POINT3D_ID\n";
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const Image& image = model.images[i];
    const SE3 T_C_W = image.T_W_C.inverse();
    const Eigen::Quaterniond& q = T_C_W.rotation();
    const Eigen::Vector3d& p = T_C_W.translation();
    text += fmt::format("{} {} {} {} {} {} {} {} {} {}\n", number_of(i), q.w(), q.x(), q.y(), q.z(), p.x(), p.y(),
                        p.z(), number_of(image.camera), image.file);
    const char* blank = "";
    for (const auto& [feature, pixel, grey, point] : image.observations) {
      text += fmt::format("{}{} {} {}", blank, pixel.x() + kCorner_px, pixel.y() + kCorner_px,
                          point == Reconstruction::kNone ? "-1" : fmt::format("{}", point + 1));
      blank = " ";
    }
    text += '\n';
  }
  return text;
}

std::string images_binary(const Reconstruction& model) {
  Binary out;
  out.count(model.images.size());
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const Image& image = model.images[i];
    const SE3 T_C_W = image.T_W_C.inverse();
    const Eigen::Quaterniond& q = T_C_W.rotation();
    const Eigen::Vector3d& p = T_C_W.translation();
    out << number_of(i) << q.w() << q.x() << q.y() << q.z() << p.x() << p.y() << p.z() << number_of(image.camera);
    out.bytes.append(image.file.c_str(), image.file.size() + 1);
    out.count(image.observations.size());
    for (const auto& [feature, pixel, grey, point] : image.observations)
      out << pixel.x() + kCorner_px << pixel.y() + kCorner_px
          << (point == Reconstruction::kNone ? ~std::uint64_t{0} : static_cast<std::uint64_t>(point + 1));
  }
  return out.bytes;
}

std::string points_text(const Reconstruction& model) {
  std::string text = "# POINT3D_ID X Y Z R G B ERROR, then its IMAGE_ID POINT2D_IDX\n";
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const auto& [p, covariance, normal, grey, error_px, all] = model.points[i];
    text += fmt::format("{} {} {} {} {} {} {} {}", i + 1, p.x(), p.y(), p.z(), grey, grey, grey, error_px);
    for (const auto& [image, observation] : all) text += fmt::format(" {} {}", number_of(image), observation);
    text += '\n';
  }
  return text;
}

std::string points_binary(const Reconstruction& model) {
  Binary out;
  out.count(model.points.size());
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const auto& [p, covariance, normal, grey, error_px, all] = model.points[i];
    out << static_cast<std::uint64_t>(i + 1) << p.x() << p.y() << p.z() << grey << grey << grey << error_px;
    out.count(all.size());
    for (const auto& [image, observation] : all) out << number_of(image) << static_cast<std::uint32_t>(observation);
  }
  return out.bytes;
}

}  // namespace

void write_colmap(const std::filesystem::path& folder, const Reconstruction& model) {
  const std::filesystem::path binary = folder / "sparse" / "0", text = folder / "sparse_text" / "0";
  for (const std::filesystem::path& each : {binary, text}) make_picture_folder(each);
  write_file(binary / "cameras.bin", cameras_binary(model));
  write_file(binary / "images.bin", images_binary(model));
  write_file(binary / "points3D.bin", points_binary(model));
  write_file(text / "cameras.txt", cameras_text(model));
  write_file(text / "images.txt", images_text(model));
  write_file(text / "points3D.txt", points_text(model));
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
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment points in the world (z up) [m]; normal: towards the cameras; p_*: covariance "
      "[m^2] with observations of 1 px\nelement vertex {}\n",
      model.points.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) text += fmt::format("property float {}\n", name);
  for (const char* name : {"red", "green", "blue"}) text += fmt::format("property uchar {}\n", name);
  for (const char* name : {"p_xx", "p_xy", "p_xz", "p_yy", "p_yz", "p_zz"})
    text += fmt::format("property float {}\n", name);
  text += "end_header\n";
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
