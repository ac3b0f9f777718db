// Writes figures for Prometheus. server/HOSTING.md describes what each means and on which to alert.
#pragma once

#include <string>

#include "server/ops/figures.h"

namespace wobble::ops {

// Returns all metrics in Prometheus' text format, version 0.0.4. version, scene: labels of wobble_build_info.
[[nodiscard]] std::string WriteMetrics(const Figures& figures, const std::string& version, const std::string& scene);

}  // namespace wobble::ops
