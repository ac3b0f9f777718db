// Writes a screen as an SVG file.
#pragma once

#include <string>

#include "client/terminal/cells.h"

namespace wobble::terminal {

// The cells as SVG: the same picture pixel by pixel, with text in the viewer's monospaced font. A cell is 8 x 16 units.
[[nodiscard]] std::string MakeSvg(const CellGrid& grid);

}  // namespace wobble::terminal
