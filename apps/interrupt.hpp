// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and SIGTERM as a flag that the main loop asks for.
#pragma once

namespace edged {

/// From now on the first SIGINT or SIGTERM only sets a flag; a second one ends the program at once.
void catch_interrupts();

/// The signal that came, or 0.
int interrupt_signal();

}  // namespace edged
