// Whose pages may play here: a browser sends with every WebSocket the origin of the page that opened it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobble::web {

// origin, host: the headers of those names, empty when there is none. True for a page of this very host, for those
// `allowed`, and for whoever is no browser and so sends no origin.
[[nodiscard]] bool IsOriginAllowed(std::string_view origin, std::string_view host,
                                   const std::vector<std::string>& allowed);

// "http://HOST[:PORT]" or the same with https, and nothing behind it.
[[nodiscard]] bool IsOrigin(std::string_view text);

}  // namespace wobble::web
