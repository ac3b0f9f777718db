// A character is two modules, one above the other. Colours are 16 and 231 of the 256, black and white everywhere:
// themes change the first sixteen.
#include "client/command/qr_code.h"

#include <qrencode.h>

#include <memory>
#include <string_view>

namespace wobble::command {
namespace {

constexpr int kQuietModules = 4;
constexpr std::string_view kColours = "\x1b[38;5;16;48;5;231m";
constexpr std::string_view kNoColours = "\x1b[0m";

}  // namespace

std::vector<std::string> DrawQrCode(const std::string& text) {
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_L),
                                                             QRcode_free);
  if (code == nullptr) return {};
  const int width = code->width;
  const auto isDark = [&](int column, int row) {
    const bool isInside = column >= 0 && column < width && row >= 0 && row < width;
    return isInside && (code->data[row * width + column] & 1) != 0;
  };
  std::vector<std::string> lines;
  for (int row = -kQuietModules; row < width + kQuietModules; row += 2) {
    std::string line(kColours);
    for (int column = -kQuietModules; column < width + kQuietModules; ++column) {
      const bool above = isDark(column, row), below = isDark(column, row + 1);
      line += above ? (below ? "█" : "▀") : (below ? "▄" : " ");
    }
    lines.push_back(line.append(kNoColours));
  }
  return lines;
}

std::size_t MeasureQrCode(const std::vector<std::string>& lines) {
  // Half of a code's height, which is its width, or half of one more.
  return lines.empty() ? 0 : 2 * lines.size();
}

}  // namespace wobble::command
