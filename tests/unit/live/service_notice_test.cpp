// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <cairn/live/service_notice.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "support/temporary_folder.hpp"

namespace cairn::live {
namespace {

/// A service manager that listens.
class Manager {
 public:
  explicit Manager(const std::string& name) : socket_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(name.begin(), name.end(), std::begin(address.sun_path));
    if (name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~Manager() {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(socket_);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;
  /// The next message; empty if there is none.
  [[nodiscard]] std::string next() const {
    pollfd waits{socket_, POLLIN, 0};
    if (::poll(&waits, 1, 100) != 1) return "";
    std::string text(256, '\0');
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::recv(socket_, text.data(), text.size(), 0))));
    return text;
  }

 private:
  int socket_;
};

void expect_told(const Manager& manager) {
  ServiceNotice notice;
  notice.ready();
  notice.ready();
  notice.note_alive();
  notice.note_alive();  // too soon
  notice.status("3 objects\nWATCHDOG=trigger");
  notice.finish();
  for (const char* const expected :
       {"READY=1", "WATCHDOG=1", "STATUS=3 objects\\nWATCHDOG=trigger", "STOPPING=1", ""})
    EXPECT_EQ(manager.next(), expected);
}

TEST(ServiceNotice, TellsTheManager) {
  const support::TemporaryFolder folder;
  expect_told(Manager((folder.path() / "notify").string()));
}

TEST(ServiceNotice, TellsASocketWithoutAFile) {
  expect_told(Manager("@cairn-test-" + std::to_string(::getpid())));
}

TEST(ServiceNotice, IsSilentWithoutAManager) {
  ::unsetenv("NOTIFY_SOCKET");
  ServiceNotice().ready();
  ::setenv("NOTIFY_SOCKET", "/nowhere/at/all", 1);
  ServiceNotice().ready();
  ::setenv("NOTIFY_SOCKET", std::string(200, '/').c_str(), 1);
  ServiceNotice().ready();
  ::setenv("NOTIFY_SOCKET", "vsock:2:3", 1);
  ServiceNotice().ready();
  ::unsetenv("NOTIFY_SOCKET");
}

}  // namespace
}  // namespace cairn::live
