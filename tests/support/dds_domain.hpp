// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

namespace cairn {

/// Isolates this process and its children: a DDS domain of their own, on this computer.
inline void enter_own_domain() {
  ::unsetenv("CYCLONEDDS_URI");
  ::unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  ::setenv("ROS_DOMAIN_ID", std::to_string(1 + ::getpid() % 100).c_str(), 1);
}

/// A topic name unique to this process, in case the domain is shared.
inline std::string own_topic(const std::string& name) {
  return "/t" + std::to_string(::getpid()) + "/" + name;
}

/// Polls until the condition holds, up to a limit.
template <class Condition>
bool comes_true(const Condition& condition, std::chrono::milliseconds within = std::chrono::seconds(15)) {
  const auto deadline = std::chrono::steady_clock::now() + within;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace cairn
