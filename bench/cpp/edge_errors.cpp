// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How well one event frame tells its pose relative to a keyframe whose true depth is known: by the keyframe's edges,
// and by the tracked features. One line for each pair of event frames and method.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <deque>
#include <fstream>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "common/source.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/events/accumulate.hpp"
#include "edged/odometry.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/sensors/renderer.hpp"
#include "edged/sim/simulator.hpp"
#include "pose_from_pixels.hpp"
#include "program/commands.hpp"
#include "program/program.hpp"
#include "track_truth.hpp"

namespace edged {
namespace {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

constexpr double kStartAngle = 0.2 * M_PI / 180.0, kStartDistance_m = 0.005;  // what a prediction by the IMU leaves
constexpr double kSpacing_s = 0.5;                                            // between keyframes
constexpr std::size_t kKeyframes = 4, kRecent = 16;
constexpr std::size_t kFewestRows = 24;
constexpr int kEvery = 3;         // of so many event frames one is compared
constexpr double kLagGain = 0.2;  // of a calibration of how far behind their place edges and features are seen
constexpr int kBorder_px = 6;
constexpr double kLeastHeight = 0.3;    // of an edge [events]
constexpr double kAlong = 0.4;          // cosine between motion and normal below which an edge does not show
constexpr double kGradientNoise = 0.3;  // [px^2], as for gradient patches

struct EdgeOptions {
  SourceOptions source;
  std::filesystem::path out;
};

/// A pixel of the keyframe on an edge.
struct EdgePoint {
  Vec2 normal;     ///< towards brighter pixels
  double slope;    ///< [events/px]
  Vec3 p, beside;  ///< in the camera of the keyframe; another one on the edge
};

/// An event frame with its true pose.
struct Shot {
  Timestamp t;
  SE3 T_W_C, T_before_now;  ///< camera now; camera now to that at the first event
  /// Sum of the events of either polarity; their difference, with true motion and depth; that without errors, as the
  /// scene has it. CV_32F
  cv::Mat given, changes, exact;
  std::map<FeatureId, Vec2> features;
};

struct Search {
  bool polarity;
  double lag_px;
  std::size_t every;  ///< of every so many edges
};

struct KeyframeShot {
  Shot shot;
  Rendering scene;
  std::map<std::string, std::vector<EdgePoint>> edges;  ///< by method
  std::map<FeatureId, Vec3> points;
};

SimulatorConfig config_of(const EdgeOptions& options) {
  const std::optional<SimulatorConfig> config = simulator_config(options.source);
  if (!config) throw InputError::format("{}: no simulation; give sim:PRESET:SEED", options.source.recording);
  return *config;
}

class Experiment {
 public:
  explicit Experiment(const EdgeOptions& options)
      : options_(options),
        config_(config_of(options)),
        simulator_(config_),
        truth_(simulated_truth(config_)),
        camera_(*simulator_.calibration().rig.find(Modality::Events)),
        image_(ideal_pinhole(camera_.model)),
        reach_px_(2.5 * image_.mean_focal() / 200.0),
        renderer_(image_, simulator_.scene()),
        frames_(UndistortTable(camera_.model, image_), EventFrameConfig()),
        out_(options.out) {}

  int run() {
    simulator_.leave_out(Modality::Frames);
    const Calibration calibration = simulator_.calibration();
    Odometry odometry(calibration.rig, calibration.imu, Mode::Events, {}, {kInOrder});
    out_ << "method,t_ns,keyframe_ns,baseline_m,depth_m,moved_px,n,lag_px,error_px,along_px,turned_deg,off_m,held_x_m,"
            "held_y_m,held_z_m\n";
    int count = 0;
    drive(
        odometry, [&] { return simulator_.next(); },
        [&](const Step& step) {
          if (step.find(Modality::Events)->image.empty() || !is_tracking(step.status)) return true;
          recent_.push_back(shot_of(step));
          if (recent_.size() > kRecent) recent_.pop_front();
          const Shot& now = recent_.back();
          if (++count % kEvery == 0)
            for (const KeyframeShot& keyframe : keyframes_) compare(keyframe, now);
          if (step.keyframe && (keyframes_.empty() || to_seconds(now.t - keyframes_.back().shot.t) >= kSpacing_s))
            add_keyframe(now);
          return true;
        });
    out_.close();
    if (!out_) throw InputError::format("{}: cannot be written; choose another --out", options_.out.string());
    return kExitOk;
  }

