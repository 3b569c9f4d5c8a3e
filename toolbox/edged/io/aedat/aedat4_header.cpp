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

std::string_view aedat4_compression(std::int32_t number) {
  switch (number) {
    case 0:
      return "none";
    case 1:
    case 2:
      return "lz4";
    case 3:
    case 4:
      return "zstd";
    default:
      throw Damage("unknown compression");
  }
}

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
  const std::string_view xml = as_text(table.bytes(2));
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) throw Damage("its xml cannot be read");
  const tinyxml2::XMLElement* dv = document.FirstChildElement("dv");
  Aedat4Header header{aedat4_compression(table.number<std::int32_t>(0)), table.number<std::int64_t>(1, -1),
                      parse_streams(dv)};
  if (const std::string frame = attribute_text(dv, kAedat4PoseFrame); !frame.empty()) header.pose_frame = frame;
  return header;
}

std::vector<Topic> topics_of(const std::vector<Aedat4Stream>& streams) {
  std::vector<Topic> topics;
  for (const Aedat4Stream& s : streams) {
    Topic& topic = topics.emplace_back();
    topic.name = s.name.empty() ? s.type : s.name;
    topic.type = s.type;
    topic.count = 1;
  }
  const auto tell_apart = [&](const auto& addition) {
    std::vector<std::string> names;
    for (const Topic& topic : topics) names.push_back(topic.name);
    for (std::size_t i = 0; i < topics.size(); ++i)
      if (std::ranges::count(names, names[i]) > 1) topics[i].name += addition(streams[i]);
  };
  tell_apart([](const Aedat4Stream& s) { return "@" + s.source; });
  tell_apart([](const Aedat4Stream& s) { return fmt::format("#{}", s.number); });
  return topics;
}

}  // namespace edged
