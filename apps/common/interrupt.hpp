// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, SIGTERM and SIGHUP (closed terminal) set a flag, which the main loop polls.
#pragma once

#include "edged/dataset.hpp"

namespace edged {

/// Installs handlers: the first SIGINT, SIGTERM or SIGHUP only sets the flag. A second signal of the same kind ends the
/// program immediately.
void catch_interrupts();

/// The received signal, or 0.
int interrupt_signal();

/// The exit status of a command that ends after reading: kExitOk, or that of the received signal.
int exit_code_of_interrupt();

/// A data set that ends after an interrupt by the user.
class InterruptibleDataset final : public Dataset {
 public:
  explicit InterruptibleDataset(Dataset& inner) : inner_(inner) {}
  const DatasetInfo& info() const override { return inner_.info(); }
  std::optional<Measurement> next() override { return interrupt_signal() == 0 ? inner_.next() : std::nullopt; }
  void leave_out(Modality unwanted) override { inner_.leave_out(unwanted); }
  std::optional<GroundTruth> ground_truth() const override { return inner_.ground_truth(); }
  std::map<std::string, std::size_t> repairs() const override { return inner_.repairs(); }

 private:
  Dataset& inner_;
};

}  // namespace edged
