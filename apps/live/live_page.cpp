// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <condition_variable>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/cli.hpp"
#include "common/json_text.hpp"
#include "edged/core/check.hpp"
#include "live/live_feed.hpp"
#include "live/page_server.hpp"
#include "report/report_page.hpp"
#include "run/run_context.hpp"
#include "scene/live_points.hpp"

namespace edged {
namespace {

using WallClock = std::chrono::steady_clock;
constexpr auto kUpdatePeriod = std::chrono::milliseconds(200), kEndPeriod = std::chrono::milliseconds(20);
constexpr auto kLongestFarewell = std::chrono::seconds(10), kPatience = std::chrono::seconds(2),
               kTimeToConnect = std::chrono::seconds(1);

/// Sent by a provider: a plain body would be compressed, which is slower than the local network.
/// sent: called when the response has been sent, or has failed.
void reply(httplib::Response& response, const char* type, std::string body, std::function<void()> sent = nullptr) {
  response.set_header("Cache-Control", "no-store");
  const std::size_t size = body.size();
  response.set_content_provider(
      size, type,
      [body = std::move(body)](std::size_t at, std::size_t length, httplib::DataSink& sink) {
        return sink.write(body.data() + at, length);
      },
      [sent = std::move(sent)](bool) {
        if (sent) sent();
      });
}

std::string url_of(const ServeAddress& address) {
  const bool v6 = address.host.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}/", v6 ? "[" : "", address.host, v6 ? "]" : "", address.port);
}

/// The title of the run on the live page.
nlohmann::ordered_json about_run(const RunContext& run, const LivePoints& points) {
  const DatasetInfo& info = run.info();
  const bool ends = info.begin && info.end;
  return {{"version", kVersion},
          {"recording", info.name},
          {"format", info.format},
          {"mode", mode_name(run.mode)},
          {"frame", run.frame.name()},
          {"dense", points.has_points},
          {"voxels", points.has_voxels},
          {"whole_s", ends ? nlohmann::ordered_json(to_seconds(*info.end - *info.begin)) : nlohmann::ordered_json()}};
}

/// A server in threads of its own. Calls by the thread of the run do not block, whatever browsers do, except `finish`.
class LivePage {
 public:
  LivePage(const ServeAddress& address, const nlohmann::ordered_json& about, std::string frame,
           const LivePoints& dense);
  ~LivePage();
  /// Notifies the viewers that the run is over. They get report.html of the folder in place of the live page; returns
  /// when all have it, after at most 10 s, or 2 s after the last request.
  void finish(RunProgress progress, const nlohmann::ordered_json& metrics, const std::filesystem::path& folder);

  LiveFeed feed;
  std::string url;

 private:
  /// One viewer, in the thread that serves it.
  struct Viewer {
    LiveFeed::Place place;
    WallClock::time_point due = WallClock::now();
    bool knows_the_end = false;
  };

  void answer();
  void bind(ServeAddress address);
  void welcome(httplib::Response& response);
  bool tell(Viewer& viewer, httplib::DataSink& sink);
  void send_report(httplib::Response& response);
  void part_from_viewers();

  std::string page_;
  PageServer http_;

  std::mutex mutex_;  ///< guards all below but the thread
  std::condition_variable changed_;
  bool closing_ = false;
  std::string end_;               ///< metrics.json on one line, once the run is over
  std::filesystem::path report_;  ///< report.html, once the run is over
  std::size_t reports_on_the_way_ = 0, most_viewers_ = 0, left_out_ = 0;
  WallClock::time_point page_sent_, asked_;  ///< time of the last request of the page, and of any request

  std::jthread thread_;  ///< last: it uses the others
};

LivePage::LivePage(const ServeAddress& address, const nlohmann::ordered_json& about, std::string frame,
                   const LivePoints& dense)
    : feed(std::move(frame), dense), page_(live_report_page(about)), http_(address.host) {
  answer();
  bind(address);
  thread_ = std::jthread([this] { http_.listen_after_bind(); });
  while (!http_.is_running())
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // stop() works only after this
}

LivePage::~LivePage() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  http_.close();
  http_.stop();
}

void LivePage::bind(ServeAddress address) {
  const std::string wanted = fmt::format("{}:{}", address.host, address.port);
  errno = 0;
  if (address.port != 0) {
    if (!http_.bind_to_port(address.host, address.port)) address.port = -1;
  } else {
    address.port = http_.bind_to_any_port(address.host);
  }
  if (address.port > 0) {
    url = url_of(address);
    return;
  }
  const int error = errno;
  const bool told = error == EADDRINUSE || error == EADDRNOTAVAIL || error == EACCES;
  throw InputError::format("--serve: {}: {}; give another port or address, --serve=[HOST:]PORT, or --serve=0", wanted,
                           told ? std::generic_category().message(error) : "no such address");
}

void LivePage::answer() {
  http_.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (http_.refuses(request, response)) return httplib::Server::HandlerResponse::Handled;
    const std::lock_guard lock(mutex_);
    asked_ = WallClock::now();
    return httplib::Server::HandlerResponse::Unhandled;
  });
  http_.Get("/", [this](const httplib::Request&, httplib::Response& response) {
    reply(response, "text/html; charset=utf-8", page_);
    const std::lock_guard lock(mutex_);
    page_sent_ = WallClock::now();
  });
  http_.Get("/events", [this](const httplib::Request&, httplib::Response& response) { welcome(response); });
  http_.Get(R"(/([^/]+)\.jpg)", [this](const httplib::Request& request, httplib::Response& response) {
    const auto jpeg = feed.picture(request.matches[1]);
    if (jpeg.empty()) return refuse(response, 404, "There is no image yet.\n");
    reply(response, "image/jpeg", {jpeg.begin(), jpeg.end()});
  });
  http_.Get("/report.html", [this](const httplib::Request&, httplib::Response& response) { send_report(response); });
}

