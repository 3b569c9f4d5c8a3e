// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/text_parsing.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr std::string_view kBlank = " \t\r";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// The digits of a decimal number without leading zeros. Its value is 0.DIGITS * 10^point.
struct Decimal {
  std::string digits;
  long point = 0;
  bool negative = false;
};

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal d;
  d.negative = text.starts_with('-');
  if (d.negative || text.starts_with('+')) text.remove_prefix(1);
  if (const std::size_t mark = text.find_first_of("eE"); mark != std::string_view::npos) {
    std::string_view exponent = text.substr(mark + 1);
    if (exponent.starts_with('+')) exponent.remove_prefix(1);
    const auto value = parse_whole<int>(exponent);
    if (!value) return std::nullopt;
    d.point = *value;
    text = text.substr(0, mark);
  }
  const std::string_view whole = text.substr(0, text.find('.'));
  d.digits = whole;
  if (whole.size() < text.size()) d.digits += text.substr(whole.size() + 1);
  if (d.digits.empty() || !std::ranges::all_of(d.digits, is_digit)) return std::nullopt;
  const std::size_t zeros = std::min(d.digits.find_first_not_of('0'), d.digits.size());
  d.digits.erase(0, zeros);
  d.point += static_cast<long>(whole.size()) - static_cast<long>(zeros);
  return d;
}

/// "1,5;2,25": each comma stands between digits, and a semicolon between two of them.
bool has_decimal_commas(std::string_view line) {
  bool comma = false, any = false, separated = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == ';') comma = false, separated = true;
    if (line[i] != ',') continue;
    if (comma || i == 0 || i + 1 == line.size() || !is_digit(line[i - 1]) || !is_digit(line[i + 1])) return false;
    comma = any = true;
  }
  return any && separated;
}

struct UnitName {
  TimeUnit unit;
  const char* name;
};
constexpr UnitName kUnitNames[] = {{TimeUnit::Seconds, "s"},
                                   {TimeUnit::Milliseconds, "ms"},
                                   {TimeUnit::Microseconds, "us"},
                                   {TimeUnit::Nanoseconds, "ns"}};

}  // namespace

BlockReader::BlockReader(const SourcePath& file, std::size_t block_bytes)
    : name_(file.string()), source_(file.open()), buffer_(block_bytes + 1) {}

/// Fills the buffer, or reads to the end of the file. One byte is reserved for a line end.
void BlockReader::fill() try {
  while (!at_end_ && filled_ < buffer_.size() - 1) {
    const std::size_t got = source_->read({buffer_.data() + filled_, buffer_.size() - 1 - filled_});
    filled_ += got;
    at_end_ = got == 0;
  }
} catch (const Damage& damage) {
  damage_ = damage.what();
  at_end_ = true;
}

/// Leaves the byte order mark out, and looks for decimal commas in the first lines.
void BlockReader::begin_text() {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  constexpr int kFirstLines = 100;
  std::string_view text(buffer_.data(), filled_);
  if (text.starts_with(kMark)) {
    text.remove_prefix(kMark.size());
    std::memmove(buffer_.data(), text.data(), text.size());
    filled_ = text.size();
  }
  text = std::string_view(buffer_.data(), filled_);
  for (int i = 0; i < kFirstLines && !text.empty() && !decimal_commas_; ++i) {
    const std::string_view line = trim(text.substr(0, text.find('\n')));
    decimal_commas_ = has_decimal_commas(line);
    text.remove_prefix(std::min(text.size(), text.find('\n') + 1));
  }
}

std::string_view BlockReader::next() {
  filled_ -= given_;
  std::memmove(buffer_.data(), buffer_.data() + given_, filled_);
  given_ = 0;
  const std::size_t kept = filled_;
  fill();
  if (!std::exchange(begun_, true)) begin_text();
  if (decimal_commas_)
    std::replace(buffer_.begin() + static_cast<std::ptrdiff_t>(kept),
                 buffer_.begin() + static_cast<std::ptrdiff_t>(filled_), ',', '.');

  const std::string_view all(buffer_.data(), filled_);
  const std::size_t last_end = all.rfind('\n');
  if (last_end != std::string_view::npos) {
    given_ = last_end + 1;
  } else if (!at_end_) {
    throw InputError::format("{}: no line end within {} bytes: this is not a text file", name_, buffer_.size() - 1);
  } else if (filled_ > 0) {
    buffer_[filled_++] = '\n';
    given_ = filled_;
    unterminated_ = true;
  }
  return {buffer_.data(), given_};
}

std::optional<TextLine> LineReader::next() {
  while (true) {
    if (block_.empty()) block_ = blocks_.next();
    if (block_.empty()) return std::nullopt;
    const std::size_t end = block_.find('\n');
    const std::string_view text = trim(block_.substr(0, end));
    block_.remove_prefix(end + 1);
    ++number_;
    if (!text.empty() && text[0] != '#') return TextLine{text, number_, !(block_.empty() && blocks_.unterminated())};
  }
}

