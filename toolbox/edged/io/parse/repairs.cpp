// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/repairs.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {
constexpr std::size_t kMaxBadLines = 1000;
constexpr std::size_t kMaxBadShare = 100;  // one in a hundred
}  // namespace

void Repairs::add(const std::string& kind, const std::string& detail, std::size_t count) {
  if (count > 0 && std::exchange(counts_[kind], counts_[kind] + count) == 0)
    spdlog::warn(fmt::format("{} (further cases of \"{}\" are only counted)", detail, kind));
}

void LineDamage::bad(std::size_t line, const std::string& kind, const std::string& detail) {
  mended(line, kind, detail);
  if (++bad_ == 1) first_ = fmt::format("{}:{}: {}", file_, line, detail);
  if (bad_ > kMaxBadLines && bad_ > line / kMaxBadShare)
    throw InputError::format("{}; {} of the first {} lines are damaged: repair or replace the file", first_, bad_,
                             line);
}

void LineDamage::mended(std::size_t line, const std::string& kind, const std::string& detail) {
  repairs_.add(subject_ + ": " + kind, fmt::format("{}:{}: {}", file_, line, detail));
}

}  // namespace edged
