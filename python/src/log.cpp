// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include "bindings.hpp"

namespace edged::python {
namespace {

/// What the library logs goes to the logger "edged" of Python. No lock of its own: the GIL is one, and two make a
/// deadlock.
class PythonLog : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  /// Never destroyed: at the interpreter's end it is too late for a destructor.
  PythonLog() : logger_(py::module_::import("logging").attr("getLogger")("edged").release()) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (Py_IsInitialized() == 0) return;
    const py::gil_scoped_acquire gil;
    const py::error_scope pending;
    try {
      // spdlog counts trace 0, debug 1, info 2 ...; Python debug 10, info 20 ...
      logger_.attr("log")(10 * std::max(1, static_cast<int>(message.level)), "%s",
                          in_python(std::string(message.payload.data(), message.payload.size())));
    } catch (const py::error_already_set&) {  // the handlers are the user's: a log is no place to fail
    }
  }
  void flush_() override {}

 private:
  py::handle logger_;
};

}  // namespace

void bind_log() {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("edged", std::make_shared<PythonLog>()));
}

}  // namespace edged::python
