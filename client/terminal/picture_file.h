// A screen as a file that browsers show.
#pragma once

#include <string>

#include "client/terminal/cells.h"

namespace wobble::terminal {

// The cells as SVG: what a terminal shows of them, pixel by pixel, its text in the viewer's monospaced font. A cell is
// 8 × 16 units.
[[nodiscard]] std::string MakeSvg(const CellGrid& grid);

}  // namespace wobble::terminal
