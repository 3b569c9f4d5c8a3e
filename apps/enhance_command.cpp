// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "enhance_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config_source.hpp"
#include "contact_sheet.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/events/accumulate.hpp"
#include "edged/events/enhance.hpp"
#include "edged/events/warp.hpp"
#include "edged/io/text.hpp"
#include "edged/odometry.hpp"
#include "exit_code.hpp"
#include "run_mode.hpp"
#include "source.hpp"
#include "status_line.hpp"

namespace edged {
namespace {

struct EnhanceOptions {
  SourceOptions source;
  ConfigSource config;
  double at_s = 0.0;
  std::filesystem::path out;
  bool quiet = false;
};

/// What the odometry had in hand at one packet.
struct Moment {
  Step step;
  cv::Mat uncompensated;  ///< the events of its event frame where they fell, undistorted
  cv::Mat frame;          ///< the newest standard frame; empty where there is none
};

Mode enhance_mode(const Source& source) { return source.dataset->info().has_frames ? Mode::Fused : Mode::Events; }

/// Runs the odometry up to a time, so that the warp has the poses of a real run.
class RunUpTo {
 public:
  RunUpTo(const EnhanceOptions& options, Source source, const OdometryConfig& config)
      : options_(options),
        config_(config),
        source_(std::move(source)),
        odometry_(source_.calibration.rig, source_.calibration.imu, enhance_mode(source_), config, {kInOrder}),
        status_(options.quiet) {}

  Moment go() {
    check_time(source_.dataset->info().end);
    drive(
        odometry_, [this] { return read(); }, [this](Step step) { return go_on(std::move(step)); });
    status_.clear();
    if (!found_) {
      check_time(newest_);
      throw InputError::format(
          "{}: no packet at {} s or later: the events or IMU samples end before; choose an earlier --at",
          options_.source.recording, options_.at_s);
    }
    return moment(std::move(*found_));
  }

 private:
  /// Refuses a time after the end, once begin and end are known.
  void check_time(std::optional<Timestamp> end) const {
    const std::optional<Timestamp> begin = begin_ ? begin_ : source_.dataset->info().begin;
    if (!begin || !end || to_seconds(*end - *begin) >= options_.at_s) return;
    throw InputError::format("{}: --at {} is outside the recording: give seconds from its start, 0 to {:.3f}",
                             options_.source.recording, options_.at_s, to_seconds(*end - *begin));
  }

  std::optional<Measurement> read() {
    std::optional<Measurement> measurement = source_.dataset->next();
    if (!measurement) return measurement;
    newest_ = last_stamp(*measurement).value_or(newest_);
    if (!begin_) begin_ = source_.dataset->info().begin.value_or(newest_);
    return measurement;
  }

  bool go_on(Step step) {
    if (step.frame) frame_ = step.frame->image;
    const double now_s = to_seconds(step.t - *begin_);
    if (status_.due()) status_.show(fmt::format("{:.1f} / {:.1f} s", now_s, options_.at_s));
    if (now_s < options_.at_s) return true;
    found_ = std::move(step);
    return false;
  }

  Moment moment(Step step) const {
    if (step.event_frame.empty()) {
      throw InputError::format(
          "{}: no events to draw at {} s: {} in the last {} s, and a frame needs expert.min_events_per_pixel = {} per "
          "pixel; "
          "choose another --at",
          options_.source.recording, options_.at_s, step.events.size(), config_.packets.max_age_s,
          config_.min_events_per_pixel);
    }
    const CameraModel& camera = source_.calibration.rig.find(Modality::Events)->model;
    const UndistortTable table(camera, ideal_pinhole(camera));
    const cv::Mat uncompensated =
        draw_event_frame(step.drawn_events(), CameraMotion(), 1.0, table, config_.event_frame);
    return {std::move(step), uncompensated, frame_};
  }

