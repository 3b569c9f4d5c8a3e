// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads items with stamps, one per line, and returns them in time order.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/parse/stamp_jump_filter.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/time.hpp"

namespace edged {

/// How to treat a last line without line end: numbers may have lost digits, but a file name is checked anyway.
enum class LastLine { MustEnd, MayLackEnd };

/// T has a `time_of`. Unreadable and late lines and, but of IMU samples, repeated stamps are left out and counted.
template <typename T>
class StampedLines {
 public:
  struct Spec {
    SourcePath file;
    std::string subject;  ///< "imu", "frames": the prefix of the kinds of repairs
    std::string layout;   ///< the expected form of a line, for messages
    LastLine last_line = LastLine::MustEnd;
    std::function<std::optional<T>(std::string_view)> parse;

    /// The stamp of the last complete line, as edged::last_stamp().
    std::optional<Timestamp> last_stamp() const {
      return edged::last_stamp(file, [this](std::string_view line) {
        const auto item = parse(line);
        return item ? std::optional(time_of(*item)) : std::nullopt;
      });
    }
  };

  StampedLines(Spec spec, Repairs& repairs)
      : spec_(std::move(spec)), lines_(spec_.file), damage_(spec_.file.string(), spec_.subject, repairs) {
    advance();
  }

  /// The next item, or null at the end.
  const T* peek() const { return next_ ? &*next_ : nullptr; }

  T pop() {
    T item = std::move(*next_);
    taken_ = time_of(item);
    advance();
    return item;
  }

 private:
  static constexpr Duration kWrongStamp = std::chrono::milliseconds(100);
  static constexpr bool kMayRepeat = std::is_same_v<T, ImuSample>;  // the gate spreads bursts

  /// One item is held back, so that a single wrong stamp far ahead is dropped instead of everything after it.
  void advance() {
    next_.reset();
    while (auto item = next_passed()) {
      if (!held_) {
        held_ = std::move(item);
      } else if (time_of(*item) > time_of(*held_) || (kMayRepeat && time_of(*item) == time_of(*held_))) {
        next_ = std::exchange(held_, std::move(item));
        went_back_ = false;
        return;
      } else if (time_of(*item) == time_of(*held_)) {
        damage_.mended(line_, "duplicate stamp", "same stamp as the line above; the first is kept");
      } else {
        const bool held_is_wrong =
            time_of(*held_) - time_of(*item) > kWrongStamp && (!taken_ || time_of(*item) > *taken_);
        // Copies of older samples come between newer ones; lines that go back one after another are in another order.
        const char *kind = "out of order, dropped", *detail = "stamp goes back in time";
        std::exchange(went_back_, true) ? damage_.bad(line_, kind, detail) : damage_.mended(line_, kind, detail);
        if (held_is_wrong) held_ = std::move(item);
      }
    }
    next_ = std::exchange(held_, std::nullopt);
  }

  /// The next item that the filter accepts.
  std::optional<T> next_passed() {
    const auto pass = [this](T item) { passed_.push_back(std::move(item)); };
    while (passed_.empty() && !ended_) {
      if (auto item = parse_next()) {
        jump_filter_.push(std::move(*item), pass, [this](const T& wrong, Timestamp next) {
          damage_.bad(
              line_, "stamp far ahead, dropped",
              fmt::format("stamp {} s is followed by {} s", format_seconds(time_of(wrong)), format_seconds(next)));
        });
      } else {
        jump_filter_.finish(pass);
        ended_ = true;
      }
    }
    if (passed_.empty()) return std::nullopt;
    T item = std::move(passed_.front());
    passed_.pop_front();
    return item;
  }

  std::optional<T> parse_next() {
    while (const auto line = lines_.next()) {
      line_ = line->number;
      auto item = spec_.parse(line->text);
      if (!item && !parsed_ && is_heading(line->text)) continue;
      parsed_ = parsed_ || item;
      if (item && (line->terminated || spec_.last_line == LastLine::MayLackEnd)) return item;
      if (!line->terminated) {
        damage_.mended(line_, "last line cut", "the file ends within a line, which is left out");
      } else {
        damage_.bad(line_, "unreadable line", "not `" + spec_.layout + "` in finite numbers");
      }
    }
    if (!lines_.damage().empty() && !std::exchange(damage_counted_, true))
      damage_.mended(line_, "file cut by damage", lines_.damage());
    return std::nullopt;
  }

  Spec spec_;
  LineReader lines_;
  LineDamage damage_;
  std::size_t line_ = 0;
  bool damage_counted_ = false;
  bool parsed_ = false;  ///< at least one line was parsed
  bool ended_ = false;
  bool went_back_ = false;  ///< the stamp of the line before
  StampJumpFilter<T> jump_filter_;
  std::deque<T> passed_;
  std::optional<T> next_, held_;
  std::optional<Timestamp> taken_;
};

}  // namespace edged
