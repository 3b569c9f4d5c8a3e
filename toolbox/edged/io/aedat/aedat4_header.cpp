// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The table IOHE and the xml text in it.
#include "edged/io/aedat/aedat4_header.hpp"

#include <spdlog/fmt/fmt.h>
#include <tinyxml2.h>

#include <algorithm>

#include "edged/io/aedat/flat_table.hpp"
#include "edged/io/core/geometry.hpp"

namespace edged {
namespace {

const tinyxml2::XMLElement* child_named(const tinyxml2::XMLElement* parent, const char* kind, const char* name,
                                        const char* attribute) {
  for (const auto* e = parent ? parent->FirstChildElement(kind) : nullptr; e; e = e->NextSiblingElement(kind))
    if (e->Attribute(attribute, name)) return e;
  return nullptr;
}

/// The text of `<attr key="KEY">`; "" where there is none.
std::string attribute_text(const tinyxml2::XMLElement* node, const char* key) {
  const auto* e = child_named(node, "attr", key, "key");
  return e && e->GetText() ? e->GetText() : "";
}

std::vector<Aedat4Stream> parse_streams(const tinyxml2::XMLElement* dv) {
  const auto* list = child_named(dv, "node", "outInfo", "name");
  std::vector<Aedat4Stream> streams;
  for (const auto* s = list ? list->FirstChildElement("node") : nullptr; s; s = s->NextSiblingElement("node")) {
    const auto* info = child_named(s, "node", "info", "name");
    streams.push_back({s->IntAttribute("name", -1), attribute_text(s, "typeIdentifier"),
                       attribute_text(s, "originalOutputName"), attribute_text(info, "source"),
                       parse_geometry(attribute_text(info, "sizeX") + "x" + attribute_text(info, "sizeY"))});
  }
  return streams;
}

}  // namespace

Aedat4Header parse_aedat4_header(ByteSpan buffer) {
  const FlatTable table(buffer);
  const std::string_view xml = as_text(table.bytes(aedat4::kXml));
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) throw Damage("its xml cannot be read");
  const tinyxml2::XMLElement* dv = document.FirstChildElement("dv");
  const auto number = static_cast<std::uint32_t>(table.number<std::int32_t>(aedat4::kCompression));
  if (number >= kAedat4Compressions.size()) throw Damage("unknown compression");
  Aedat4Header header{kAedat4Compressions[number].method, table.number<std::int64_t>(aedat4::kTableAt, -1),
                      parse_streams(dv)};
  if (const std::string frame = attribute_text(dv, kAedat4PoseFrame); !frame.empty()) header.pose_frame = frame;
  return header;
}

Aedat4PacketHead parse_packet_head(ByteSpan head, const std::vector<Aedat4Stream>& streams) {
  Aedat4PacketHead packet{number_at<std::int32_t>(head, 0), number_at<std::int32_t>(head, 4), std::nullopt};
  const auto known = std::ranges::find(streams, packet.number, &Aedat4Stream::number);
  if (known != streams.end() && packet.bytes > 0) packet.stream = static_cast<std::size_t>(known - streams.begin());
  return packet;
}

std::vector<Topic> topics_of(const std::vector<Aedat4Stream>& streams) {
  std::vector<Topic> topics;
  for (const Aedat4Stream& s : streams) {
    Topic& topic = topics.emplace_back();
    topic.name = s.name.empty() ? s.type : s.name;
    topic.type = s.type;
    topic.count = 1;
  }
  const auto distinguish = [&](const auto& addition) {
    std::vector<std::string> names;
    for (const Topic& topic : topics) names.push_back(topic.name);
    for (std::size_t i = 0; i < topics.size(); ++i)
      if (std::ranges::count(names, names[i]) > 1) topics[i].name += addition(streams[i]);
  };
  distinguish([](const Aedat4Stream& s) { return "@" + s.source; });
  distinguish([](const Aedat4Stream& s) { return fmt::format("#{}", s.number); });
  return topics;
}

}  // namespace edged
