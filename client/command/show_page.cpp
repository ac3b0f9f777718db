#include "client/command/show_page.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <vector>

#include "client/command/lan_address.h"
#include "client/command/qr_code.h"

namespace wobble::command {

void ShowPageToFriends(const std::string& scheme, const std::string& bind, unsigned port) {
  if (isatty(STDOUT_FILENO) == 0) return;
  const std::vector<std::string> addresses = FindLanAddresses(bind);
  if (addresses.empty()) return;
  const std::string url = MakePageUrl(scheme, addresses[0], port);
  std::printf("friends in the same network open %s\n", url.c_str());
  const std::vector<std::string> lines = DrawQrCode(url);
  winsize size{};
  const bool isNarrow =
      ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_col < MeasureQrCode(lines);
  if (!isNarrow) {
    for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  }
  std::fflush(stdout);
}

}  // namespace wobble::command
