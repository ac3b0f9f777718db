// Builds rings. The gas pushes each of the p vertices of the innermost ring, of radius R, outward with
//   G = (P − P₀) R sin(2π/p),
// half the chord between its two neighbours times the pressure. A ring under tension T pulls its vertices inward with
// 2T sin(π/p). All L layers are given the same tension,
//   T = G / (2 L sin(π/p)) = (P − P₀) R cos(π/p) / L,
// Laplace's law for a polygon. Radial springs are compressed and pass on the load that the rings inside do not bear;
// diagonals are at rest. So the rest lengths are known and the stated radii exact, without the relaxation that a ball
// needs.
//
// That balance has to be stable. Where the innermost ring, of radius a, turns by φ inside the next, of radius b, every
// compressed radial spring of length s = b − a and force F gives way with −F ab/s, and its two diagonals, of length d,
// hold with 2k (ab sin(2π/p)/d)²; so the ring turns over where
//   F > 2k s · ab sin²(2π/p)/d²,   d² = s² + 4ab sin²(π/p).
// The least eigenvalue of the stiffness at rest says the same of two layers; five layers of few points give way by
// other modes at 0.6 of it, and rings that are near the limit turn over when they fall. Half of it is allowed.
#include "server/physics/shapes/ring.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "server/physics/contact/contact.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"
#include "server/physics/shapes/quad.h"

namespace wobble::physics {
namespace {

struct Layout {
  int points;
  int layers;
  double innerRadius;
  double spacing;  // of neighbouring rings, m

  explicit Layout(const RingDefinition& d)
      : points(d.points),
        layers(d.layers),
        innerRadius(d.layers > 1 ? d.radius - d.thickness : d.radius),
        spacing(d.layers > 1 ? d.thickness / (d.layers - 1) : 0) {}

