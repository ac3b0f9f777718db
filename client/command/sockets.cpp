#include "client/command/sockets.h"

#include <sys/resource.h>

namespace wobble::command {

void AllowManySockets() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  static_cast<void>(setrlimit(RLIMIT_NOFILE, &limit));  // a failure shows when sockets cannot be opened
}

}  // namespace wobble::command
