// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/calib/yaml_reader.hpp"

#include <spdlog/fmt/fmt.h>
#include <tinyxml2.h>

#include <algorithm>
#include <string>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

/// A text in quotes is one item.
YAML::Node leaf(std::string_view text) {
  const std::size_t quote = text.find('"'), end = text.rfind('"');
  if (quote != end) return YAML::Node(std::string(text.substr(quote + 1, end - quote - 1)));
  std::string words(text);
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  FieldReader fields(words);
  const std::string first(fields.next());
  std::string_view next = fields.next();
  if (next.empty()) return YAML::Node(first);
  YAML::Node list(YAML::NodeType::Sequence);
  list.push_back(first);
  for (; !next.empty(); next = fields.next()) list.push_back(std::string(next));
  return list;
}

YAML::Node value_of(const tinyxml2::XMLElement& element) {
  const tinyxml2::XMLElement* child = element.FirstChildElement();
  if (!child) return leaf(element.GetText() ? element.GetText() : "");
  const bool is_list = std::string_view(child->Name()) == "_";
  YAML::Node node(is_list ? YAML::NodeType::Sequence : YAML::NodeType::Map);
  for (; child; child = child->NextSiblingElement())
    is_list ? node.push_back(value_of(*child)) : node.force_insert(std::string(child->Name()), value_of(*child));
  return node;
}

}  // namespace

bool is_xml(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return begin != std::string_view::npos && text[begin] == '<';
}

YAML::Node parse_opencv_xml(std::string_view text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw Damage(fmt::format("not readable as xml from line {} on", document.ErrorLineNum()));
  const tinyxml2::XMLElement* root = document.FirstChildElement("opencv_storage");
  if (!root) throw Damage("xml, but not of OpenCV: it has no element opencv_storage");
  return value_of(*root);
}

}  // namespace edged
