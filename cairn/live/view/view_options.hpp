// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cairn/input/sequence.hpp>
#include <cairn/sequence/follow_config.hpp>

namespace cairn::live {

/// The viewed run and the permitted actions. The functions are called from the threads of the server; a
/// missing one means that the action is not available.
struct ViewedRun {
  std::string name;                // of the source
  std::string preset = "default";  // base of the changed options
  Size image;
  std::optional<StereoRig> rig;
  /// The present status of the source: a camera without frames cannot report it in a frame.
  std::function<input::SourceStatus()> source;
  std::function<std::shared_ptr<const FollowConfig>()> config;  // of the next frame
  /// Like Runner::set().
  std::function<void(const std::vector<std::pair<std::string, std::string>>&)> set;
  // For files only.
  std::function<void(bool)> pause;
  std::function<bool()> is_paused;
  std::function<void()> step;
  // Both or none.
  std::function<void(bool)> record;
  std::function<bool()> is_recording;
};

struct ViewOptions {
  std::string address = "127.0.0.1";  // an IP address; others than loopback need TLS or `insecure`
  std::uint16_t port = 8765;          // 0: a free one
  std::string token;                  // 16 … 128 letters, digits, - and _; empty: 128 random bits
  std::string tls_cert;               // PEM files: both or none
  std::string tls_key;
  bool insecure = false;             // network without TLS: eavesdroppers see everything, including the token
  std::vector<std::string> origins;  // of other pages that may connect: "https://app.foxglove.dev"
  bool tunable = false;              // viewers may change options, pause and record
  int max_clients = 8;
};

/// "127.0.0.1:8765", "[::1]:8765", "0.0.0.0" or ":8765": omitted parts are unchanged. Throws Error.
void read_view_address(const std::string& text, ViewOptions& options);

}  // namespace cairn::live
