// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The configuration files of VINS and its descendants: VINS-Mono and SuperEIO (the camera in the same file),
// VINS-Fusion (cam0_calib) and ESVIO (cam_left_calib, event_left_calib); and the rig files of Ultimate SLAM (ze_oss).
#include <initializer_list>

#include "edged/io/calib/calibration_readers.hpp"

namespace edged {
namespace {

/// The keys of one camera in such a file. body_T: a transform of 4 x 4 from camera to IMU. Without it,
/// extrinsicRotation and extrinsicTranslation: from camera to IMU, or from IMU to camera if the flag is 1.
struct VinsCamera {
  const char* name;
  const char* calib;  ///< names the file with the intrinsics
  const char* topic;
  const char* body_T;    ///< "": none
  const char* suffix;    ///< ending of extrinsicRotation and extrinsicTranslation; null: none
  const char* inverted;  ///< the flag
  std::optional<Sees> sees;
};

const VinsCamera kCameras[] = {
    {"events", "event_left_calib", "event_left_topic", "", "_event", "T_event_imu", Sees::Events},
    {"frames", "cam_left_calib", "image_left_topic", "", "", "T_camera_imu", Sees::Frames},
    {"events_right", "event_right_calib", "event_right_topic", "body_T_event1", nullptr, "", Sees::Events},
    {"frames_right", "cam_right_calib", "image_right_topic", "body_T_cam1", nullptr, "", Sees::Frames},
    {"cam0", "cam0_calib", "image0_topic", "body_T_cam0", "", "T_camera_imu", std::nullopt},
    {"cam1", "cam1_calib", "image1_topic", "body_T_cam1", nullptr, "", std::nullopt},
};

std::vector<double> numbers_at(const YamlReader& from, std::initializer_list<const char*> keys) {
  std::vector<double> out;
  for (const char* key : keys) out.push_back(from.at(key).number());
  return out;
}

/// The distortion of PINHOLE, in the order of OpenCV.
std::vector<double> read_camodocal_distortion(const YamlReader& distortion) {
  std::vector<double> out = numbers_at(distortion, {"k1", "k2", "p1", "p2"});
  for (const char* key : {"k3", "k4", "k5", "k6"})
    if (const auto value = distortion.find(key)) {
      out.resize(4 + static_cast<std::size_t>(key[1] - '3'));
      out.push_back(value->number());
    }
  if (out.size() > 5) out.resize(8);
  return out;
}

/// The models of camodocal: PINHOLE is radtan, PINHOLE_FULL rational, KANNALA_BRANDT equidistant, MEI omni.
CameraModel read_camodocal(const YamlReader& root) {
  const std::string type = root.text_or("model_type", "PINHOLE");
  const YamlReader projection = root.at("projection_parameters");
  Intrinsics in{root.at("image_width").number(), root.at("image_height").number(), {}, "radtan", {}};
  if (type == "KANNALA_BRANDT") {
    in.distortion = "equidistant";
    in.projection = numbers_at(projection, {"mu", "mv", "u0", "v0"});
    in.coefficients = numbers_at(projection, {"k2", "k3", "k4", "k5"});
  } else if (type == "MEI") {
    in.distortion = "omni";
    in.coefficients = numbers_at(root.at("mirror_parameters"), {"xi"});
    in.projection = numbers_at(projection, {"gamma1", "gamma2", "u0", "v0"});
    const std::vector<double> brown = numbers_at(root.at("distortion_parameters"), {"k1", "k2", "p1", "p2"});
    in.coefficients.insert(in.coefficients.end(), brown.begin(), brown.end());
  } else if (type == "PINHOLE" || type == "PINHOLE_FULL") {
    in.projection = numbers_at(projection, {"fx", "fy", "cx", "cy"});
    in.coefficients = read_camodocal_distortion(root.at("distortion_parameters"));
  } else {
    root.at("model_type")
        .fail("model " + type + " is not supported; PINHOLE, PINHOLE_FULL, KANNALA_BRANDT and MEI are");
  }
  return make_model(projection, in);
}

std::optional<SE3> read_vins_extrinsics(const YamlReader& root, const VinsCamera& camera) {
  if (const auto body_T = root.find(camera.body_T)) return body_T->transform();
  if (!camera.suffix) return std::nullopt;
  const auto R = root.find(std::string("extrinsicRotation") + camera.suffix);
  const auto t = root.find(std::string("extrinsicTranslation") + camera.suffix);
  if (!R || !t) return std::nullopt;
  const SE3 T = R->rigid(R->numbers(), t->numbers());
  const bool inverted = root.text_or(camera.inverted, "0") == "1";
  return inverted ? T.inverse() : T;
}

Lens read_vins_lens(const YamlReader& root, const VinsCamera& camera, const YamlReader& intrinsics,
                    CalibrationFile& out) {
  Lens lens;
  lens.name = camera.name;
  lens.model = read_camodocal(intrinsics);
  lens.sees = camera.sees;
  lens.words = root.text_or(camera.topic, "");
  if (const auto T_B_C = read_vins_extrinsics(root, camera)) {
    lens.T_B_C = *T_B_C;
  } else {
    out.has_extrinsics = false;
  }
  if (const auto td = root.find("td"))
    lens.time_offset = td->time_offset();  // t_imu = t_cam + td: the sign of time_offset
  return lens;
}

Lens read_uslam_camera(const YamlReader& item, std::size_t index) {
  const YamlReader camera = item.at("camera");
  if (const std::string type = camera.text_or("type", "pinhole"); type != "pinhole")
    camera.at("type").fail("camera type " + type + " is not supported; pinhole is");
  const auto distortion = camera.find("distortion");
  Intrinsics in{camera.at("image_width").number(),
                camera.at("image_height").number(),
                camera.at("intrinsics").numbers(),
                "none",
                {}};
  if (distortion) {
    in.distortion = distortion->text_or("type", "none");
    if (in.distortion != "none") in.coefficients = distortion->at("parameters").numbers();
  }
  Lens lens;
  lens.name = camera.text_or("label", "cam" + std::to_string(index));
  lens.words = lens.name;
  lens.model = make_model(camera.at("intrinsics"), in);
  lens.T_B_C = item.at("T_B_C").transform();
  return lens;
}

}  // namespace

CalibrationFile read_vins(const YamlReader& root) {
  CalibrationFile out;
  for (const VinsCamera& camera : kCameras)
    if (const auto calib = root.find(camera.calib))
      out.lenses.push_back(
          read_vins_lens(root, camera, root.other_file(root.file().parent_path() / calib->text()), out));
  if (root.find("projection_parameters")) {
    Lens lens = read_vins_lens(root, {"cam0", "", "", "body_T_cam0", "", "T_camera_imu", std::nullopt}, root, out);
    const std::string events = root.text_or("event_topic", "");
    lens.words = events.empty() ? root.text_or("image_topic", root.file().name()) : events;
    out.lenses.push_back(std::move(lens));
  }
  if (out.has_extrinsics && root.text_or("estimate_extrinsic", "0") == "2")
    root.at("estimate_extrinsic").warn("the extrinsics of this file are an initial guess that VINS refines");
  if (root.find("acc_n"))
    root.at("acc_n").warn(
        "the IMU noise of VINS files is tuned for its own integration and is not a density: not used; give --imu FILE "
        "with "
        "the densities of a Kalibr imu.yaml");
  return out;
}

/// They contain no time offset and no IMU noise.
CalibrationFile read_uslam(const YamlReader& root) {
  CalibrationFile out;
  out.name = root.text_or("label", "");
  for (const YamlReader& item : root.at("cameras").items())
    out.lenses.push_back(read_uslam_camera(item, out.lenses.size()));
  return out;
}

}  // namespace edged
