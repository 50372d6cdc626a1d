// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <cairn/live/live_frame.hpp>
#include <cairn/live/view/view_options.hpp>

namespace cairn::live {

/// Shows a run in browsers, Foxglove and compatible viewers over one port. Encodes only while there is a
/// viewer; a slow viewer gets fewer frames and does not delay others. (docs/live_view.md)
class ViewServer : public Sink {
 public:
  /// Listens from construction on. Throws Error if the options are invalid (Access), a TLS file is unusable,
  /// the address cannot be listened on, or views are not built in.
  ViewServer(ViewOptions options, ViewedRun run);
  ~ViewServer() override;

  void offer(const LiveFramePtr& frame) override;
  /// Notifies the viewers of the end, and closes.
  void finish() override;
  /// To be called after finish().
  [[nodiscard]] std::string summary() const override;

  [[nodiscard]] std::uint16_t port() const;
  /// The address with the token, which grants access.
  [[nodiscard]] std::string url() const;
  /// Messages encoded, over all channels.
  [[nodiscard]] std::uint64_t encoded() const;

 private:
  class Hub;
  std::unique_ptr<Hub> hub_;
};

}  // namespace cairn::live
