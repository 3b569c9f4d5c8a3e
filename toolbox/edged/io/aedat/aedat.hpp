// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads AEDAT 2.0, 3.1 and 4 of iniVation's cameras, 4 also live from a server, and writes 4.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// True for the first bytes of a file of AEDAT 4.
bool is_aedat4(ByteSpan head);

/// A recording with stamps in Unix time. Options used: the geometry of the event sensor, for files
/// without one, and the topics: the names of streams, where several have the same type.
Recording open_aedat4(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

inline constexpr std::string_view kTcpPrefix = "tcp://";

/// address: "tcp://HOST:PORT", or "tcp://HOST:PORT,PORT,..." as such a server has a port for each stream. Connects and
/// waits for the header of each. next() blocks until a measurement arrives. It ends once all servers have closed the
/// connection or options.interrupted returns true. Throws InputError without a server or for data that are no AEDAT4.
Recording open_aedat4_tcp(const std::string& address, const Rig* rig, const RecordingOptions& options);

/// True for the first bytes of a file of all versions before 4.
bool is_old_aedat(ByteSpan head);

/// A recording with cameras "events" and "frames"; stamps are those of the camera. Options used: the geometry of the
/// event sensor. Throws InputError for other versions and cameras.
Recording open_old_aedat(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

/// A file with LZ4 and a table. Stamps are whole microseconds and not negative.
std::unique_ptr<RecordingWriter> write_aedat4(const WriterSetup& setup);

}  // namespace edged