  const EnhanceOptions& options_;
  OdometryConfig config_;
  Source source_;
  Odometry odometry_;
  StatusLine status_;
  std::optional<Timestamp> begin_;
  Timestamp newest_;
  cv::Mat frame_;
  std::optional<Step> found_;
};

cv::Mat stage(const cv::Mat& event_frame, const EnhanceConfig& config, const std::string& name) {
  for (EnhanceStage& s : enhancement_stages(event_frame, config)) {
    if (s.name == name) return std::move(s.image);
  }
  return {};
}

EnhanceConfig with_method(EnhanceConfig config, EdgeMethod method) {
  config.method = method;
  if (method == EdgeMethod::Canny || method == EdgeMethod::Clahe) config.erosion_px = 0;
  return config;
}

EnhanceConfig with_sharpening(EnhanceConfig config, Sharpening sharpening) {
  config = with_method(config, EdgeMethod::Clahe);
  config.sharpening = sharpening;
  return config;
}

const std::pair<EdgeMethod, const char*> kEdgeMethods[] = {{EdgeMethod::Canny, "Canny"},
                                                           {EdgeMethod::Laplacian, "Laplacian"},
                                                           {EdgeMethod::Sobel, "Sobel"},
                                                           {EdgeMethod::Scharr, "Scharr"}};

/// One row a step of Algorithm 1, one column a method.
std::vector<SheetRow> all_stages(const Moment& moment, const EnhanceConfig& config) {
  const cv::Mat& events = moment.step.event_frame;
  const EnhanceConfig clahe = with_method(config, EdgeMethod::Clahe);
  std::vector<SheetRow> rows{
      {{"standard frame", moment.frame},
       {"events without compensation", moment.uncompensated},
       {"event frame, motion-compensated", events},
       {"Gaussian blur", stage(events, clahe, "blur")}},
      {{"CLAHE", stage(events, clahe, "clahe")},
       {"sharpened, paper", stage(events, with_sharpening(config, Sharpening::Paper), "sharpened")},
       {"sharpened, unsharp", stage(events, with_sharpening(config, Sharpening::Unsharp), "sharpened")},
       {"blend with CLAHE", stage(events, clahe, "result")}}};
  for (const auto& [name, caption] :
       {std::pair("edge", "edges, {}"), std::pair("eroded", "eroded, {}"), std::pair("result", "blend with {}")}) {
    if (name == std::string("eroded") && config.erosion_px == 0) continue;
    SheetRow& row = rows.emplace_back();
    for (const auto& [method, method_name] : kEdgeMethods) {
      row.push_back(
          {fmt::format(fmt::runtime(caption), method_name), stage(events, with_method(config, method), name)});
    }
  }
  return rows;
}

std::string file_name(int number, const std::string& caption) {
  std::string name = fmt::format("{:02d}_", number);
  for (const char c : lower_case(caption)) {
    if (c == ' ' || c == '-')
      name += '_';
    else if (c != ',')
      name += c;
  }
  return name + ".png";
}

void write_image(const std::filesystem::path& file, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), image);
  } catch (const cv::Exception&) {
  }
  if (!written) throw InputError::format("{}: cannot be written; choose another --out", file.string());
}

std::vector<std::string> title(const EnhanceOptions& options, const Moment& moment, const EnhanceConfig& config) {
  const Step& step = moment.step;
  const std::span<const Event> events = step.drawn_events();
  return {
      fmt::format("{} at {:.3f} s: {} events of {:.1f} ms, {}ev/s, scene depth {:.2f} m, {}", options.source.recording,
                  options.at_s, events.size(), 1e3 * to_seconds(step.t - events.front().t),
                  si_number(step.event_rate_hz), step.scene_depth, to_string(step.status)),
      fmt::format(
          "blur {} px, CLAHE clip {} on {} x {} tiles, lambda {}, gain {}, Canny {} to {}, blend {} event + {} edge",
          config.blur_sigma_px, config.clahe_clip, config.clahe_tiles, config.clahe_tiles, config.sharpen_lambda,
          config.edge_gain, config.canny_low, config.canny_high, config.event_weight, config.edge_weight)};
}

int run_enhance(const EnhanceOptions& options) {
  if (options.at_s < 0.0)
    throw InputError::format("--at {}: give seconds from the recording's start, not below 0", options.at_s);
  const OdometryConfig config = load_config(options.config).odometry;
  Source source = open_source(options.source);
  const DatasetInfo& info = source.dataset->info();
  if (!info.has_events) throw InputError::format("{}: has no events to enhance; take another recording", info.name);
  if (!info.has_imu)
    throw InputError::format("{}: has no IMU samples, which the warp needs; take another recording", info.name);
  match_cameras(source, enhance_mode(source));
  const Moment moment = RunUpTo(options, std::move(source), config).go();

  std::error_code failed;
  std::filesystem::create_directories(options.out, failed);
  if (failed)
    throw InputError::format("{}: cannot make this folder ({}); choose another --out", options.out.string(),
                             failed.message());
  const std::vector<SheetRow> rows = all_stages(moment, config.enhance);
  int number = 0;
  for (const SheetRow& row : rows) {
    for (const SheetCell& cell : row) {
      ++number;
      if (!cell.image.empty()) write_image(options.out / file_name(number, cell.caption), cell.image);
    }
  }
  const std::vector<std::string> lines = title(options, moment, config.enhance);
  write_image(options.out / "sheet.png", draw_contact_sheet(lines, rows));
  fmt::print("{}\n{}: sheet.png and every step by itself\n", lines.front(), options.out.string());
  return kExitOk;
}

}  // namespace

void add_enhance_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<EnhanceOptions>();
  CLI::App* enhance =
      app.add_subcommand("enhance", "Draw the event frame of one moment and every step of its enhancement");
  add_source_options(*enhance, options->source);
  enhance->add_option("--at", options->at_s, "[s] from the recording's start: the first packet from then on")
      ->required();
  enhance->add_option("--out", options->out, "Folder for sheet.png and one picture per step")->required();
  add_config_options(*enhance, options->config);
  enhance->add_flag("--quiet", options->quiet, "No status line");
  enhance->footer(
      "Example:\n  edged enhance sim:room --at 5 --out /tmp/steps --set enhance.clahe_clip=4 --set "
      "expert.enhance.erosion_px=3");
  enhance->callback([options, &chosen] { chosen = [options] { return run_enhance(*options); }; });
}

}  // namespace edged
