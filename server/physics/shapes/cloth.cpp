// Builds cloths. Each square adds its own share, as in a lattice: half of each of its sides and a quarter of its mass
// at each corner. So a wider cloth of the same material and mass a square metre moves alike. Of a hinge along the
// border half of the width is there.
#include "server/physics/shapes/cloth.h"

#include <cmath>

#include "server/physics/contact/contact.h"
#include "server/physics/methods/bending.h"
#include "server/physics/model/roots.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"
#include "server/physics/shapes/quad.h"

namespace wobble::physics {
namespace {

struct Weave {
  int columns;
  int rows;

  [[nodiscard]] std::uint16_t IndexOf(int column, int row) const {
    return static_cast<std::uint16_t>(row * columns + column);
  }
  [[nodiscard]] bool Holds(int column, int row) const {
    return column >= 0 && column < columns && row >= 0 && row < rows;
  }
  [[nodiscard]] double FindColumnShare(int column) const { return column == 0 || column == columns - 1 ? 0.5 : 1; }
  [[nodiscard]] double FindRowShare(int row) const { return row == 0 || row == rows - 1 ? 0.5 : 1; }

  template <class Visit>
  void VisitPoints(Visit&& visit) const {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) visit(column, row);
    }
  }
};

bool IsPinned(const Weave& weave, Pinned pinned, int column, int row) {
  const bool side = column == 0 || column == weave.columns - 1;
  const bool end = row == 0 || row == weave.rows - 1;
  switch (pinned) {
    case Pinned::kNone:
      return false;
    case Pinned::kCorners:
      return side && end;
    case Pinned::kTopCorners:
      return side && row == 0;
    case Pinned::kEdge:
      return row == 0;
    case Pinned::kFrame:
      return side || end;
    case Pinned::kClamp:
      return row < 2;
  }
  return false;
}

void AddSprings(const ClothDefinition& definition, const Weave& weave, double vertexMass, Blueprint& blueprint) {
  const Material& material = definition.material;
  const double damping = FindDamping(material.dampingRatio, material.stiffness, vertexMass);
  weave.VisitPoints([&](int column, int row) {
    const auto add = [&](int columns, int rows, double share) {
      if (!weave.Holds(column + columns, row + rows)) return;
      const double length = definition.spacing * FindHypotenuse(columns, rows);
      blueprint.full.springs.push_back({.a = weave.IndexOf(column, row),
                                        .b = weave.IndexOf(column + columns, row + rows),
                                        .restLength = length,
                                        .stiffness = share * material.stiffness,
                                        .damping = share * damping});
    };
    add(1, 0, weave.FindRowShare(row));
    add(0, 1, weave.FindColumnShare(column));
    if (definition.shear > 0) {
      add(1, 1, definition.shear);
      add(-1, 1, definition.shear);
    }
    if (definition.bend > 0) {
      add(2, 0, definition.bend * weave.FindRowShare(row));
      add(0, 2, definition.bend * weave.FindColumnShare(column));
    }
  });
}

// Hinges along rows and columns, and one for each square's twist (methods/bending.h). Damping: c is dampingRatio times
// what is critical for a hinge whose three masses m are free, ω² = k (1² + 2² + 1²)/m, and c/k is the same for all.
void AddHinges(const ClothDefinition& definition, const Weave& weave, double vertexMass, Blueprint& blueprint) {
  if (!(definition.bendStiffness > 0)) return;
  const double area = definition.spacing * definition.spacing;
  const double stiffness = definition.bendStiffness / area;
  const double damping = definition.material.dampingRatio * 2 * std::sqrt(stiffness * vertexMass / 6);
  blueprint.full.hingeFloorSquare = kFlatAngle * kFlatAngle * area;
  weave.VisitPoints([&](int column, int row) {
    const auto add = [&](std::array<int, 2> b, std::array<int, 2> c, std::array<int, 2> d, double share) {
      if (!weave.Holds(column + d[0], row + d[1])) return;
      const auto indexOf = [&](const std::array<int, 2>& way) { return weave.IndexOf(column + way[0], row + way[1]); };
      blueprint.full.hinges.push_back({.vertices = {weave.IndexOf(column, row), indexOf(b), indexOf(c), indexOf(d)},
                                       .stiffness = share * stiffness,
                                       .damping = share * damping});
    };
    add({1, 0}, {1, 0}, {2, 0}, weave.FindRowShare(row));
    add({0, 1}, {0, 1}, {0, 2}, weave.FindColumnShare(column));
    add({1, 0}, {0, 1}, {1, 1}, 2);
  });
}