 private:
  Shot shot_of(const Step& step) {
    const CameraStep& seen = *step.find(Modality::Events);
    const std::span<const Event> events = seen.rendered_events();
    const SE3 T_W_C = *truth_->T_W_C(camera_, step.t);
    Shot shot{step.t, T_W_C, truth_->T_W_C(camera_, events.front().t)->inverse() * T_W_C, {}, {}, {}, {}};
    CameraMotion motion;
    for (Timestamp t = events.front().t;; t += std::chrono::milliseconds(1)) {
      motion.knots.push_back({t, T_W_C.inverse() * *truth_->T_W_C(camera_, t)});
      if (t >= step.t) break;
    }
    constexpr int kCell_px = 3;
    const Rendering& scene = renderer_.render(T_W_C, to_seconds(step.t - camera_.time_offset));
    std::vector<DepthSample> samples;
    for (int y = kCell_px / 2; y < image_.height(); y += kCell_px)
      for (int x = kCell_px / 2; x < image_.width(); x += kCell_px)
        samples.push_back({{x, y}, 1.0 / scene.inverse_depth[static_cast<std::size_t>(y * image_.width() + x)]});
    const DepthGrid depths(image_.width(), image_.height(), {kCell_px, 2.0 * kCell_px}, samples, step.scene_depth);
    shot.exact = exact_changes(scene, shot.T_before_now);
    const EventFrame frame = frames_.render(events, motion, step.scene_depth, &depths);
    const double events_per_grey = EventFrameConfig().saturation_events / 255.0;
    seen.image.convertTo(shot.given, CV_32F, events_per_grey);
    frame.increments.convertTo(shot.changes, CV_32F, 2.0 * events_per_grey, -256.0 * events_per_grey);
    for (const Track& track : seen.tracks) shot.features.emplace(track.id, track.pixel);
    return shot;
  }

  /// Of the image where it shows p_C, since the first event [px]; hardly, along x, where that is not known.
  Vec2 moved(const SE3& T_before_now, const Vec3& p_C) const {
    const auto now = image_.project(p_C), before = image_.project(T_before_now * p_C);
    return now && before && *now != *before ? Vec2(*now - *before) : Vec2(1e-6, 0.0);
  }

  std::optional<Vec3> point_at(const Rendering& scene, const Vec2& pixel) const {
    const ScenePoint point = scene_point(scene, image_, pixel);
    if (point.at_edge || point.inverse_depth <= 0.0) return std::nullopt;
    return image_.pixel_to_point(pixel).homogeneous() / point.inverse_depth;
  }

  void add_keyframe(const Shot& shot) {
    KeyframeShot keyframe{shot, renderer_.render(shot.T_W_C, to_seconds(shot.t - camera_.time_offset)), {}, {}};
    const auto [dx, dy] = slopes(keyframe.scene);
    keyframe.edges["scene"] = gradient_edges(keyframe.scene, dx, dy);
    keyframe.edges["frames"] = learned_edges(keyframe, &Shot::given, 1);
    keyframe.edges["increments"] = learned_edges(keyframe, &Shot::changes, 1);
    keyframe.edges["learned"] = learned_edges(keyframe, &Shot::changes, kRecent);
    for (const auto& [id, pixel] : shot.features) {
      const auto seen = point_at(keyframe.scene, pixel);
      if (!seen) continue;
      const Vec2 place = pixel + feature_lag_px_ * moved(shot.T_before_now, *seen).normalized();
      if (const auto p = point_at(keyframe.scene, place)) keyframe.points.emplace(id, *p);
    }
    keyframes_.push_back(std::move(keyframe));
    if (keyframes_.size() > kKeyframes) keyframes_.pop_front();
  }

