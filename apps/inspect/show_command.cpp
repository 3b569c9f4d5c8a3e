// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/command.hpp"
#include "common/files.hpp"
#include "common/interrupt.hpp"
#include "common/reading.hpp"
#include "common/source.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "inspect/event_pictures.hpp"
#include "inspect/player_data.hpp"
#include "report/report_page.hpp"

namespace edged {
namespace {

constexpr int kWidestInPage_px = 400;

struct ShowOptions {
  SourceOptions source;
  std::filesystem::path out;
  double window_s = 0.02;
  std::size_t events = 0;
  std::string style = "polarity";
  PictureStyle picture_style() const { return style == "counts" ? PictureStyle::Counts : PictureStyle::Polarity; }
  PictureRule rule() const { return {duration_from_seconds(window_s), events}; }
  double max_mb = 4.5;
  std::size_t max_pictures = 10000;
  bool quiet = false, json = false;
};

/// Summary of what has been shown.
struct Shown {
  std::size_t pictures = 0, frames = 0, every = 1;
  std::optional<double> stopped_after_s;  ///< since the first image; set if the limit of images was reached
};

/// Reads to the end, or until `on_picture` stops it.
void read(const ShowOptions& options, Dataset& dataset, EventPictures pictures,
          const std::function<void(const Frame&)>& on_frame,
          const std::function<bool(const EventPicture&)>& on_picture) {
  bool more = true;
  const auto show = [&](const EventPicture& picture) { more = more && on_picture(picture); };
  read_through(dataset, options.quiet, "shown", [&](const Measurement& measurement) {
    if (const auto* batch = std::get_if<EventBatch>(&measurement)) pictures.add(batch->events, show);
    if (const auto* frame = std::get_if<Frame>(&measurement)) on_frame(*frame);
    return more;
  });
  pictures.finish(show);
}

/// events_000001.png, ... at full size, each new frame as frame_000001.png, ..., and pictures.csv about them.
Shown write_pictures(const ShowOptions& options, Dataset& dataset, cv::Size sensor) {
  make_picture_folder(options.out);
  std::string table = "file,begin_ns,end_ns,events,frame\n", frame_file;
  std::optional<Frame> newest;
  Timestamp begin;
  Shown shown;
  read(
      options, dataset, EventPictures(sensor, 1, options.rule()), [&](const Frame& frame) { newest = frame; },
      [&](const EventPicture& picture) {
        if (shown.pictures == 0) begin = picture.begin;
        if (shown.pictures == options.max_pictures) {
          shown.stopped_after_s = to_seconds(picture.begin - begin);
          return false;
        }
        if (newest) {
          frame_file = fmt::format("frame_{:06d}.png", ++shown.frames);
          write_picture(options.out / frame_file, newest->image);
          newest.reset();
        }
        const std::string file = fmt::format("events_{:06d}.png", ++shown.pictures);
        write_picture(options.out / file, draw_event_picture(picture, options.picture_style()));
        table +=
            fmt::format("{},{},{},{},{}\n", file, to_ns(picture.begin), to_ns(picture.end), picture.events, frame_file);
        return true;
      });
  write_file(options.out / "pictures.csv", table);
  return shown;
}

/// One page that plays them.
Shown write_page(const ShowOptions& options, Dataset& dataset, cv::Size sensor) {
  const int binning = (sensor.width + kWidestInPage_px - 1) / kWidestInPage_px;
  PlayerData player(static_cast<std::size_t>(1e6 * options.max_mb));
  read(
      options, dataset, EventPictures(sensor, binning, options.rule()), [&](const Frame& frame) { player.add(frame); },
      [&](const EventPicture& picture) {
        player.add(picture);
        return true;
      });
  nlohmann::ordered_json data = {{"version", kVersion},
                                 {"recording", dataset.info().name},
                                 {"format", dataset.info().format},
                                 {"sensor", {sensor.width, sensor.height}},
                                 {"binning", binning},
                                 {"window_s", options.window_s},
                                 {"events_each", options.events},
                                 {"style", options.style}};
  data.update(player.to_json());
  write_file(options.out, player_page(data));
  return {player.pictures(), data["frames"].size(), player.every(), {}};
}

void print_shown(const ShowOptions& options, const Shown& shown, const std::map<std::string, std::size_t>& repairs) {
  std::string text = fmt::format("{}: {} of events, {}\n", options.out.string(), quantity(shown.pictures, "picture"),
                                 quantity(shown.frames, "frame"));
  if (shown.every > 1)
    text +=
        fmt::format("one picture of {} kept, to stay below {} MB; a shorter part (--start, --duration) keeps more\n",
                    shown.every, options.max_mb);
  if (shown.stopped_after_s)
    text += fmt::format("stopped there; --max-pictures allows more, --start {:.3f} continues\n",
                        options.source.piece.from_s + *shown.stopped_after_s);
  print_result(options.json,
               {{"out", options.out.string()},
                {"pictures", shown.pictures},
                {"frames", shown.frames},
                {"every", shown.every},
                {"complete", !shown.stopped_after_s},
                {"repairs", repairs}},
               text);
}

int show_recording(const ShowOptions& options) {
  catch_interrupts();
  const bool page = options.out.extension() == ".html";
  if (page) check_writable(options.out, "--out", kPageBegin);
  const Recording recording = open_uncalibrated(options.source);
  Dataset& dataset = *recording.dataset;
  if (!dataset.info().has_events)
    throw InputError::format("{}: has no events to show; take another recording", dataset.info().name);
  if (!dataset.info().more_cameras.empty())
    throw InputError::format("--cameras {}: one camera of a kind is shown: leave out {}",
                             fmt::join(options.source.cameras, ","), dataset.info().more_cameras.front().name);
  const cv::Size sensor = recording_event_sensor(recording);
  const Shown shown = page ? write_page(options, dataset, sensor) : write_pictures(options, dataset, sensor);
  if (shown.pictures == 0) spdlog::warn(fmt::format("{}: no events", dataset.info().name));
  print_shown(options, shown, dataset.repairs());
  return exit_code_of_interrupt();
}

}  // namespace

void add_show_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* show = app.add_subcommand("show", "Show events beside frames: a page that plays them, or images");
  add_source_options(*show, options->source);
  add_cameras_option(*show, options->source, false);
  show->add_option("--out", options->out, "NAME.html: a page for a browser; otherwise a folder of PNG images")
      ->required();
  CLI::Option* window = show->add_option("--window", options->window_s, "Time window of one image [s]");
  window->check(positive_number())->check(CLI::Range(1e-6, 3600.0))->capture_default_str();
  show->add_option("--events", options->events, "Number of events per image, instead of a time window")
      ->check(CLI::PositiveNumber)
      ->excludes(window);
  show->add_option("--style", options->style,
                   "polarity: blue brighter, red darker; counts: grey (can be switched on the page)")
      ->check(CLI::IsMember({"polarity", "counts"}))
      ->capture_default_str();
  show->add_option("--max-mb", options->max_mb,
                   "Largest total size of the page's images; beyond it every second image is dropped [MB]")
      ->check(CLI::Range(0.1, 200.0))
      ->capture_default_str();
  show->add_option("--max-pictures", options->max_pictures, "Largest number of images in a folder")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  finish_command(*show, options,
                 "Needs neither IMU nor calibration. Examples:\n"
                 "  edged show flight.raw --out flight.html\n"
                 "  edged show flight.bag --start 20 --duration 5 --window 0.005 --out piece.html\n"
                 "  edged show events.txt --geometry 240x180 --events 20000 --style counts --out pictures",
                 chosen, show_recording);
}

}  // namespace edged
