// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The header lines of AEDAT 2.0 and 3.1 files.
#include "edged/io/aedat/aedat_old.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/core/geometry.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::string_view kOldAedatMagic = "#!AER-DAT";
constexpr std::string_view kHeaderEnd = "#!END-HEADER";
constexpr std::size_t kMostOldHeaderBytes = std::size_t{8} << 20U;  // jAER writes all its preferences into the header

struct ChipSize {
  std::string_view name;  ///< first letters of the name, in lower case
  int width, height;
};
constexpr std::array kChips = {ChipSize{"davis128", 128, 128}, ChipSize{"davis208", 208, 192},
                               ChipSize{"davis240", 240, 180}, ChipSize{"davis346", 346, 260},
                               ChipSize{"davis640", 640, 480}, ChipSize{"dvs128", 128, 128}};

/// The text line that starts at `at`. Nothing if the data begin there.
std::optional<std::string_view> text_line(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('\n', at);
  if (at >= text.size() || text[at] != '#' || end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(at, end - at);
  const bool printable = std::ranges::all_of(line, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 || c == '\t' || c == '\r';
  });
  return printable ? std::optional(line) : std::nullopt;
}

/// The number at the end of `key="ImuGyroScale" value="GyroFullScaleDegPerSec1000"`.
std::optional<double> full_scale(std::string_view line, std::string_view key) {
  if (line.find(key) == std::string_view::npos) return std::nullopt;
  const std::size_t end = line.rfind('"');
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t before = line.substr(0, end).find_last_not_of("0123456789");
  return parse_number(line.substr(before + 1, end - before - 1));
}

void take_chip(std::string_view name, OldAedatHeader& header) {
  header.chip = FieldReader(name.substr(name.rfind('.') + 1)).next();  // without the package of the class
  const std::string lower = lower_case(header.chip);
  for (const ChipSize& chip : kChips)
    if (lower.starts_with(chip.name)) header.sensor = cv::Size(chip.width, chip.height);
}

}  // namespace

bool is_old_aedat(ByteSpan head) {
  const std::string_view text = as_text(head);
  return text.starts_with(kOldAedatMagic) && !text.starts_with("#!AER-DAT4");
}

OldAedatHeader parse_old_aedat_header(ByteSpan head) {
  const std::string_view text = as_text(head);
  OldAedatHeader header;
  while (const auto line = text_line(text, header.bytes)) {
    header.bytes += line->size() + 1;
    if (header.version.empty()) header.version = FieldReader(line->substr(kOldAedatMagic.size())).next();
    if (line->starts_with(kHeaderEnd)) break;
    constexpr std::string_view kChip = "AEChip:", kSource = "#Source ";
    if (const std::size_t at = line->find(kChip); at != std::string_view::npos && header.chip.empty())
      take_chip(line->substr(at + kChip.size()), header);
    if (const std::size_t at = line->find(':'); line->starts_with(kSource) && at != std::string_view::npos)
      if (header.chip.empty()) take_chip(line->substr(at + 1), header);
    // Sensitivities of InvenSense's data sheets: 131 LSB per deg/s at 250 deg/s, 16384 LSB per g at 2 g.
    if (const auto dps = full_scale(*line, "\"ImuGyroScale\""); dps && *dps > 0)
      header.gyro_lsb_per_dps = 131.0 * 250.0 / *dps;
    if (const auto g = full_scale(*line, "\"ImuAccelScale\""); g && *g > 0) header.accel_lsb_per_g = 32768.0 / *g;
  }
  if (header.bytes == 0) throw Damage("ends in its first line");
  return header;
}

Recording open_old_aedat(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) try {
  const OldAedatHeader header = parse_old_aedat_header(BinaryFile(file).read(0, kMostOldHeaderBytes));
  const bool two = header.version == "2.0", three = header.version == "3.1";
  if (!two && !three)
    throw InputError::format("{}: AEDAT {} is not read; 2.0, 3.1 and 4 are: convert it with DV", file.string(),
                             header.version);
  if (two && !lower_case(header.chip).starts_with("davis"))
    throw InputError::format("{}: AEDAT 2.0 of the camera `{}` is not read, only of a DAVIS: convert it with DV",
                             file.string(), header.chip.empty() ? "(not named)" : header.chip);
  const cv::Size sensor = event_sensor_size(file, options.geometry ? options.geometry : header.sensor, rig);
  return two ? open_aedat2(file, header, sensor) : open_aedat3(file, header, sensor);
} catch (const Damage& damage) {
  throw InputError::format("{}: the header is damaged: {}", file.string(), damage.what());
}

}  // namespace edged
