// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/point_cloud.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/json_text.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read and packed as they lie in memory");

constexpr float kMostSteps = 65535.0F;

/// Header of a PLY file as those of a run are: binary, vertices alone, of floats and bytes.
struct PlyHeader {
  std::size_t count = 0, vertex_bytes = 0;
  std::map<std::string, std::size_t> floats, bytes;  ///< offsets of properties in a vertex
};

[[noreturn]] void refuse(const std::filesystem::path& file, const char* why) {
  throw InputError::format("{}: damaged ({}); run it again, or remove the file", file.string(), why);
}

/// Takes the property after those that are known.
void add_property(PlyHeader& header, const std::string& type, const std::string& name) {
  const bool is_float = type == "float";
  (is_float ? header.floats : header.bytes)[name] = header.vertex_bytes;
  header.vertex_bytes += is_float ? sizeof(float) : 1;
}

/// Moves `in` past the header.
PlyHeader read_header(const std::filesystem::path& file, std::ifstream& in) {
  PlyHeader header;
  std::string line;
  if (!std::getline(in, line) || line != "ply") refuse(file, "it is not a PLY file");
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string what, type, name;
    words >> what >> type >> name;
    if (what == "format" && type != "binary_little_endian") refuse(file, "it is not binary");
    if (what == "element" && !(std::istringstream(name) >> header.count)) refuse(file, "it has no number of points");
    if (what != "property") continue;
    if (type != "float" && type != "uchar") refuse(file, "its points have a property of another type");
    add_property(header, type, name);
  }
  if (line != "end_header") refuse(file, "its header has no end");
  for (const char* axis : {"x", "y", "z"})
    if (!header.floats.contains(axis)) refuse(file, "its points have no position");
  return header;
}

float float_at(const char* vertex, std::size_t offset) {
  float value = 0.0F;
  std::memcpy(&value, vertex + offset, sizeof value);
  return value;
}

}  // namespace

std::string ply_header(bool binary, const std::vector<std::string>& comments, std::size_t count,
                       const std::string& properties) {
  std::string header = fmt::format("ply\nformat {} 1.0\n", binary ? "binary_little_endian" : "ascii");
  for (const std::string& comment : comments) header += fmt::format("comment {}\n", comment);
  header += fmt::format("element vertex {}\n", count);
  for (const std::string& property : split(properties, ", ")) header += fmt::format("property {}\n", property);
  return header + "end_header\n";
}

PointCloud read_cloud(const std::filesystem::path& file, std::size_t most) {
  PointCloud cloud;
  if (!std::filesystem::exists(file)) return cloud;
  std::ifstream in(file, std::ios::binary);
  const PlyHeader header = read_header(file, in);
  const auto begin = static_cast<std::uintmax_t>(in.tellg());
  if (std::filesystem::file_size(file) - begin != header.count * header.vertex_bytes)
    refuse(file, "its length does not fit its number of points");
  cloud.all = header.count;
  const std::size_t kept = std::min(most, header.count);
  std::string vertex(header.vertex_bytes, '\0');
  std::size_t next = 0;
  for (std::size_t i = 0; i < header.count && in.read(vertex.data(), static_cast<std::streamsize>(vertex.size()));
       ++i) {
    if (i < next * header.count / std::max<std::size_t>(1, kept)) continue;
    ++next;
    const Eigen::Vector3f p(float_at(vertex.data(), header.floats.at("x")),
                            float_at(vertex.data(), header.floats.at("y")),
                            float_at(vertex.data(), header.floats.at("z")));
    if (!p.allFinite()) continue;
    cloud.points.push_back(p);
    if (const auto grey = header.bytes.find("red"); grey != header.bytes.end())
      cloud.grey.push_back(static_cast<std::uint8_t>(vertex[grey->second]));
    if (const auto size = header.floats.find("size"); size != header.floats.end())
      cloud.size_m = float_at(vertex.data(), size->second);
  }
  return cloud;
}

nlohmann::ordered_json packed_json(const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint8_t>& grey) {
  Eigen::Vector3f low = points.empty() ? Eigen::Vector3f::Zero().eval() : points.front(), high = low;
  for (const Eigen::Vector3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3f step = ((high - low) / kMostSteps).cwiseMax(1e-6F);
  std::vector<unsigned char> xyz;
  xyz.reserve(6 * points.size());
  for (const Eigen::Vector3f& p : points) {
    for (int k = 0; k < 3; ++k) {
      const float steps = std::clamp(std::round((p[k] - low[k]) / step[k]), 0.0F, kMostSteps);
      const auto number = static_cast<std::uint16_t>(steps);
      xyz.push_back(static_cast<unsigned char>(number & 0xFF));
      xyz.push_back(static_cast<unsigned char>(number >> 8));
    }
  }
  return {{"low", {low.x(), low.y(), low.z()}},
          {"step", {step.x(), step.y(), step.z()}},
          {"xyz", base64(xyz)},
          {"grey", base64(grey)}};
}

}  // namespace edged
