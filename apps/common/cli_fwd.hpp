// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Forward declarations of CLI11, whose header takes six seconds to compile per source.
#pragma once

namespace CLI {
class App;
}
