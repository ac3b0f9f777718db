// QR codes for terminals.
#pragma once

#include <string>
#include <vector>

namespace wobble::command {

// The lines of a QR code (ISO/IEC 18004) of the text, without line ends: half blocks in UTF-8, black on white by ANSI
// colours of their own, so that it can be read on dark and on light terminals; the quiet zone of four modules is part
// of it. Empty when the text is empty or longer than a code holds.
[[nodiscard]] std::vector<std::string> DrawQrCode(const std::string& text);

// Columns that these lines take.
[[nodiscard]] std::size_t MeasureQrCode(const std::vector<std::string>& lines);

// Prints the address of a page, that of this machine which friends in the same network most likely reach, and its QR
// code, to standard output. For people alone: prints nothing where that is no terminal, or where only this machine
// reaches the page; no code where the terminal is too narrow. bind: address that the page is served at, numeric.
void ShowPageToFriends(const std::string& scheme, const std::string& bind, unsigned port);

}  // namespace wobble::command