bool is_heading(std::string_view line) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !line.empty() && (letter(line[0]) || line[0] == '"' || line[0] == '%');
}

std::vector<std::string> heading_fields(std::string_view line) {
  const bool listed = line.find_first_of(",;") != std::string_view::npos;
  std::vector<std::string> fields;
  while (!line.empty()) {
    const std::size_t end = std::min(line.size(), line.find_first_of(listed ? ",;" : " \t\r"));
    const std::string_view field = line.substr(0, end);
    line.remove_prefix(std::min(line.size(), end + 1));
    if (!listed && field.empty()) continue;
    const bool unit = !listed && !fields.empty() &&
                      (field[0] == '[' || field[0] == '(' ||
                       fields.back().find_last_of("[(") + 1 > fields.back().find_last_of("])") + 1);
    if (unit)
      fields.back() += field;
    else
      fields.emplace_back(field);
  }
  return fields;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string_view FieldReader::next() {
  rest_ = rest();
  const std::size_t end = rest_.find_first_of(" \t\r,;");
  const std::string_view field = rest_.substr(0, end);
  rest_.remove_prefix(field.size());
  rest_ = rest();
  if (!rest_.empty() && (rest_[0] == ',' || rest_[0] == ';')) rest_.remove_prefix(1);
  return field;
}

std::string_view FieldReader::rest() const { return trim(rest_); }

std::optional<double> parse_number(std::string_view field) {
  if (!field.empty() && field[0] == '+') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<TimeUnit> parse_time_unit(std::string_view text) {
  const auto* known = std::ranges::find(kUnitNames, text, &UnitName::name);
  return known == std::end(kUnitNames) ? std::nullopt : std::optional(known->unit);
}

const char* unit_name(TimeUnit unit) { return std::ranges::find(kUnitNames, unit, &UnitName::unit)->name; }

std::optional<Timestamp> parse_stamp(std::string_view field, TimeUnit unit) {
  const std::optional<Decimal> d = parse_decimal(field);
  if (!d) return std::nullopt;
  const long whole = d->point + static_cast<long>(unit);  // digits of the integer part in nanoseconds
  if (d->digits.empty() || whole < 0) return Timestamp(Duration(0));
  if (whole > 19) return std::nullopt;
  std::uint64_t ns = 0;
  for (long i = 0; i < whole; ++i) {
    const auto k = static_cast<std::size_t>(i);
    ns = ns * 10 + (k < d->digits.size() ? static_cast<std::uint64_t>(d->digits[k] - '0') : 0);
  }
  const auto next = static_cast<std::size_t>(whole);
  if (next < d->digits.size() && d->digits[next] >= '5') ++ns;
  if (ns > static_cast<std::uint64_t>(kMaxStampNs)) return std::nullopt;
  const auto value = static_cast<std::int64_t>(ns);
  return Timestamp(Duration(d->negative ? -value : value));
}

std::optional<Timestamp> parse_nanoseconds(std::string_view field) {
  const auto ns = parse_whole<std::int64_t>(field);
  return ns && *ns <= kMaxStampNs && *ns >= -kMaxStampNs ? std::optional(timestamp_from_ns(*ns)) : std::nullopt;
}

std::string format_seconds(Timestamp t) {
  const std::int64_t ns = to_ns(t);
  const std::uint64_t size =
      ns < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", size / 1'000'000'000, size % 1'000'000'000);
}

std::optional<Timestamp> last_stamp(const SourcePath& file,
                                    const std::function<std::optional<Timestamp>(std::string_view)>& parse) {
  constexpr std::streamoff kTail = 8192;
  if (!file.is_file() || file.is_packed()) return std::nullopt;
  std::ifstream in(file.string(), std::ios::binary | std::ios::ate);
  if (!in) return std::nullopt;
  const std::streamoff size = in.tellg();
  const std::streamoff from = std::max<std::streamoff>(0, size - kTail);
  std::string tail(static_cast<std::size_t>(size - from), '\0');
  in.seekg(from);
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));

  if (const std::size_t begin = tail.find('\n') + 1;
      has_decimal_commas(tail.substr(begin, tail.find('\n', begin) - begin)))
    std::ranges::replace(tail, ',', '.');
  std::string_view rest = tail;
  rest = rest.substr(0, rest.rfind('\n') + 1);  // a cut last line may have a wrong stamp
  while (!rest.empty()) {
    rest.remove_suffix(1);
    const std::size_t start = rest.rfind('\n') + 1;
    if (start == 0 && from > 0) return std::nullopt;  // the line begins before the tail
    if (const auto t = parse(rest.substr(start))) return t;
    rest = rest.substr(0, start);
  }
  return std::nullopt;
}

}  // namespace edged
