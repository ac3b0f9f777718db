// Which pages may play here: with every WebSocket a browser sends the origin of the page that opened it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobble::gateway {

// origin, host: the headers of these names, empty when absent. True for pages of this host, for origins in `allowed`,
// and for clients other than browsers, which send no origin.
[[nodiscard]] bool IsOriginAllowed(std::string_view origin, std::string_view host,
                                   const std::vector<std::string>& allowed);

// Whether the text is http://HOST[:PORT] or https://HOST[:PORT], with nothing behind it.
[[nodiscard]] bool IsOrigin(std::string_view text);

}  // namespace wobble::gateway
