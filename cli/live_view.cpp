// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "live_view.hpp"

#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/live/view/view_server.hpp>
#include <cairn/ros/mcap.hpp>
#include <iostream>

namespace cairn::cli {
namespace {

live::ViewedRun viewed(live::Runner& runner, live::Recorder& recorder, const input::Sequence& source,
                       const std::string& preset) {
  live::ViewedRun run;
  run.name = source.name();
  run.preset = preset;
  run.image = source.image_size();
  run.rig = source.rig();
  run.source = [&source] { return source.status(); };
  run.config = [&runner] { return runner.config(); };
  run.set = [&runner](const auto& options) { runner.set(options); };
  if (!source.status().is_live) {
    run.pause = [&runner](bool on) { runner.pause(on); };
    run.is_paused = [&runner] { return runner.is_paused(); };
    run.step = [&runner] { runner.step(); };
  }
  if (ros::has_mcap()) {
    run.record = [&recorder](bool on) {
      if (on) {
        recorder.start(live::recording_name());
      } else {
        recorder.stop();
      }
    };
    run.is_recording = [&recorder] { return recorder.status().is_recording; };
  }
  return run;
}

}  // namespace

void add_view_options(CLI::App& app, ViewInput& input) {
  app.add_option_function<std::string>(
         "--view",
         [&input](const std::string& address) {
           input.is_wanted = true;
           input.address = address;
         },
         "address of the view for browsers and Foxglove (default: 127.0.0.1:8765)")
      ->type_name("[ADDRESS:PORT]")
      ->expected(0, 1)
      ->run_callback_for_default();
  app.add_flag("--tunable", input.options.tunable,
               "permission for viewers to change options, pause and record");
  app.add_option("--view-token", input.options.token,
                 "access token: 16 to 128 letters, digits, - and _ (default: random)")
      ->type_name("TOKEN");
  app.add_option("--view-origin", input.options.origins,
                 "other web origin that may connect, e.g. https://app.foxglove.dev")
      ->type_name("URL");
  app.add_option("--tls-cert", input.options.tls_cert, "TLS certificate of the view, with its chain")
      ->type_name("FILE.pem");
  app.add_option("--tls-key", input.options.tls_key, "private key of the TLS certificate")
      ->type_name("FILE.pem");
  app.add_flag("--insecure", input.options.insecure,
               "unencrypted view on an address reachable from the network");
}

void check(const ViewInput& input) {
  if (input.is_wanted) return;
  const auto& options = input.options;
  for (const auto& [is_given, name] :
       {std::pair{options.tunable, "--tunable"}, std::pair{!options.token.empty(), "--view-token"},
        std::pair{!options.origins.empty(), "--view-origin"},
        std::pair{!options.tls_cert.empty(), "--tls-cert"}, std::pair{!options.tls_key.empty(), "--tls-key"},
        std::pair{options.insecure, "--insecure"}}) {
    if (is_given) throw Error(std::string(name) + ": needs --view");
  }
}

std::unique_ptr<live::Sink> make_view(const ViewInput& input, live::Runner& runner, live::Recorder& recorder,
                                      const input::Sequence& source, const std::string& preset) {
  if (!input.is_wanted) return nullptr;
  live::ViewOptions options = input.options;
  if (!input.address.empty()) live::read_view_address(input.address, options);
  auto server =
      std::make_unique<live::ViewServer>(std::move(options), viewed(runner, recorder, source, preset));
  std::cerr << "view: " << server->url() << "\n";
  return server;
}

}  // namespace cairn::cli
