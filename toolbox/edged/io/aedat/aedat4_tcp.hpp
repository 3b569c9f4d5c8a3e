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
/// waits for the header of each. next() blocks until a measurement arrives. It ends once all servers have closed the
/// connection or options.interrupted returns true. Throws InputError without a server or for data that are no AEDAT4.
Recording open_aedat4_tcp(const std::string& address, const Rig* rig, const RecordingOptions& options);

}  // namespace edged
