// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What headers say of CLI11: its own takes the compiler six seconds in every source that includes it.
#pragma once

namespace CLI {
class App;
}