  /// dx, dy: slope of the brightness [events/px].
  std::vector<EdgePoint> gradient_edges(const Rendering& scene, const cv::Mat& dx, const cv::Mat& dy) const {
    cv::Mat slope;
    cv::magnitude(dx, dy, slope);
    std::vector<EdgePoint> edges;
    for (const auto& [pixel, normal, height] : ridges(slope, kLeastHeight, kBorder_px)) {
      const bool rises = normal.dot(Vec2(at(dx, pixel), at(dy, pixel))) > 0.0;
      const auto p = point_at(scene, pixel), beside = point_at(scene, pixel + Vec2(-normal.y(), normal.x()));
      if (p && beside) edges.push_back({rises ? normal : Vec2(-normal), height, *p, *beside});
    }
    return edges;
  }

  /// Slope of the brightness over the threshold [events/px], x and y.
  std::array<cv::Mat, 2> slopes(const Rendering& scene) const {
    cv::Mat brightness(image_.height(), image_.width(), CV_32F);
    const double threshold = 0.5 * (config_.events.threshold_on + config_.events.threshold_off);
    for (std::size_t i = 0; i < scene.radiance.size(); ++i)
      brightness.ptr<float>()[i] =
          static_cast<float>(std::log(scene.radiance[i] + config_.events.dark_radiance) / threshold);
    return gradient(blurred(brightness, 1.0));
  }

  /// What the motion changes, without errors of events.
  cv::Mat exact_changes(const Rendering& scene, const SE3& T_before_now) const {
    auto [dx, dy] = slopes(scene);
    for (int y = 0; y < dx.rows; ++y) {
      for (int x = 0; x < dx.cols; ++x) {
        const double w = scene.inverse_depth[static_cast<std::size_t>(y * dx.cols + x)];
        const Vec2 way = moved(T_before_now, image_.pixel_to_point(Vec2(x, y)).homogeneous() / w);
        dx.at<float>(y, x) = -static_cast<float>(way.dot(Vec2(dx.at<float>(y, x), dy.at<float>(y, x))));
      }
    }
    return dx;
  }

  /// From the last event frames with true poses: least squares for the slope of the brightness. One alone shows none
  /// along its motion.
  std::vector<EdgePoint> learned_edges(const KeyframeShot& keyframe, cv::Mat Shot::*picture, std::size_t last) const {
    cv::Mat dx = cv::Mat::zeros(image_.height(), image_.width(), CV_32F), dy = dx.clone();
    for (int y = 0; y < dx.rows; ++y) {
      for (int x = 0; x < dx.cols; ++x) {
        const double w = keyframe.scene.inverse_depth[static_cast<std::size_t>(y * dx.cols + x)];
        const Vec3 p_W = keyframe.shot.T_W_C * Vec3(image_.pixel_to_point(Vec2(x, y)).homogeneous() / w);
        Eigen::Matrix2d squares = kGradientNoise * Eigen::Matrix2d::Identity();
        Vec2 products = Vec2::Zero();
        for (std::size_t i = recent_.size() - std::min(last, recent_.size()); i < recent_.size(); ++i) {
          const Shot& shot = recent_[i];
          const Vec3 p = shot.T_W_C.inverse() * p_W;
          const auto now = image_.project(p);
          const Vec2 way = moved(shot.T_before_now, p);
          if (!now || !image_.contains(*now, 1.0) || way.norm() < 0.2) continue;
          // Into pixels of the keyframe; perspective and slant are neglected.
          const Eigen::Matrix3d R = (keyframe.shot.T_W_C.inverse() * shot.T_W_C).R();
          const Vec2 own = p.z() * w * R.topLeftCorner<2, 2>() * way;
          squares += own * own.transpose();
          products += at(shot.*picture, *now - lag_px_ * way.normalized()) * own;
        }
        const Vec2 slope = -squares.inverse() * products;
        dx.at<float>(y, x) = static_cast<float>(slope.x()), dy.at<float>(y, x) = static_cast<float>(slope.y());
      }
    }
    return gradient_edges(keyframe.scene, blurred(dx, 0.5), blurred(dy, 0.5));
  }

