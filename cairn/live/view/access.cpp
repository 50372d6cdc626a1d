// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/view/access.hpp>

#include <arpa/inet.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cerrno>
#include <charconv>
#include <optional>
#include <system_error>

namespace cairn::live {
namespace {

constexpr std::size_t kShortestToken = 16;
constexpr std::size_t kLongestToken = 128;

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

std::string lower(std::string_view text) {
  std::string all(text);
  for (char& c : all) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return all;
}

void check_token(const std::string& token) {
  const bool is_sound = token.size() >= kShortestToken && token.size() <= kLongestToken &&
                        std::all_of(token.begin(), token.end(), [](char c) {
                          return is_digit(c) || is_letter(c) || c == '-' || c == '_';
                        });
  if (!is_sound) {
    throw Error("--view-token: found " + std::to_string(token.size()) +
                " characters, expected 16 to 128 letters, digits, - and _");
  }
}

/// Splits "localhost:8765", "[::1]:8765" or "127.0.0.1" into a name and the port's digits, if any.
struct HostAndPort {
  std::string name;
  std::string port;
};
std::optional<HostAndPort> parts_of(std::string_view host) {
  std::string_view name = host;
  std::string_view port;
  const std::size_t end_of_name = host.starts_with('[') ? host.find(']') : 0;
  if (end_of_name == std::string_view::npos) return std::nullopt;
  if (const std::size_t colon = host.find(':', end_of_name); colon != std::string_view::npos) {
    name = host.substr(0, colon);
    port = host.substr(colon + 1);
  }
  if (name.starts_with('[')) {
    if (!name.ends_with(']')) return std::nullopt;
    name = name.substr(1, name.size() - 2);
  }
  if (port.size() > 5 || !std::all_of(port.begin(), port.end(), is_digit)) return std::nullopt;
  return HostAndPort{lower(name), std::string(port)};
}

/// An address in canonical form; nullopt if the text is no address.
std::optional<std::string> address_of(const std::string& text) {
  std::array<unsigned char, 16> bytes{};
  std::array<char, INET6_ADDRSTRLEN> written{};
  for (const int family : {AF_INET, AF_INET6}) {
    if (inet_pton(family, text.c_str(), bytes.data()) == 1)
      return inet_ntop(family, bytes.data(), written.data(), written.size());
  }
  return std::nullopt;
}

std::string value_of(std::string_view query, std::string_view key) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    if (part.size() > key.size() && part.starts_with(key) && part[key.size()] == '=')
      return std::string(part.substr(key.size() + 1));
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

std::string cookie_of(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view part = cookies.substr(0, end);
    while (part.starts_with(' ')) part.remove_prefix(1);
    if (part.size() > name.size() && part.starts_with(name) && part[name.size()] == '=')
      return std::string(part.substr(name.size() + 1));
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
  }
  return {};
}

/// Cookies are per host, not per port. The port in the name separates two robots behind two tunnels.
std::string cookie_name(std::string_view host) {
  const auto parts = parts_of(host);
  return "cairn_" + (parts && !parts->port.empty() ? parts->port : std::string("view"));
}

}  // namespace

