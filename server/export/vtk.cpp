// The files are "appended raw": a head in XML, then the arrays as they lie in memory, each behind its size in bytes.
#include "server/export/vtk.h"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <fstream>
#include <span>

#include "server/export/output.h"
#include "server/physics/inspect.h"

namespace wobble::exporting {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr const char* kComment =
    "<!-- wobble: SI units; axes right-handed, x and y level, z up; TimeValue: s since the recording began -->";

// The head and the arrays of a file while they grow.
class Document {
 public:
  template <class Value>
  void Add(const char* name, const char* type, int components, const char* unit, std::span<const Value> values) {
    m_head += fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}")",
                          type, name, components, m_data.size());
    const std::string label(unit);
    m_head += label.empty() ? "/>\n"
                            : fmt::format(
                                  "><InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}"
                                  "</InformationKey></DataArray>\n",
                                  label);
    const std::uint64_t bytes = values.size_bytes();
    m_data.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    m_data.append(reinterpret_cast<const char*>(values.data()), bytes);
  }
  void Say(const std::string& xml) { m_head += xml + '\n'; }

  [[nodiscard]] bool Write(const std::filesystem::path& file) const {
    errno = 0;
    std::ofstream out(file, std::ios::binary);
    out << R"(<?xml version="1.0"?>)" << '\n'
        << kComment << '\n'
        << R"(<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">)" << '\n'
        << m_head << "<AppendedData encoding=\"raw\">\n_" << m_data << "\n</AppendedData>\n</VTKFile>\n";
    out.close();
    return out.good();
  }

 private:
  std::string m_head;
  std::string m_data;
};

// One of PolyData's kinds of cells.
struct Cells {
  std::vector<std::int32_t> corners;
  std::vector<std::int32_t> ends;    // of each cell in `corners`
  std::vector<std::int32_t> bodies;  // of each cell

  template <class Corners>
  void Add(const Corners& cell, std::size_t firstVertex, physics::BodyId body) {
    for (const std::uint16_t corner : cell) corners.push_back(static_cast<std::int32_t>(firstVertex + corner));
    ends.push_back(static_cast<std::int32_t>(corners.size()));
    bodies.push_back(static_cast<std::int32_t>(body));
  }
};

// The arrays of a frame.
struct Content {
  std::vector<double> positions;
  std::vector<float> velocities, forces, accelerations, energies;
  std::vector<std::int32_t> bodies;  // one a vertex
  Cells points, lines, faces;
};

void Append(const physics::Vector3d& vector, std::vector<float>& values) {
  for (const double each : vector) values.push_back(static_cast<float>(each));
}

void AddBody(const physics::World& world, const physics::Body& body, Content& content) {
  const physics::Blueprint& blueprint = world.BlueprintOf(body);
  const std::size_t first = content.bodies.size();
  physics::VisitVertices(body, [&](std::size_t, const physics::Vector3d& position) {
    content.positions.insert(content.positions.end(), position.begin(), position.end());
    content.bodies.push_back(static_cast<std::int32_t>(body.id));
  });
  const physics::InspectedForces found = InspectForces(world, body.id);
  std::visit(
      [&](const auto& state) {
        for (std::size_t i = 0; i < state.velocities.size(); ++i) {
          const physics::Vector3d velocity = state.velocities[i].template cast<double>();
          Append(velocity, content.velocities);
          Append(
              found.elastic[i] + found.damping[i] + found.gas[i] + found.weight[i] + found.contact[i] + found.other[i],
              content.forces);
          Append(found.accelerations[i], content.accelerations);
          content.energies.push_back(static_cast<float>(blueprint.full.masses[i] / 2 * velocity.squaredNorm()));
        }
      },
      body.state);
  const Skeleton skeleton = FindSkeleton(blueprint, body);
  for (const physics::Face& face : skeleton.faces) content.faces.Add(face, first, body.id);
  for (const physics::EdgeEnds& line : skeleton.lines) content.lines.Add(line, first, body.id);
  for (const std::uint16_t point : skeleton.points) content.points.Add(std::array{point}, first, body.id);
}

void AddCells(const char* name, const Cells& cells, Document& document) {
  document.Say(fmt::format("<{}>", name));
  document.Add<std::int32_t>("connectivity", "Int32", 1, "", cells.corners);
  document.Add<std::int32_t>("offsets", "Int32", 1, "", cells.ends);
  document.Say(fmt::format("</{}>", name));
}

bool WriteFrame(const Content& content, double time, const std::filesystem::path& file) {
  Document document;
  document.Say("<PolyData>\n<FieldData>");
  document.Say(fmt::format(
      R"(<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{}</DataArray>)", time));
  document.Say(fmt::format(
      "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n<PointData Scalars=\"kinetic energy\" Vectors=\"velocity\">",
      content.bodies.size(), content.points.ends.size(), content.lines.ends.size(), content.faces.ends.size()));
  document.Add<float>("velocity", "Float32", 3, "m/s", content.velocities);
  document.Add<float>("force", "Float32", 3, "N", content.forces);
  document.Add<float>("acceleration", "Float32", 3, "m/s2", content.accelerations);
  document.Add<float>("kinetic energy", "Float32", 1, "J", content.energies);
  document.Add<std::int32_t>("body", "Int32", 1, "", content.bodies);
  document.Say("</PointData>\n<CellData Scalars=\"body\">");
  // In PolyData's order of cells.
  std::vector<std::int32_t> bodies;
  for (const Cells* cells : {&content.points, &content.lines, &content.faces}) {
    bodies.insert(bodies.end(), cells->bodies.begin(), cells->bodies.end());
  }
  document.Add<std::int32_t>("body", "Int32", 1, "", bodies);
  document.Say("</CellData>\n<Points>");
  document.Add<double>("Points", "Float64", 3, "m", content.positions);
  document.Say("</Points>");
  AddCells("Verts", content.points, document);
  AddCells("Lines", content.lines, document);
  AddCells("Polys", content.faces, document);
  document.Say("</Piece>\n</PolyData>");
  return document.Write(file);
}

}  // namespace

VtkWriter::VtkWriter(std::filesystem::path folder, std::string name)
    : m_folder(std::move(folder)), m_name(std::move(name)) {}

std::string VtkWriter::Add(const Frame& frame) {
  Content content;
  for (const physics::Body* body : frame.bodies) AddBody(frame.ground.World(), *body, content);
  const std::string name = fmt::format("{}_{:05}.vtp", m_name, m_series.size());
  m_series.emplace_back(frame.time, name);
  return WriteFrame(content, frame.time, m_folder / name) ? "" : DescribeWriteError();
}

std::string VtkWriter::Finish() {
  errno = 0;
  std::ofstream out(m_folder / (m_name + ".pvd"), std::ios::binary);
  out << R"(<?xml version="1.0"?>)" << '\n'
      << kComment << '\n'
      << R"(<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">)"
      << "\n<Collection>\n";
  for (const auto& [time, name] : m_series) {
    out << fmt::format(R"(<DataSet timestep="{}" group="" part="0" file="{}"/>)", time, name) << '\n';
  }
  out << "</Collection>\n</VTKFile>\n";
  out.close();
  return out.good() ? "" : DescribeWriteError();
}

}  // namespace wobble::exporting
