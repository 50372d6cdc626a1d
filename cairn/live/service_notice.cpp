// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/service_notice.hpp>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

namespace cairn::live {

ServiceNotice::ServiceNotice() {
  const char* const named = std::getenv("NOTIFY_SOCKET");
  if (named == nullptr || (named[0] != '/' && named[0] != '@')) return;
  address_ = named;
  if (address_.size() >= sizeof(sockaddr_un::sun_path)) return;
  if (address_[0] == '@') address_[0] = '\0';  // of the abstract namespace
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

ServiceNotice::~ServiceNotice() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotice::send(const std::string& message) const {
  if (socket_ < 0) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(address_.begin(), address_.end(), std::begin(address.sun_path));
  // A manager that does not listen is its own trouble.
  static_cast<void>(::sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&address),
                             static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size())));
}

void ServiceNotice::ready() {
  if (std::exchange(is_ready_, true)) return;
  send("READY=1");
}

void ServiceNotice::note_alive() {
  constexpr Clock::duration kBetween = std::chrono::milliseconds(200);
  const Clock::duration now = Clock::now().time_since_epoch();
  Clock::duration::rep before = alive_;
  if (now.count() - before >= kBetween.count() && alive_.compare_exchange_strong(before, now.count()))
    send("WATCHDOG=1");
}

void ServiceNotice::offer(const LiveFramePtr& frame) {
  ready();
  note_alive();
  if (socket_ < 0 || frame->done - said_ < std::chrono::seconds(1)) return;
  said_ = frame->done;
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%zu objects, %.1f Hz%s", frame->step.frame.objects.list.size(),
                frame->rate_hz, frame->source.is_connected ? "" : ", not connected");
  status(text.data());
}

}  // namespace cairn::live
