// SPDX-License-Identifier: GPL-3.0-or-later
// Progress for a person at a terminal: one line a stage with the time left; Ctrl-C stops cleanly.
#pragma once
#include <memory>

#include "core/progress.hpp"

namespace palpate::app {

/// Writes to standard error; redraws a line where that is a terminal, else one line per stage.
/// @param quiet  writes nothing, but Ctrl-C still stops the run
[[nodiscard]] std::unique_ptr<Progress> make_terminal_progress(bool quiet);

/// For a program that reads along: "@ FRACTION STAGE" on standard output.
[[nodiscard]] std::unique_ptr<Progress> make_line_progress();

}  // namespace palpate::app