  /// Where the event frame has the edge, along its normal, which points forwards.
  std::optional<Row> search(const EdgePoint& edge, const SE3& T, const cv::Mat& seen, const Search& how,
                            const Shot& now) const {
    const Vec3 p = T * edge.p;
    const auto x = image_.project(p), x_beside = image_.project(T * edge.beside);
    if (!x || !x_beside || !image_.contains(*x, kBorder_px)) return std::nullopt;
    const Vec2 along = (*x_beside - *x).normalized();
    Vec2 normal(along.y(), -along.x());
    if (normal.dot(edge.normal) < 0.0) normal = -normal;
    const Vec2 way = moved(now.T_before_now, p), forward = way.dot(normal) > 0.0 ? normal : Vec2(-normal);
    if (way.dot(forward) < kAlong * way.norm()) return std::nullopt;
    const double sign = how.polarity && forward == normal ? -1.0 : 1.0;
    const double expected = std::min(3.0, edge.slope * way.dot(forward));
    const auto peak =
        find_peak(seen, *x - how.lag_px * forward, forward, reach_px_, sign, std::max(kLeastHeight, 0.25 * expected));
    if (!peak) return std::nullopt;
    return Row{peak->place, std::min(peak->height, 2.0), forward, p};
  }

  /// Of every so many edges.
  Rows edge_rows(const std::vector<EdgePoint>& edges, const cv::Mat& seen, const Search& how, const Shot& now) const {
    return [=, this, &edges, &now](const SE3& T) {
      std::vector<Row> rows;
      for (std::size_t i = 0; i < edges.size(); i += how.every)
        if (const auto row = search(edges[i], T, seen, how, now)) rows.push_back(*row);
      return rows;
    };
  }

  /// Forwards and across, for each feature.
  Rows feature_rows(const KeyframeShot& keyframe, const Shot& now) const {
    return [this, &keyframe, &now](const SE3& T) {
      std::vector<Row> rows;
      for (const auto& [id, point] : keyframe.points) {
        const auto seen = now.features.find(id);
        const Vec3 p = T * point;
        const auto x = image_.project(p);
        if (seen == now.features.end() || !x) continue;
        const Vec2 forward = moved(now.T_before_now, p).normalized(), across(-forward.y(), forward.x());
        const Vec2 off = seen->second + feature_lag_px_ * forward - *x;
        rows.push_back({off.dot(forward), 1.0, forward, p});
        rows.push_back({off.dot(across), 1.0, across, p});
      }
      return rows;
    };
  }

  /// Errors in the camera now, of all six and with the rotation held at the truth; in pixels, over the edges of the
  /// scene.
  void report(const std::string& method, const KeyframeShot& keyframe, const Shot& now, std::size_t n,
              const Rows& rows) {
    const SE3 T_true = now.T_W_C.inverse() * keyframe.shot.T_W_C;
    const Vec3 turn = kStartAngle * random_.normal3().normalized();
    const Vec3 shift = kStartDistance_m * random_.normal3().normalized();
    std::vector<double> depths, speeds;
    std::string errors;
    for (const bool held : {false, true}) {
      const SE3 start = SE3(so3::exp(held ? Vec3::Zero() : turn), shift) * T_true;
      const SE3 T = align(image_, start, held, rows), error = T * T_true.inverse();
      double squares = 0.0, along = 0.0;
      depths.clear(), speeds.clear();
      for (const EdgePoint& edge : keyframe.edges.at("scene")) {
        const Vec3 p = T_true * edge.p;
        const auto x = image_.project(p), off = image_.project(T * edge.p);
        if (!x || !off || !image_.contains(*x)) continue;
        const Vec2 way = moved(now.T_before_now, p), shifted = *off - *x;
        squares += shifted.squaredNorm(), along += shifted.dot(way.normalized());
        depths.push_back(edge.p.z()), speeds.push_back(way.norm());
      }
      if (depths.empty()) return;
      const auto count = static_cast<double>(depths.size());
      const Vec3 off = error.translation();
      errors += held ? fmt::format(",{:.6f},{:.6f},{:.6f}", off.x(), off.y(), off.z())
                     : fmt::format(",{:.4f},{:.4f},{:.5f},{:.6f}", std::sqrt(squares / count), along / count,
                                   so3::log(error.rotation()).norm() * 180.0 / M_PI, off.norm());
    }
    out_ << fmt::format("{},{},{},{:.5f},{:.3f},{:.2f},{},{:.3f}{}\n", method, to_ns(now.t), to_ns(keyframe.shot.t),
                        T_true.translation().norm(), median(depths), median(speeds), n,
                        method == "features" ? feature_lag_px_ : lag_px_, errors);
  }

