// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/live_frame.hpp>
#include <cairn/live/recorder.hpp>
#include <cairn/live/runner.hpp>
#include <cairn/live/view/view_options.hpp>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace cairn::cli {

/// --view and its options.
struct ViewInput {
  bool is_wanted = false;
  std::string address;  // "127.0.0.1:8765"
  live::ViewOptions options;
};
void add_view_options(CLI::App& app, ViewInput& input);
/// Throws Error if an option of the view is given without --view.
void check(const ViewInput& input);

/// Null without --view. Prints the address on stderr. Throws Error like live::ViewServer. The runner, the
/// recorder and the source must outlive it.
std::unique_ptr<live::Sink> make_view(const ViewInput& input, live::Runner& runner, live::Recorder& recorder,
                                      const input::Sequence& source, const std::string& preset);

}  // namespace cairn::cli