void read_view_address(const std::string& text, ViewOptions& options) {
  const auto refuse = [&] {
    throw Error("--view: found '" + text + "', expected an address and a port, such as 127.0.0.1:8765");
  };
  std::string address = text;
  // Several colons without brackets: an IPv6 address without a port.
  const bool is_bare = !text.starts_with('[') && std::count(text.begin(), text.end(), ':') > 1;
  if (!is_bare) {
    const auto parts = parts_of(text);
    if (!parts || text.ends_with(':')) refuse();
    address = parts->name;
    if (!parts->port.empty()) {
      unsigned port = 0;
      std::from_chars(parts->port.data(), parts->port.data() + parts->port.size(), port);
      if (port > 65535) refuse();
      options.port = static_cast<std::uint16_t>(port);
    }
  }
  if (address == "localhost") address = "127.0.0.1";
  if (address.empty()) return;
  if (!address_of(address)) refuse();
  options.address = address;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = getrandom(bytes.data() + filled, bytes.size() - filled, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      throw Error("--view: no random numbers for a token: " + std::generic_category().message(errno));
    filled += static_cast<std::size_t>(got);
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

bool is_equal_in_constant_time(std::string_view a, std::string_view b) {
  // The length of the secret may be known.
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    difference |= static_cast<unsigned char>(a[i] ^ other);
  }
  return difference == 0;
}

bool is_loopback(const std::string& address) {
  const auto known = address_of(address);
  if (!known) throw Error("--view: found '" + address + "', expected an IP address such as 127.0.0.1");
  return known->starts_with("127.") || *known == "::1";
}

Access::Access(const ViewOptions& options)
    : token_(options.token.empty() ? random_token() : options.token),
      is_tls_(!options.tls_cert.empty()),
      is_loopback_(is_loopback(options.address)),
      origins_(options.origins) {
  check_token(token_);
  if (options.tls_cert.empty() != options.tls_key.empty()) {
    throw Error(options.tls_cert.empty() ? "--tls-key: found no --tls-cert, expected both or none"
                                         : "--tls-cert: found no --tls-key, expected both or none");
  }
  if (!is_loopback_ && !is_tls_ && !options.insecure) {
    throw Error("--view: found " + options.address +
                ", reachable from the network without encryption; expected --tls-cert and --tls-key, or "
                "--insecure (or 127.0.0.1 and ssh -L)");
  }
  for (const std::string& origin : origins_) {
    if (!origin.starts_with("https://") && !origin.starts_with("http://"))
      throw Error("--view-origin: found '" + origin + "', expected one such as https://app.foxglove.dev");
  }
  hosts_ = {"localhost"};
  if (is_loopback_) {
    hosts_.insert(hosts_.end(), {"127.0.0.1", "::1", *address_of(options.address)});
  } else {
    const std::string name = lower(io::host_name());
    if (!name.empty()) hosts_.insert(hosts_.end(), {name, name + ".local"});
  }
}

/// Under DNS rebinding, a request names the attacker's host. Addresses cannot be rebound.
bool Access::is_own(std::string_view host) const {
  const auto parts = parts_of(host);
  if (!parts) return false;
  if (std::find(hosts_.begin(), hosts_.end(), parts->name) != hosts_.end()) return true;
  return !is_loopback_ && address_of(parts->name).has_value();
}

/// A page of another origin must not use the browser's cookie. Programs send no origin.
bool Access::may_connect(const ViewRequest& request) const {
  if (request.origin.empty()) return true;
  const std::string own = (is_tls_ ? "https://" : "http://") + lower(request.host);
  return lower(request.origin) == own ||
         std::find(origins_.begin(), origins_.end(), request.origin) != origins_.end();
}

ViewVerdict Access::judge(const ViewRequest& request) const {
  const std::size_t question = std::min(request.target.find('?'), request.target.size());
  const std::string path(request.target.substr(0, question));
  const auto refuse = [&](int status, std::string text) {
    return ViewVerdict{status, std::move(text), path};
  };
  if (!is_own(request.host)) {
    return refuse(421, is_loopback_ ? "unknown name, expected localhost or 127.0.0.1"
                                    : "unknown name, expected that of this computer or its address");
  }
  if (request.method != "GET") return refuse(405, "expected GET");
  if (!path.starts_with('/')) return refuse(400, "expected a path");
  const std::string_view query =
      question < request.target.size() ? request.target.substr(question + 1) : std::string_view();
  const std::string given = value_of(query, "token");
  const std::string name = cookie_name(request.host);
  const std::string kept = cookie_of(request.cookie, name);
  if (!is_equal_in_constant_time(given.empty() ? kept : given, token_))
    return refuse(403, "no token, or a wrong one; expected the address printed by cairn live");
  if (request.is_upgrade && !may_connect(request))
    return refuse(403, "a page of another origin; expected that of this server, or one of --view-origin");
  if (path == "/" && !given.empty() && !request.is_upgrade) {
    return {303,
            {},
            path,
            name + "=" + token_ + "; Path=/; HttpOnly; SameSite=Strict" + (is_tls_ ? "; Secure" : "")};
  }
  return {200, {}, path};
}

}  // namespace cairn::live
