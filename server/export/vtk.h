// A series of VTK's PolyData for ParaView.
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "server/export/frame.h"

namespace wobble::exporting {

// NAME.pvd, which lists one NAME_00000.vtp a frame: all bodies with their faces (or springs, or points), and for each
// vertex velocity (m/s), force (N, the sum of InspectForces), acceleration (m/s²), kinetic energy (J) and the number of
// its body, which cells have too. Positions in the scene's axes, z up, m, in double precision: as the world has them.
class VtkWriter : public FrameWriter {
 public:
  // folder: empty.
  VtkWriter(std::filesystem::path folder, std::string name);

  [[nodiscard]] std::string Add(const Frame& frame) override;
  [[nodiscard]] std::string Finish() override;

 private:
  std::filesystem::path m_folder;
  std::string m_name;
  std::vector<std::pair<double, std::string>> m_series;  // time, s, and file name
};

}  // namespace wobble::exporting
