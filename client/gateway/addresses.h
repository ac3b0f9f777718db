// Whose connection it is: IP addresses as text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobble::gateway {

// One spelling for each address; an IPv4 address that is mapped into IPv6 is the IPv4 address. Empty
// when the text is no numeric address.
[[nodiscard]] std::string SpellAddress(std::string_view text);

[[nodiscard]] bool IsTrusted(const std::string& address, const std::vector<std::string>& trusted);

// Whether it is this machine itself. address: as SpellAddress has it.
[[nodiscard]] bool IsLoopback(const std::string& address);
// Whether a request's Host header, with or without a port, names this machine by itself: localhost, 127.0.0.1, [::1].
[[nodiscard]] bool IsLoopbackHost(std::string_view host);

// The address of the browser behind a connection. peer: the connection's other end; forwardedFor: all that the
// request's X-Forwarded-For headers say, separated by commas; trusted: addresses of proxies. Both as SpellAddress has
// them.
//
// Each proxy adds the address that it was called from at the end, and what stands before that may be invented. So from
// a trusted peer the last address that is not trusted counts; from others the header is ignored. A trusted peer that
// names nobody, or something that is no address, counts by itself.
[[nodiscard]] std::string FindBrowserAddress(const std::string& peer, std::string_view forwardedFor,
                                             const std::vector<std::string>& trusted);

// The text by which places are counted: an IPv4 address, or the first 64 bits of an IPv6 address, which is what a
// household gets. address: as SpellAddress has it.
[[nodiscard]] std::string FindHousehold(const std::string& address);

}  // namespace wobble::gateway
