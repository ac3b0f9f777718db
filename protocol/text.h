// Text from the wire in a form that may be shown and logged.
//
// Names, notices and goodbyes are written by strangers. A terminal obeys control characters (C1 as well as C0), bidi
// overrides turn the rest of a line round, invisible characters make two names look alike, and a browser or a log
// reader may refuse a line that is not UTF-8. All text from the wire passes through MakeLine before anything but the
// protocol sees it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wobble::protocol {

// Bytes of a goodbye's detail, and of a scene's or a blueprint's name, that are shown.
inline constexpr std::size_t kMaxShownBytes = 200;

// Makes one line of valid UTF-8, of at most maxBytes, out of any bytes. Control characters (Unicode category Cc) and
// separators of lines and paragraphs (Zl, Zp) become spaces; format characters (Cf: bidi controls, zero-width
// characters, tags) are left out; each byte that is not part of well-formed UTF-8 becomes U+FFFD. The line ends before
// the first character that does not fit whole. Its cost grows with the text, not with maxBytes.
[[nodiscard]] std::string MakeLine(std::string_view text, std::size_t maxBytes);

}  // namespace wobble::protocol
