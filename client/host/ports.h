// Ports that two programs want, of one file or of the whole machine.
#pragma once

#include <string>
#include <vector>

#include "client/host/plan.h"
#include "client/host/worlds_file.h"

namespace wobble::host {

// The TCP ports that two programs of the file would listen at, in the form of WorldsFile::errors. UDP ports are chosen
// when the file is read.
[[nodiscard]] std::vector<std::string> FindPortClashes(const WorldsFile& file);

// The first port of a world or of the page that another program has, such as "the page's port 8080 (TCP) is in use";
// empty: none.
[[nodiscard]] std::string FindTakenPort(const Plan& plan);

}  // namespace wobble::host