void LivePage::welcome(httplib::Response& response) {
  {
    const std::lock_guard lock(mutex_);
    if (feed.viewers() >= kMostViewers) return refuse(response, 503, "Too many viewers already.\n");
    feed.viewer_came();
    most_viewers_ = std::max(most_viewers_, feed.viewers());
  }
  response.set_header("Cache-Control", "no-store");
  response.set_content_provider(
      "text/event-stream",
      [this, viewer = std::make_shared<Viewer>()](std::size_t, httplib::DataSink& sink) { return tell(*viewer, sink); },
      [this](bool) {
        feed.viewer_left();
        changed_.notify_all();
      });
}

/// Sends the next update when it is due. A slow viewer misses updates. False: the viewer has disconnected.
bool LivePage::tell(Viewer& viewer, httplib::DataSink& sink) {
  std::string end;
  {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, viewer.due, [&] { return closing_ || (!end_.empty() && !viewer.knows_the_end); });
    if (closing_) return sink.done(), true;
    end = end_;
    const auto missed =
        static_cast<std::size_t>(std::max<WallClock::rep>(0, (WallClock::now() - viewer.due) / kUpdatePeriod));
    if (!viewer.knows_the_end) viewer.place.left_out += missed, left_out_ += missed;
  }
  viewer.due = WallClock::now() + (end.empty() ? kUpdatePeriod : kEndPeriod);
  const auto write = [&sink](const std::string& text) { return sink.write(text.data(), text.size()); };
  if (viewer.knows_the_end) return write(": the run is over\n\n");  // fails once the browser has disconnected
  if (!write("data: " + feed.news(viewer.place) + "\n\n")) return false;
  viewer.knows_the_end = !end.empty();
  return end.empty() || write("event: end\ndata: " + end + "\n\n");
}

void LivePage::send_report(httplib::Response& response) {
  std::filesystem::path file;
  {
    const std::lock_guard lock(mutex_);
    file = report_;
    if (!file.empty()) ++reports_on_the_way_;
  }
  if (file.empty()) return refuse(response, 404, "The run has not ended.\n");
  std::ifstream in(file, std::ios::binary);
  reply(response, "text/html; charset=utf-8", {std::istreambuf_iterator<char>(in), {}}, [this] {
    const std::lock_guard lock(mutex_);
    --reports_on_the_way_;
    asked_ = WallClock::now();
    changed_.notify_all();
  });
}

void LivePage::finish(RunProgress progress, const nlohmann::ordered_json& metrics,
                      const std::filesystem::path& folder) {
  feed.finish(std::move(progress));
  {
    const std::lock_guard lock(mutex_);
    report_ = folder / "report.html";
    end_ = compact_json(metrics);
    asked_ = WallClock::now();
  }
  changed_.notify_all();
  part_from_viewers();
}

void LivePage::part_from_viewers() {
  const auto begin = WallClock::now();
  std::unique_lock lock(mutex_);
  while (true) {
    const auto now = WallClock::now();
    const bool watched = feed.viewers() > 0 || now < page_sent_ + kTimeToConnect;
    const bool heard = reports_on_the_way_ > 0 || now < asked_ + kPatience;
    if (!(watched || reports_on_the_way_ > 0) || !heard || now > begin + kLongestFarewell) break;
    changed_.wait_for(lock, std::chrono::milliseconds(20));
  }
  spdlog::info(
      fmt::format("live page: at most {} viewers at once, {} updates skipped for slow ones", most_viewers_, left_out_));
}

struct ServeOptions {
  std::string address;  ///< "true" for the default; "" without a live page
};

class ServedPage : public RunObserver {
 public:
  explicit ServedPage(RunContext& run)
      : run_(run),
        points_(run.products.get<LivePoints>()),
        snapshots_(run.products.get<Snapshots>()),
        page_(*parse_serve_address(run.options.outputs.get<ServeOptions>().address), about_run(run, points_),
              run.frame.name(), points_) {
    points_.watched = true;
  }
  const char* stage() const override { return "serve"; }
  void on_begin() override { fmt::print(stderr, "edged: watch at {}\n", page_.url); }
  void on_step(const Step& step) override { page_.feed.add(step, progress(), snapshots_); }
  void on_end(const RunEnd& end) override { page_.finish(progress(), to_json(end.summary), run_.folder); }

 private:
  RunProgress progress() const { return {run_.statistics, run_.meter.wall_s(), run_.pace}; }

  const RunContext& run_;
  LivePoints& points_;
  const Snapshots& snapshots_;
  LivePage page_;
};

}  // namespace

RunOutput live_page_output() {
  return {{},
          [](CLI::App& command, Board& options) {
            command
                .add_flag("--serve", options.get<ServeOptions>().address,
                          "Show the run live in a browser; --serve=PORT or --serve=HOST:PORT, port 0: any free port "
                          "[127.0.0.1:8765]")
                ->check([](const std::string& given) {
                  return parse_serve_address(given)
                             ? ""
                             : fmt::format("'{}' is not PORT or HOST:PORT, such as --serve=8765", given);
                });
          },
          [](RunContext& run) -> std::unique_ptr<RunObserver> {
            if (run.options.outputs.get<ServeOptions>().address.empty()) return nullptr;
            return std::make_unique<ServedPage>(run);
          }};
}

}  // namespace edged
