// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <cairn/core/error.hpp>
#include <chrono>
#include <string>

#include <cairn/live/live_frame.hpp>

namespace cairn::live {

/// Tells the service manager that has started the process how it is: the protocol of sd_notify(3), datagrams to the
/// socket that $NOTIFY_SOCKET names. No effect without it.
class ServiceNotice : public Sink {
 public:
  ServiceNotice();
  ~ServiceNotice() override;
  /// READY=1 the first time.
  void ready();
  /// WATCHDOG=1, at most five times a second.
  void note_alive() override;
  /// STATUS=…; one line.
  void status(const std::string& text) const { send("STATUS=" + on_one_line(text)); }

  /// As a sink: ready with the first frame, a status every second.
  void offer(const LiveFramePtr& frame) override;
  void finish() override { send("STOPPING=1"); }

 private:
  void send(const std::string& message) const;

  int socket_ = -1;
  std::string address_;  // of the socket, as sockaddr_un wants it
  bool is_ready_ = false;
  Clock::time_point said_;
  std::atomic<Clock::duration::rep> alive_ = 0;
};

}  // namespace cairn::live
