#include "client/host/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace wobble::host {

Screen::Screen() : m_isTerminal(isatty(STDOUT_FILENO) != 0) {}

void Screen::Say(const std::string& line) {
  EndStatus();
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Screen::Complain(const std::string& line) {
  EndStatus();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Screen::ShowStatus(std::string line) {
  winsize size{};
  if (m_isTerminal && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) {
    line.resize(std::min<std::size_t>(line.size(), size.ws_col - 1));  // a wrapped line could not be rewritten
  }
  std::printf(m_isTerminal ? "\r%s\033[K" : "%s\n", line.c_str());
  std::fflush(stdout);
  m_isStatusOpen = m_isTerminal;
}

void Screen::EndStatus() {
  if (m_isStatusOpen) std::printf("\n");
  std::fflush(stdout);
  m_isStatusOpen = false;
}

}  // namespace wobble::host
