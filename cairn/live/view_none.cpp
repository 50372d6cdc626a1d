// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <cairn/live/view/view_server.hpp>

namespace cairn::live {

class ViewServer::Hub {};

ViewServer::ViewServer(ViewOptions, ViewedRun) {
  throw Error(
      "--view: live views are not built in: they need Boost (libboost-dev), OpenSSL (libssl-dev) and "
      "CAIRN_VIEW=ON");
}
ViewServer::~ViewServer() = default;
void ViewServer::offer(const LiveFramePtr&) {}
void ViewServer::finish() {}
std::string ViewServer::summary() const {
  return {};
}
std::uint16_t ViewServer::port() const {
  return 0;
}
std::string ViewServer::url() const {
  return {};
}
std::uint64_t ViewServer::encoded() const {
  return 0;
}

}  // namespace cairn::live
