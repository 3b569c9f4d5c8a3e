// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "common/config_source.hpp"
#include "common/files.hpp"
#include "common/json_text.hpp"
#include "common/pictures.hpp"
#include "common/source.hpp"
#include "common/status_line.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/events/accumulate.hpp"
#include "edged/events/enhance.hpp"
#include "edged/events/tuning.hpp"
#include "edged/events/warp.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/odometry.hpp"

namespace edged {
namespace {

struct EnhanceOptions {
  SourceOptions source;
  ConfigSource config;
  double at_s = 0.0;
  std::filesystem::path out;
  bool quiet = false, json = false;
};

/// The input of enhancement at one packet; without IMU or calibration from the recording alone.
struct Moment {
  Step step;
  cv::Mat uncompensated;  ///< its events without motion compensation, undistorted; empty if that is the same
  cv::Mat frame;          ///< the newest standard frame; empty where there is none
  std::string drawn_how;  ///< its event frame
};

Mode enhance_mode(const Source& source) { return source.dataset->info().has_frames ? Mode::Fused : Mode::Events; }

/// Refuses a time after the end, once begin and end are known.
void refuse_outside(const EnhanceOptions& options, std::optional<Timestamp> begin, std::optional<Timestamp> end) {
  if (!begin || !end || to_seconds(*end - *begin) >= options.at_s) return;
  throw InputError::format("{}: --at {} is outside the recording: give seconds from its start, 0 to {:.3f}",
                           options.source.recording, options.at_s, to_seconds(*end - *begin));
}

InputError too_few_events(const EnhanceOptions& options, std::size_t events, const OdometryConfig& config) {
  return InputError::format(
      "{}: no events to render at {} s: {} in the last {} s, and a frame needs expert.min_events_per_pixel = {} per "
      "pixel; choose another --at",
      options.source.recording, options.at_s, events, config.packets.max_age_s, config.min_events_per_pixel);
}

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
  void check_time(std::optional<Timestamp> end) const {
    refuse_outside(options_, begin_ ? begin_ : source_.dataset->info().begin, end);
  }

  std::optional<Measurement> read() {
    std::optional<Measurement> measurement = source_.dataset->next();
    if (!measurement) return measurement;
    newest_ = last_stamp(*measurement).value_or(newest_);
    if (!begin_) begin_ = source_.dataset->info().begin.value_or(newest_);
    return measurement;
  }

  bool go_on(Step step) {
    const CameraStep* frames = step.find(Modality::Frames);
    if (frames && !frames->image.empty()) frame_ = frames->image;
    const double now_s = to_seconds(step.t - *begin_);
    if (status_.due()) status_.show(fmt::format("{:.1f} / {:.1f} s", now_s, options_.at_s));
    if (now_s < options_.at_s) return true;
    found_ = std::move(step);
    return false;
  }

