// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/access.hpp"

#include <arpa/inet.h>
#include <sys/random.h>

#include <array>

#include "core/error.hpp"

namespace palpate::serve {

namespace {

std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view one = cookies.substr(0, end);
    while (!one.empty() && one.front() == ' ') one.remove_prefix(1);
    if (one.size() > name.size() && one.substr(0, name.size()) == name && one[name.size()] == '=')
      return one.substr(name.size() + 1);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
  }
  return {};
}

}  // namespace

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::string_view query_value(std::string_view target, std::string_view name) {
  const std::size_t mark = target.find('?');
  if (mark == std::string_view::npos) return {};
  std::string_view rest = target.substr(mark + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view one = rest.substr(0, end);
    if (one.size() > name.size() && one.substr(0, name.size()) == name && one[name.size()] == '=')
      return one.substr(name.size() + 1);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

bool names_this_machine(std::string_view host) {
  std::string_view name = host;
  if (!name.empty() && name.front() == '[') {
    const std::size_t end = name.find(']');
    if (end == std::string_view::npos) return false;
    const std::string_view after = name.substr(end + 1);
    return name.substr(0, end + 1) == "[::1]" && (after.empty() || after.front() == ':');
  }
  name = name.substr(0, name.find(':'));
  return name == "localhost" || is_loopback(std::string(name));
}

bool is_loopback(const std::string& address) {
  in_addr v4{};
  if (inet_pton(AF_INET, address.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24U) == 127;
  in6_addr v6{};
  return inet_pton(AF_INET6, address.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6);
}

bool same_secret(std::string_view a, std::string_view b) {
  unsigned different = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(other);
  }
  return different == 0;
}

Verdict judge(const AccessPolicy& policy, const RequestHeaders& r) {
  if (r.host.empty() || (policy.loopback && !names_this_machine(r.host)))
    return Verdict::wrong_host;
  if (!r.origin.empty() && r.origin != "http://" + std::string(r.host))
    return Verdict::wrong_origin;
  if (policy.token.empty()) return policy.loopback ? Verdict::ok : Verdict::no_token;
  if (same_secret(cookie_value(r.cookie, kCookieName), policy.token)) return Verdict::ok;
  if (same_secret(query_value(r.target, "token"), policy.token)) return Verdict::ok_set_cookie;
  return Verdict::no_token;
}

std::string new_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw FileError("the system's random generator does not answer; give a --token of your own");
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char b : bytes) {
    text += kDigits[b >> 4U];
    text += kDigits[b & 15U];
  }
  return text;
}

}  // namespace palpate::serve
