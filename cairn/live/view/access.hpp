// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <cairn/live/view/view_options.hpp>

/// Access control of a live view. Internal to it. (docs/live_view.md, "Security")
namespace cairn::live {

/// 128 random bits of the system, as 32 hexadecimal digits.
std::string random_token();

/// Comparison in a time that does not depend on where the two differ.
bool is_equal_in_constant_time(std::string_view a, std::string_view b);

/// Whether an IP address, in text, is a loopback address. Throws Error if it is not an address.
bool is_loopback(const std::string& address);

/// The parts of a request that decide about access: its line and three of its headers, empty if absent.
struct ViewRequest {
  std::string_view method;
  std::string_view target;
  std::string_view host;
  std::string_view origin;
  std::string_view cookie;
  bool is_upgrade = false;
};

struct ViewVerdict {
  int status = 200;         // 303: correct token, to be moved into a cookie
  std::string text;         // the reason of a refusal, in one line
  std::string path;         // without the query
  std::string cookie = {};  // to be set, for 303
};

class Access {
 public:
  /// Throws Error if the options are invalid, or unsafe without `insecure`. An empty token is replaced by a
  /// random one.
  explicit Access(const ViewOptions& options);

  [[nodiscard]] ViewVerdict judge(const ViewRequest& request) const;
  [[nodiscard]] const std::string& token() const { return token_; }
  [[nodiscard]] bool is_tls() const { return is_tls_; }

 private:
  [[nodiscard]] bool is_own(std::string_view host) const;
  [[nodiscard]] bool may_connect(const ViewRequest& request) const;

  std::string token_;
  bool is_tls_;
  bool is_loopback_;
  std::vector<std::string> hosts_;
  std::vector<std::string> origins_;
};

}  // namespace cairn::live
