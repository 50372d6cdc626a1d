// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

namespace cairn::cli {

/// The exit code of a run that was ended by a signal, as shells have it.
inline constexpr int kInterrupted = 130;

/// From now on Ctrl-C and SIGTERM only leave a mark, so that what is at hand is done and written whole; a
/// second one ends the program at once. A closed stdout shows in the stream, not as a signal.
void catch_interrupts();
[[nodiscard]] bool is_interrupted();
/// What the signal does besides, in its handler; none: nothing.
void on_interrupt_also(void (*also)());

}  // namespace cairn::cli
