// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4 live from servers of iniVation's DV or of the dv-processing library.
#pragma once

#include <string>
#include <string_view>

#include "edged/io/recording.hpp"

namespace edged {

inline constexpr std::string_view kTcpPrefix = "tcp://";

/// address: "tcp://HOST:PORT", or "tcp://HOST:PORT,PORT,..." as such a server has a port for each stream. Connects and
/// waits for what each has to say. next() blocks until there is something; it ends when all servers have closed or
/// options.interrupted says so. Throws InputError where nobody listens or what comes is no AEDAT4.
Recording open_aedat4_tcp(const std::string& address, const Rig* rig, const RecordingOptions& options);

}  // namespace edged