  [[nodiscard]] std::uint16_t IndexOf(int layer, int point) const {
    return static_cast<std::uint16_t>(layer * points + point % points);
  }
  [[nodiscard]] double HalfAngle() const { return std::numbers::pi / points; }
  [[nodiscard]] double InnerArea() const { return points * innerRadius * innerRadius * std::sin(2 * HalfAngle()) / 2; }
};

// P − P₀, Pa.
double FindGaugePressure(const Layout& layout, const Material& material) {
  return material.gas > 0 ? material.gas / layout.InnerArea() - material.ambientPressure : 0;
}

double FindTension(const Layout& layout, const Material& material) {
  return FindGaugePressure(layout, material) * layout.innerRadius * std::cos(layout.HalfAngle()) / layout.layers;
}

// The most gas, J, that the springs hold, and what happens with more.
struct GasLimit {
  double gas;
  const char* beyond;
};

GasLimit FindMostGas(const Layout& layout, const Material& material) {
  const double halfSine = std::sin(layout.HalfAngle());
  double tension = (1 - kMinRestShare) * material.stiffness * 2 * layout.innerRadius * halfSine;
  const char* beyond = "its springs would vanish";
  if (layout.layers > 1) {
    const double product = layout.innerRadius * (layout.innerRadius + layout.spacing);
    const double diagonal = layout.spacing * layout.spacing + 4 * product * halfSine * halfSine;  // squared
    const double sine = std::sin(2 * layout.HalfAngle());
    const double compression = material.stiffness * layout.spacing * product * sine * sine / diagonal;
    const double turning = compression / (2 * halfSine * (layout.layers - 1));
    if (turning < tension) beyond = "its inner ring would turn over";
    tension = std::min(tension, turning);
  }
  const double pressure = tension * layout.layers / (layout.innerRadius * std::cos(layout.HalfAngle()));
  return {(pressure + material.ambientPressure) * layout.InnerArea(), beyond};
}

void AddSprings(const Layout& layout, const Material& material, double vertexMass, Blueprint& blueprint) {
  const double damping = FindDamping(material.dampingRatio, material.stiffness, vertexMass);
  const auto add = [&](std::uint16_t a, std::uint16_t b, double tension) {
    const double length = (blueprint.rest[a] - blueprint.rest[b]).norm();
    blueprint.full.springs.push_back({.a = a,
                                      .b = b,
                                      .restLength = length - tension / material.stiffness,
                                      .stiffness = material.stiffness,
                                      .damping = damping});
  };
  const double tension = FindTension(layout, material);
  const double borne = 2 * tension * std::sin(layout.HalfAngle());
  for (int layer = 0; layer < layout.layers; ++layer) {
    for (int i = 0; i < layout.points; ++i) add(layout.IndexOf(layer, i), layout.IndexOf(layer, i + 1), tension);
    if (layer + 1 == layout.layers) break;
    const double handedOn = borne * (layout.layers - layer - 1);
    for (int i = 0; i < layout.points; ++i) {
      add(layout.IndexOf(layer, i), layout.IndexOf(layer + 1, i), -handedOn);
      add(layout.IndexOf(layer, i), layout.IndexOf(layer + 1, i + 1), 0);
      add(layout.IndexOf(layer, i + 1), layout.IndexOf(layer + 1, i), 0);
    }
  }
}

// Covers the inside by a strip of faces that goes to and fro: 0 1 p−1, 1 2 p−1, 2 p−2 p−1 and so on.
void AddStrip(int points, std::vector<Face>& faces) {
  auto low = std::uint16_t{0};
  auto high = static_cast<std::uint16_t>(points - 1);
  for (bool fromLow = true; high - low >= 2; fromLow = !fromLow) {
    if (fromLow) {
      faces.push_back({low, static_cast<std::uint16_t>(low + 1), high});
      ++low;
    } else {
      faces.push_back({low, static_cast<std::uint16_t>(high - 1), high});
      --high;
    }
  }
}

void AddFaces(const Layout& layout, std::vector<Face>& faces) {
  if (layout.layers == 1) return AddStrip(layout.points, faces);
  for (int layer = 0; layer + 1 < layout.layers; ++layer) {
    for (int i = 0; i < layout.points; ++i) {
      const std::uint16_t a = layout.IndexOf(layer, i);
      const std::uint16_t b = layout.IndexOf(layer + 1, i);
      const std::uint16_t c = layout.IndexOf(layer + 1, i + 1);
      const std::uint16_t d = layout.IndexOf(layer, i + 1);
      AddQuad(a, b, c, d, (layer + i) % 2 != 0, faces);
    }
  }
}

}  // namespace

std::vector<FieldError> ValidateRing(const RingDefinition& d) {
  std::vector<FieldError> errors;
  const Material& m = d.material;
  CheckField(errors, "points", d.points, d.points >= 3 && d.points <= kMaxRingPoints, "3 to 512");
  CheckField(errors, "layers", d.layers, d.layers >= 1 && d.layers <= kMaxRingLayers, "1 to 8");
  CheckField(errors, "radius", d.radius, d.radius >= 0.05 && d.radius <= 50, "0.05 to 50 m");
  CheckField(errors, "thickness", d.thickness,
             d.layers <= 1 || (d.thickness >= 0.01 * (d.layers - 1) && d.thickness <= 0.9 * d.radius),
             "from 0.01 m a layer to 0.9 of the radius");
  CheckMaterial(errors, m);
  CheckGas(errors, m);
  if (!errors.empty()) return errors;

  const Layout layout(d);
  const double pressure = FindGaugePressure(layout, m);
  const GasLimit most = FindMostGas(layout, m);
  CheckField(errors, "gas", m.gas, d.layers > 1 || m.gas > 0, "above 0 J: a single ring is held open by its gas alone");
  CheckField(errors, "gas", m.gas, pressure >= 0, "more, or ambient_pressure lower: the ring would be crushed");
  const std::string range =
      "at most " + std::to_string(most.gas) + " J for these radii, stiffness and ambient_pressure, or " + most.beyond;
  CheckField(errors, "gas", m.gas, m.gas <= most.gas, range.c_str());
  if (errors.empty()) CheckStiffness(errors, m, MakeRing(d));
  return errors;
}

Blueprint MakeRing(const RingDefinition& definition) {
  const Layout layout(definition);
  const Material& material = definition.material;
  const double vertexMass = material.mass / (layout.points * layout.layers);

  Blueprint blueprint;
  blueprint.name = definition.name;
  Coefficients<double>& full = blueprint.full;
  for (int layer = 0; layer < layout.layers; ++layer) {
    const double radius = layout.innerRadius + layer * layout.spacing;
    for (int i = 0; i < layout.points; ++i) {
      const double angle = 2 * layout.HalfAngle() * i;
      blueprint.rest.emplace_back(radius * std::cos(angle), 0, radius * std::sin(angle));
      full.masses.push_back(vertexMass);
    }
  }
  AddSprings(layout, material, vertexMass, blueprint);
  AddFaces(layout, full.faces);
  full.planar = true;
  for (int i = 0; i < layout.points; ++i) full.outline.push_back({layout.IndexOf(0, i), layout.IndexOf(0, i + 1)});
  full.gas = material.gas;
  full.ambientPressure = material.ambientPressure;
  blueprint.gasDampingRatio = material.FindGasDampingRatio();
  SetRepulsion(blueprint, material.repulsion);
  full.contact = MakeContactParameters(material, vertexMass, definition.radius);
  FinishBlueprint(blueprint);
  SetAim(blueprint);
  return blueprint;
}

}  // namespace wobble::physics
