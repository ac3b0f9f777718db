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

}  // namespace wobble::command
