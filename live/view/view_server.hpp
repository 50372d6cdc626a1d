// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "../live_frame.hpp"
#include "view_options.hpp"

namespace cairn::live {

/// Shows a run in a browser, and to Foxglove and its like, over one port. Nothing is encoded while nobody
/// looks, and a viewer that is slow gets fewer frames and delays nobody. (docs/live_view.md)
class ViewServer : public Sink {
 public:
  /// Listens from now on. Throws Error where the options are not sound (Access), a file of TLS cannot be
  /// used, the address cannot be listened on, or views are not built in.
  ViewServer(ViewOptions options, ViewedRun run);
  ~ViewServer() override;

  void offer(const LiveFramePtr& frame) override;
  /// Tells the viewers that the run is over, and closes.
  void finish() override;
  /// After finish().
  [[nodiscard]] std::string summary() const override;

  [[nodiscard]] std::uint16_t port() const;
  /// With the token: who has it may look.
  [[nodiscard]] std::string url() const;
  /// Messages encoded, by all channels together.
  [[nodiscard]] std::uint64_t encoded() const;

 private:
  class Hub;
  std::unique_ptr<Hub> hub_;
};

}  // namespace cairn::live
