// Figures as Prometheus reads them. What each means and which to alert on: server/HOSTING.md.
#pragma once

#include <string>

#include "server/ops/figures.h"

namespace wobble::ops {

// Returns all metrics in Prometheus' text format, version 0.0.4. version, scene: labels of wobble_build_info.
[[nodiscard]] std::string WriteMetrics(const Figures& figures, const std::string& version, const std::string& scene);

}  // namespace wobble::ops
