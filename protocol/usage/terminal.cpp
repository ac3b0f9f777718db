#include "protocol/usage/terminal.h"

#include <fcntl.h>
#include <unistd.h>

namespace wobble::usage {

bool HasTerminal() {
  const int terminal = open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal >= 0) close(terminal);
  return terminal >= 0;
}

}  // namespace wobble::usage
