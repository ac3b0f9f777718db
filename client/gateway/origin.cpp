// Without this check any page that is open in the same browser could play through a gateway on localhost. Host and port
// are compared, the scheme is not: a proxy in front may speak https where this end speaks http.
#include "client/gateway/origin.h"

#include <algorithm>
#include <cctype>

namespace wobble::gateway {
namespace {

bool IsSame(std::string_view first, std::string_view second) {
  return std::equal(first.begin(), first.end(), second.begin(), second.end(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

// The text behind "http://" or "https://"; empty for anything else.
std::string_view FindHost(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (IsSame(origin.substr(0, scheme.size()), scheme)) return origin.substr(scheme.size());
  }
  return {};
}

}  // namespace

bool IsOriginAllowed(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed) {
  if (origin.empty()) return true;
  if (!host.empty() && IsSame(FindHost(origin), host)) return true;
  return std::any_of(allowed.begin(), allowed.end(), [&](const std::string& each) { return IsSame(origin, each); });
}

bool IsOrigin(std::string_view text) {
  const std::string_view host = FindHost(text);
  return !host.empty() && host.find_first_of("/?#@ ") == std::string_view::npos;
}

}  // namespace wobble::gateway
