// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/requests.hpp"

#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/whole_file.hpp"

namespace edged::node {
namespace {

constexpr std::size_t kMostRequests = 20;  // that may wait: saving takes a part of a second

}  // namespace

std::string Request::text() const {
  switch (kind) {
    case Kind::SaveMap:
      return "save_map " + file;
    case Kind::LoadMap:
      return "load_map " + file;
    case Kind::Reset:
      return "reset";
  }
  EDGED_CHECK(false, "request {}", static_cast<int>(kind));
}

Requests::Requests(Transport& transport) {
  subscribe(transport, "~/save_map", "std_msgs/String", Request::Kind::SaveMap);
  subscribe(transport, "~/load_map", "std_msgs/String", Request::Kind::LoadMap);
  subscribe(transport, "~/reset", "std_msgs/Empty", Request::Kind::Reset);
}

void Requests::subscribe(Transport& transport, const std::string& topic, const std::string& type, Request::Kind kind) {
  transport.subscribe_type(
      transport.full_name(topic), type, false,
      [this, kind, wire = transport.wire()](const WireMessage& message) { add(kind, wire, message.bytes); });
}

void Requests::add(Request::Kind kind, Wire wire, ByteSpan message) {
  Request request{kind, ""};
  try {
    if (kind != Request::Kind::Reset) request.file = WireReader(wire, message).text();
  } catch (const Damage& damage) {
    return spdlog::error("{}: unreadable: {}", request.text(), damage.what());
  }
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMostRequests) return spdlog::error("{}: not done: too many requests wait", request.text());
  waiting_.push_back(std::move(request));
}

std::optional<Request> Requests::next() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  Request request = std::move(waiting_.front());
  waiting_.pop_front();
  return request;
}

std::string read_map_file(const std::string& file) {
  std::optional<std::string> bytes = read_file(file);
  if (!bytes) throw InputError("cannot be read");
  return *std::move(bytes);
}

void write_map_file(const std::string& file, const std::string& bytes) {
  if (begins_otherwise(file, bytes.substr(0, bytes.find('\n') + 1)))  // name and version of the format
    throw InputError("the file is there and no map: choose another name, or remove it");
  try {
    write_file(file, bytes);
  } catch (const std::exception&) {
    throw InputError(
        "cannot be written: give the full name of a file in a folder that is there, may be written to and has room");
  }
}

}  // namespace edged::node