// Adds two triangles for each square, cut along alternating diagonals so that no direction is favoured.
void AddFaces(const Weave& weave, std::vector<Face>& faces) {
  for (int row = 0; row + 1 < weave.rows; ++row) {
    for (int column = 0; column + 1 < weave.columns; ++column) {
      const std::uint16_t a = weave.IndexOf(column, row);
      const std::uint16_t b = weave.IndexOf(column, row + 1);
      const std::uint16_t c = weave.IndexOf(column + 1, row + 1);
      const std::uint16_t d = weave.IndexOf(column + 1, row);
      AddQuad(a, b, c, d, (column + row) % 2 != 0, faces);
    }
  }
}

ClothDefinition WithoutHinges(ClothDefinition definition) {
  definition.bendStiffness = 0;
  return definition;
}

// Of a cloth that is slow enough without hinges.
void CheckBendStiffness(std::vector<FieldError>& errors, const ClothDefinition& definition) {
  CheckField(errors, "bend_stiffness", definition.bendStiffness, IsSlowEnough(MakeCloth(definition)),
             "lower, or mass higher, spacing larger or damping_ratio lower: with it the body would need more than 32 "
             "substeps a tick before it touches anything, or more than 64 on the ground");
}

}  // namespace

std::vector<FieldError> ValidateCloth(const ClothDefinition& d) {
  std::vector<FieldError> errors;
  const auto isGood = [](int n) { return n >= 2 && n <= kMaxClothPoints; };
  if (!isGood(d.points[0]) || !isGood(d.points[1])) {
    errors.push_back({"points", "[" + std::to_string(d.points[0]) + ", " + std::to_string(d.points[1]) + "]",
                      "two whole numbers from 2 to " + std::to_string(kMaxClothPoints)});
  }
  CheckField(errors, "spacing", d.spacing, d.spacing >= 0.01 && d.spacing <= 5, "0.01 to 5 m");
  CheckField(errors, "shear", d.shear, d.shear > 0 && d.shear <= 1, "above 0, up to 1");
  CheckField(errors, "bend", d.bend, d.bend >= 0 && d.bend <= 1, "0 to 1");
  CheckField(errors, "bend_stiffness", d.bendStiffness, d.bendStiffness >= 0 && d.bendStiffness <= 1e6, "0 to 1e6 J");
  CheckField(errors, "tear_stretch", d.tearStretch,
             d.tearStretch == 0 || (d.tearStretch >= 1.05 && d.tearStretch <= 10), "0 (never) or 1.05 to 10");
  CheckMaterial(errors, d.material);
  if (errors.empty()) CheckStiffness(errors, d.material, MakeCloth(WithoutHinges(d)));
  if (errors.empty() && d.bendStiffness > 0) CheckBendStiffness(errors, d);
  return errors;
}

Blueprint MakeCloth(const ClothDefinition& definition) {
  const Weave weave{definition.points[0], definition.points[1]};
  const Material& material = definition.material;
  const double squareMass = material.mass / ((weave.columns - 1) * (weave.rows - 1));

  Blueprint blueprint;
  blueprint.name = definition.name;
  Coefficients<double>& full = blueprint.full;
  weave.VisitPoints([&](int column, int row) {
    const double along = definition.spacing * column;
    const double down = definition.spacing * row;
    const bool vertical = definition.orientation == Orientation::kVertical;
    blueprint.rest.push_back(vertical ? Vector3d(along, 0, -down) : Vector3d(along, -down, 0));
    full.masses.push_back(squareMass * weave.FindColumnShare(column) * weave.FindRowShare(row));
    if (IsPinned(weave, definition.pinned, column, row)) full.fixed.push_back(weave.IndexOf(column, row));
  });
  blueprint.grid = {static_cast<std::uint32_t>(weave.columns), static_cast<std::uint32_t>(weave.rows)};
  AddSprings(definition, weave, squareMass, blueprint);
  AddHinges(definition, weave, squareMass, blueprint);
  AddFaces(weave, full.faces);
  full.drag = material.drag;
  full.tearStretch = definition.tearStretch;
  SetRepulsion(blueprint, material.repulsion);
  full.contact = MakeContactParameters(material, squareMass, definition.spacing);
  FinishBlueprint(blueprint);
  return blueprint;
}

}  // namespace wobble::physics
