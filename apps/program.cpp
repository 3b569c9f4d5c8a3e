// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <cstdio>
#include <exception>
#include <opencv2/core/utility.hpp>

#include "edged/core/check.hpp"
#include "exit_code.hpp"
#include "log.hpp"

namespace edged {

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  try {
    cv::setNumThreads(1);  // one packet is too little work to share, and one thread keeps results reproducible
    start_logging();
    app.parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  } catch (const InputError& e) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), e.what());
    return kExitInput;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: a bug, please report it with this line: %s\n", app.get_name().c_str(), e.what());
    return kExitBug;
  }
}

}  // namespace edged
