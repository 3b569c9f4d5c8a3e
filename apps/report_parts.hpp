// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files of apps/report/, as cmake/EdgedEmbed.cmake puts them into the program.
#pragma once

namespace edged {

extern const char* const kReportHtml;
extern const char* const kReportCss;
extern const char* const kReportJs;
extern const char* const kSectionsJs;
extern const char* const kPlotJs;
extern const char* const kToolsJs;
extern const char* const kView3dJs;
extern const char* const kLiveJs;
extern const char* const kPlayerJs;

}  // namespace edged