  Moment moment(Step step) const {
    const CameraStep& events = *step.find(Modality::Events);
    if (events.image.empty()) throw too_few_events(options_, events.events.size(), config_);
    const CameraModel& camera = source_.calibration.rig.find(Modality::Events)->model;
    const UndistortTable table(camera, ideal_pinhole(camera));
    const cv::Mat uncompensated =
        render_event_frame(events.rendered_events(), CameraMotion(), 1.0, table, config_.event_frame);
    return {std::move(step), uncompensated, frame_, "motion-compensated"};
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

Moment run_up_to(const EnhanceOptions& options, Recording recording, const OdometryConfig& config) {
  Source source = calibrated(options.source, std::move(recording));
  match_cameras(source, enhance_mode(source));
  return RunUpTo(options, std::move(source), config).go();
}

/// Why the odometry cannot run; empty where it can.
std::string lacks(const Recording& recording) {
  if (!recording.dataset->info().has_imu) return "the recording has no IMU samples (--imu FILE)";
  if (!recording.calibration) return "there is no calibration (--rig NAME, --calib FILE)";
  return recording.calibration->has_extrinsics ? "" : "the calibration does not contain the camera's pose to the IMU";
}

/// The lens if it is known; else one without distortion.
CameraModel lens_of(const Recording& recording) {
  const RigCamera* known = recording.calibration ? recording.calibration->rig.find(Modality::Events) : nullptr;
  if (known) return known->model;
  const cv::Size size = recording_event_sensor(recording);
  return CameraModel(size.width, size.height, size.width, size.width, 0.5 * (size.width - 1), 0.5 * (size.height - 1));
}

/// The newest events before a time, as many as an event frame has, without motion compensation, which needs poses.
Moment plain_moment(const EnhanceOptions& options, const Recording& recording, const OdometryConfig& config) {
  const CameraModel lens = lens_of(recording);
  const CameraModel ideal = lens.distortion() == DistortionModel::None ? lens : ideal_pinhole(lens);
  const double pixels = static_cast<double>(lens.width()) * lens.height();
  const auto most = static_cast<std::size_t>(config.packets.window_per_pixel * pixels);
  Moment moment{
      {}, {}, {}, ideal == lens ? "raw pixels, not motion-compensated" : "undistorted, not motion-compensated"};
  CameraStep& camera = moment.step.cameras.emplace_back(CameraStep{.name = "events", .modality = Modality::Events});
  std::vector<Event>& events = camera.events;
  std::optional<Timestamp> begin = recording.dataset->info().begin;
  refuse_outside(options, begin, recording.dataset->info().end);
  Timestamp newest;
  const auto is_later = [&](Timestamp t) { return to_seconds(t - *begin) > options.at_s; };
  while (const std::optional<Measurement> measurement = recording.dataset->next()) {
    const std::optional<Timestamp> t = last_stamp(*measurement);
    if (!t) continue;
    if (!begin) begin = first_stamp(*measurement);
    newest = *t;
    if (const auto* batch = std::get_if<EventBatch>(&*measurement))
      std::ranges::copy_if(batch->events, std::back_inserter(events),
                           [&](const Event& event) { return !is_later(event.t); });
    if (is_later(newest)) break;
    if (const auto* frame = std::get_if<Frame>(&*measurement)) moment.frame = frame->image;
    if (events.size() > 2 * most) events.erase(events.begin(), events.end() - static_cast<std::ptrdiff_t>(most));
  }
  if (!begin) throw too_few_events(options, 0, config);
  refuse_outside(options, begin, newest);
  moment.step.t = *begin + duration_from_seconds(options.at_s);
  const Timestamp oldest = moment.step.t - duration_from_seconds(config.packets.max_age_s);
  std::erase_if(events, [&](const Event& event) { return event.t < oldest; });
  if (events.size() > most) events.erase(events.begin(), events.end() - static_cast<std::ptrdiff_t>(most));
  if (events.empty() || static_cast<double>(events.size()) < config.min_events_per_pixel * pixels)
    throw too_few_events(options, events.size(), config);
  camera.rendered = events.size();
  const double span_s = to_seconds(moment.step.t - events.front().t);
  camera.event_rate_hz = span_s > 0.0 ? static_cast<double>(events.size()) / span_s : 0.0;
  camera.image = render_event_frame(events, CameraMotion(), 1.0, UndistortTable(lens, ideal), config.event_frame);
  return moment;
}

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

std::string capitalised(std::string_view word) {
  std::string out(word);
  out.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(out.front())));
  return out;
}

/// One row per step of Algorithm 1, one column per method.
std::vector<SheetRow> all_stages(const Moment& moment, const EnhanceConfig& config) {
  const cv::Mat& events = moment.step.find(Modality::Events)->image;
  const EnhanceConfig clahe = with_method(config, EdgeMethod::Clahe);
  std::vector<SheetRow> rows{
      {{"standard frame", moment.frame},
       {"events without compensation", moment.uncompensated},
       {"event frame, " + moment.drawn_how, events},
       {"Gaussian blur", stage(events, clahe, "blur")}},
      {{"CLAHE", stage(events, clahe, "clahe")},
       {"sharpened, paper", stage(events, with_sharpening(config, Sharpening::Paper), "sharpened")},
       {"sharpened, unsharp", stage(events, with_sharpening(config, Sharpening::Unsharp), "sharpened")},
       {"blend with CLAHE", stage(events, clahe, "result")}}};
  for (const auto& [name, caption] :
       {std::pair("edge", "edges, {}"), std::pair("eroded", "eroded, {}"), std::pair("result", "blend with {}")}) {
    if (name == std::string("eroded") && config.erosion_px == 0) continue;
    SheetRow& row = rows.emplace_back();
    for (const EdgeFilter& filter : edge_filters()) {
      if (filter.method == EdgeMethod::None || filter.method == EdgeMethod::Clahe) continue;
      row.push_back({fmt::format(fmt::runtime(caption), capitalised(filter.name)),
                     stage(events, with_method(config, filter.method), name)});
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

std::vector<std::string> title(const EnhanceOptions& options, const Moment& moment, const EnhanceConfig& config) {
  const Step& step = moment.step;
  const CameraStep& camera = *step.find(Modality::Events);
  const std::span<const Event> events = camera.rendered_events();
  const std::string known = moment.uncompensated.empty()
                                ? moment.drawn_how
                                : fmt::format("scene depth {:.2f} m, {}", step.scene_depth, to_string(step.status));
  return {
      fmt::format("{} at {:.3f} s: {} events of {:.1f} ms, {}ev/s, {}", options.source.recording, options.at_s,
                  events.size(), 1e3 * to_seconds(step.t - events.front().t), si_number(camera.event_rate_hz), known),
      fmt::format(
          "blur {} px, CLAHE clip {} on {} x {} tiles, lambda {}, gain {}, Canny {} to {}, blend {} event + {} edge",
          config.blur_sigma_px, config.clahe_clip, kEventsTuning.clahe_tiles, kEventsTuning.clahe_tiles,
          config.sharpen_lambda, config.edge_gain, config.canny_low, config.canny_high, config.event_weight,
          config.edge_weight)};
}

int run_enhance(const EnhanceOptions& options) {
  if (options.at_s < 0.0)
    throw InputError::format("--at {}: give seconds from the recording's start, not below 0", options.at_s);
  const OdometryConfig config = load_config(options.config).odometry;
  Recording recording = open_uncalibrated(options.source);
  const DatasetInfo& info = recording.dataset->info();
  if (!info.has_events) throw InputError::format("{}: has no events to enhance; take another recording", info.name);
  const std::string lacking = lacks(recording);
  const Moment moment =
      lacking.empty() ? run_up_to(options, std::move(recording), config) : plain_moment(options, recording, config);
  if (!lacking.empty())
    spdlog::warn(fmt::format("without poses the event frame is rendered {}: {}", moment.drawn_how, lacking));
  make_picture_folder(options.out);
  const std::vector<SheetRow> rows = all_stages(moment, config.enhance);
  int number = 0;
  for (const SheetRow& row : rows) {
    for (const SheetCell& cell : row) {
      ++number;
      if (!cell.image.empty()) write_picture(options.out / file_name(number, cell.caption), cell.image);
    }
  }
  const std::vector<std::string> lines = title(options, moment, config.enhance);
  write_picture(options.out / "sheet.png", draw_contact_sheet(lines, rows));
  const nlohmann::ordered_json json = {{"out", options.out.string()},
                                       {"pictures", number},
                                       {"events", moment.step.find(Modality::Events)->rendered},
                                       {"drawn_how", moment.drawn_how}};
  fmt::print("{}\n", options.json ? json_text(json)
                                  : fmt::format("{}\n{}: sheet.png and every step by itself", lines.front(),
                                                options.out.string()));
  return kExitOk;
}

}  // namespace

void add_enhance_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<EnhanceOptions>();
  CLI::App* enhance = app.add_subcommand("enhance",
                                         "Render the event frame of one moment and every step of its enhancement; "
                                         "without IMU or calibration, without motion compensation");
  add_source_options(*enhance, options->source);
  enhance
      ->add_option("--at", options->at_s, "Use the first packet from this time on [s from the start of the recording]")
      ->required();
  enhance->add_option("--out", options->out, "Folder for sheet.png and one image per step")->required();
  add_config_options(*enhance, options->config);
  enhance->add_flag("--quiet", options->quiet, "No status line");
  enhance->add_flag("--json", options->json, "Print what was written as JSON");
  enhance->footer(
      "Example:\n  edged enhance sim:room --at 5 --out /tmp/steps --set enhance.clahe_clip=4 --set "
      "expert.enhance.erosion_px=3");
  enhance->callback([options, &chosen] { chosen = [options] { return run_enhance(*options); }; });
}

}  // namespace edged