  /// By every method, or by none.
  void compare(const KeyframeShot& keyframe, const Shot& now) {
    const SE3 T_true = now.T_W_C.inverse() * keyframe.shot.T_W_C;
    const cv::Mat given = blurred(now.given, 0.8), changes = blurred(now.changes, 0.8), exact = blurred(now.exact, 0.8);
    const Rows features = feature_rows(keyframe, now);
    std::vector<std::pair<std::string, Rows>> methods = {{"features", features}};
    const auto add = [&](const std::string& method, const std::string& source, const cv::Mat& seen, const Search& how) {
      methods.emplace_back(method, edge_rows(keyframe.edges.at(source), seen, how, now));
    };
    add("frames", "frames", given, {false, lag_px_, 1});
    add("increments", "increments", changes, {true, lag_px_, 1});
    add("learned", "learned", changes, {true, lag_px_, 1});
    add("scene", "scene", changes, {true, lag_px_, 1});
    add("scene/4", "scene", changes, {true, lag_px_, 4});
    add("scene/16", "scene", changes, {true, lag_px_, 16});
    add("exact", "scene", exact, {true, 0.0, 1});
    for (const auto& [method, rows] : methods)
      if (rows(T_true).size() < kFewestRows) return;
    for (const auto& [method, rows] : methods)
      report(method, keyframe, now, rows(T_true).size() / (method == "features" ? 2 : 1), rows);
    calibrate(edge_rows(keyframe.edges.at("scene"), changes, {true, lag_px_, 1}, now)(T_true), 1, lag_px_);
    calibrate(features(T_true), 2, feature_lag_px_);
  }

  /// By the true pose: how far behind it is seen is the same for all, and would be a state of an estimator.
  static void calibrate(const std::vector<Row>& rows, std::size_t every, double& lag_px) {
    std::vector<double> ahead;
    for (std::size_t i = 0; i < rows.size(); i += every) ahead.push_back(rows[i].r);
    lag_px -= kLagGain * median(ahead);
  }

  EdgeOptions options_;
  SimulatorConfig config_;
  Simulator simulator_;
  std::unique_ptr<TrackTruth> truth_;
  RigCamera camera_;
  CameraModel image_;
  double reach_px_;  // of the search for an edge
  Renderer renderer_;
  EventFrameRenderer frames_;
  double lag_px_ = 0.3, feature_lag_px_ = 0.0;
  std::deque<Shot> recent_;
  std::deque<KeyframeShot> keyframes_;
  Random random_{1, 1};
  std::ofstream out_;
};

}  // namespace
}  // namespace edged

int main(int argc, char** argv) {
  using namespace edged;
  CLI::App app{"How well edges and features of an event frame tell its pose relative to a keyframe", "edged_edges"};
  EdgeOptions options;
  app.add_option("FLIGHT", options.source.recording, "As for edged run: sim:PRESET:SEED:KEY=VALUE,...")->required();
  app.add_option("--out", options.out, "Table to write (csv)")->required();
  return run_program(app, argc, argv, [&] { return Experiment(options).run(); });
}
