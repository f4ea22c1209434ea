// SPDX-License-Identifier: Apache-2.0
// The few typed exceptions of the off-line stages. A message is one line that names the file, the
// first bad element and what to do about it. The haptic tick throws nothing.
#pragma once
#include <stdexcept>
#include <string>

namespace palpate {

/// The input cannot be used; nothing was computed or written. Exit code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A numerical stage did not reach its tolerance. Exit code 3.
struct SolveError : std::runtime_error {
  SolveError(const std::string& message, double residual_reached = 0, int iterations_done = 0)
      : std::runtime_error(message), residual(residual_reached), iterations(iterations_done) {}
  double residual;  ///< in the unit that the message states
  int iterations;
};

/// A file could not be written or read back (full disk, permissions). Exit code 4.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user stopped the run (Ctrl-C). Exit code 130.
struct Cancelled : std::runtime_error {
  Cancelled()
      : std::runtime_error("stopped by the user; nothing was written under the final name") {}
};

}  // namespace palpate
