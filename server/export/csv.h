// A table of all bodies in all frames.
#pragma once

#include <filesystem>
#include <fstream>

#include "server/export/frame.h"

namespace wobble::exporting {

// One row a body and frame; lines that begin with # and the line of names state the columns and their units.
class CsvWriter : public FrameWriter {
 public:
  // scene: its name, for people.
  CsvWriter(const std::filesystem::path& file, const std::string& scene);

  [[nodiscard]] std::string Add(const Frame& frame) override;
  [[nodiscard]] std::string Finish() override;

 private:
  [[nodiscard]] std::size_t CountTorn(const physics::World& world, const physics::Body& body);

  std::ofstream m_file;
  std::uint64_t m_revision = 0;            // of the blueprints when m_tornInSlots was filled
  std::vector<std::size_t> m_tornInSlots;  // by slot: springs that its blueprint is without because they tore
  std::vector<physics::Vector3d> m_scratch;
};

}  // namespace wobble::exporting
