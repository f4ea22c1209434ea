// SPDX-License-Identifier: GPL-3.0-or-later
// Who may talk to the server (docs/method/page.md).
#pragma once
#include <string>
#include <string_view>

namespace palpate::serve {

struct AccessPolicy {
  bool loopback = true;  ///< bound to this machine only: the Host must then name this machine
  std::string token;     ///< empty: none is asked for; never empty where !loopback
};

/// What of a request matters; empty where the header is missing.
struct RequestHeaders {
  std::string_view host;
  std::string_view origin;
  std::string_view cookie;
  std::string_view target;  ///< path and query as sent
};

enum class Verdict {
  ok,
  ok_set_cookie,  ///< the token came in the address: hand out the cookie and hide the token
  wrong_host,     ///< a name that is not this machine (DNS rebinding)
  wrong_origin,   ///< another site's page
  no_token,
};

/// An Origin, where sent, must be this server's own. Browsers send one with every web socket; a
/// program of the user's own need not.
[[nodiscard]] Verdict judge(const AccessPolicy& policy, const RequestHeaders& request);

/// Path of a target, without its query.
[[nodiscard]] std::string_view path_of(std::string_view target);
/// Value of `name` in the query, as written; empty where missing.
[[nodiscard]] std::string_view query_value(std::string_view target, std::string_view name);
/// "127.x.x.x", "localhost" or "[::1]", with or without port.
[[nodiscard]] bool names_this_machine(std::string_view host);
/// A numeric address that only this machine reaches: 127.x.x.x or ::1.
[[nodiscard]] bool is_loopback(const std::string& address);
/// Takes the same time whatever differs.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);
/// 32 hexadecimal digits from the system's generator. @throws FileError  it does not answer
[[nodiscard]] std::string new_token();

inline constexpr std::string_view kCookieName = "palpate_token";

}  // namespace palpate::serve
