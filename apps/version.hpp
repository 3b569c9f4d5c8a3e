// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which program this is.
#pragma once

namespace edged {

/// Version of the project and state of the source tree at build time, e.g. "0.1.0 (1a2b3c4, changed)".
extern const char* const kVersion;

}  // namespace edged
