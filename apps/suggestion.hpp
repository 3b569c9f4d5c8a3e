// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a message adds where a word was mistyped.
#pragma once

#include <algorithm>
#include <string>

namespace edged {

/// Most edits of a letter by which a word is still taken for a mistyped one.
inline std::size_t typing_errors(const std::string& word) { return std::max<std::size_t>(2, word.size() / 4); }

/// "" where nothing is near.
inline std::string did_you_mean(const std::string& nearest) {
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

}  // namespace edged
