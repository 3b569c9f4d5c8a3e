// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "live/page_server.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using ServerClock = std::chrono::steady_clock;
constexpr std::size_t kThreads = kMostViewers + 4;
constexpr time_t kLongestWait_s = 1;  // of one read or write: a viewer that does not read is disconnected
constexpr auto kTimeToAsk = std::chrono::seconds(5), kTimeToAnswer = std::chrono::seconds(30);  // of one client

/// That of httplib ends the program where a thread cannot be started.
class Threads : public httplib::TaskQueue {
 public:
  using Accepted = decltype(std::declval<httplib::TaskQueue&>().enqueue({}));  // nothing in httplib 0.11, bool in 0.18

  Threads() {
    while (threads_.size() < kThreads) threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  }
  Accepted enqueue(std::function<void()> job) override {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
    more_.notify_one();
    return static_cast<Accepted>(true);
  }
  void shutdown() override { threads_.clear(); }

 private:
  void work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (more_.wait(lock, stop, [this] { return !jobs_.empty(); })) {
      const std::function<void()> job = std::move(jobs_.front());
      jobs_.pop_front();
      lock.unlock();
      job();
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any more_;
  std::deque<std::function<void()>> jobs_;
  std::vector<std::jthread> threads_;  ///< last: they use the others
};

/// httplib bounds the wait for each byte; this the time of a client.
class BoundedStream : public httplib::Stream {
 public:
  BoundedStream(httplib::Stream& stream, const std::atomic<bool>& closing) : stream_(stream), closing_(closing) {}
  ServerClock::time_point until = ServerClock::now() + kTimeToAsk;

  bool is_readable() const override { return goes_on() && stream_.is_readable(); }
  bool is_writable() const override { return goes_on() && stream_.is_writable(); }
  ssize_t read(char* to, std::size_t size) override { return goes_on() ? stream_.read(to, size) : -1; }
  ssize_t write(const char* from, std::size_t size) override { return goes_on() ? stream_.write(from, size) : -1; }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { stream_.get_remote_ip_and_port(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { stream_.get_local_ip_and_port(ip, port); }
  socket_t socket() const override { return stream_.socket(); }

 private:
  bool goes_on() const { return !closing_ && ServerClock::now() < until; }

  httplib::Stream& stream_;
  const std::atomic<bool>& closing_;
};

/// "127.0.0.1:8765" and "[::1]:8765" without port and brackets.
std::string without_port(const std::string& host) {
  const std::size_t bracket = host.find(']');
  return bracket != std::string::npos ? host.substr(1, bracket - 1) : host.substr(0, host.find(':'));
}

bool is_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> ignored{};
  return inet_pton(AF_INET, host.c_str(), ignored.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), ignored.data()) == 1;
}

}  // namespace

std::optional<ServeAddress> parse_serve_address(const std::string& text) {
  ServeAddress address;
  if (text == "true") return address;
  std::string port = text;
  if (const std::size_t colon = text.rfind(':'); colon != std::string::npos) {
    address.host = text.substr(0, colon);
    port = text.substr(colon + 1);
    if (address.host.starts_with('[') && address.host.ends_with(']'))
      address.host = address.host.substr(1, address.host.size() - 2);
  }
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  const bool whole = error == std::errc() && end == port.data() + port.size();
  if (!whole || address.host.empty() || address.port < 0 || address.port > 65535) return std::nullopt;
  return address;
}

void refuse(httplib::Response& response, int status, const char* text) {
  response.status = status;
  response.set_content(text, "text/plain");
}

PageServer::PageServer(std::string host) : host_(std::move(host)) {
  try {
    threads_ = std::make_unique<Threads>();
  } catch (const std::system_error& e) {
    throw InputError::format("--serve: its {} threads cannot be started: {}; raise the limits (ulimit -v, -u)",
                             kThreads, e.code().message());
  }
  new_task_queue = [this] { return threads_.release(); };
  // Not httplib's default options, with which two programs could share a port. A large send buffer would delay the
  // updates of a slow viewer.
  set_socket_options([](int socket) {
    const int yes = 1, held_bytes = 1 << 15;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &held_bytes, sizeof held_bytes);
  });
  set_write_timeout(kLongestWait_s);
  set_tcp_nodelay(true);
}

bool PageServer::refuses(const httplib::Request& request, httplib::Response& response) const {
  const std::string host = without_port(request.get_header_value("Host"));
  if (request.method != "GET" && request.method != "HEAD") {
    refuse(response, 405, "Only GET requests are answered.\n");
  } else if (host != host_ && host != "localhost" && !is_address(host)) {
    refuse(response, 403,
           "This host name is refused: open the page by its address, or serve it with --serve=NAME:PORT.\n");
  } else {
    return false;
  }
  return true;
}

/// One request a connection: an idle one would occupy a thread, and browsers open some in advance.
bool PageServer::process_and_close_socket(socket_t socket) {
  const auto answer = [this](auto& bounded) {
    bool ignored = false;
    const std::function<void(httplib::Request&)> set_up = [&bounded](const httplib::Request& request) {
      const bool viewer = request.path == "/events";
      bounded.until = viewer ? ServerClock::time_point::max() : ServerClock::now() + kTimeToAnswer;
    };
    if constexpr (requires { process_request(bounded, true, ignored, set_up); })
      return process_request(bounded, true, ignored, set_up);
    else  // httplib 0.18 also takes both addresses, which the handlers do not use
      return process_request(bounded, {}, 0, {}, 0, true, ignored, set_up);
  };
  const bool answered = httplib::detail::process_client_socket(socket, kLongestWait_s, 0, kLongestWait_s, 0,
                                                               [this, &answer](httplib::Stream& stream) {
                                                                 BoundedStream bounded(stream, closing_);
                                                                 return answer(bounded);
                                                               });
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return answered;
}

}  // namespace edged
