// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

namespace cairn::cli {

/// The exit code of a run ended by a signal, as in shells.
inline constexpr int kInterrupted = 130;

/// Makes Ctrl-C and SIGTERM set a flag, so that the current work is completed; a second one ends the program
/// at once. A closed stdout is reported by the stream, not by a signal.
void catch_interrupts();
[[nodiscard]] bool is_interrupted();
/// An additional action of the signal handler; null: none.
void on_interrupt_also(void (*also)());

}  // namespace cairn::cli
