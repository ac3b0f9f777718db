// The last step of every maker of blueprints: computes, once, all that follows from a rest shape and its coefficients,
// and sets what a scene chooses for a kind of body (integration method, contact law).
#pragma once

#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Adds an error that names the field, its value and its range, unless `valid`.
void CheckField(std::vector<FieldError>& errors, const char* field, double value, bool valid, const char* range);

// Fills in everything that follows from `rest` and `full`: single precision, sizes, masses, volume, stability,
// topology, plans. Moves the rest shape to its centre of mass, and sets the inverse masses of vertices in `full.fixed`
// to 0.
void FinishBlueprint(Blueprint& blueprint);
// The same without stability, for callers that know it: its power iteration takes longer than all the rest.
void FinishBlueprintButStability(Blueprint& blueprint);
// The same for a rest shape that has been moved to its centre of mass before: to move it again would change its last
// bits.
void FinishCentredBlueprint(Blueprint& blueprint);

// Makes the plans by which the body is stepped in lanes, from its coefficients and its grid.
void MakePlans(Blueprint& blueprint);

// Sets the integration method and makes what it needs. To be called after FinishBlueprint. Not for bodies with
// tetrahedra or hinges: implicit Euler and position Verlet, which know springs only.
void SetIntegrator(Blueprint& blueprint, Integrator integrator);

// Sets the cells of a lattice, in both precisions. To be called after FinishBlueprint.
void SetCells(Blueprint& blueprint, Cells<double> cells);

// Makes the rest shape what the body recovers to, in both precisions. To be called after FinishBlueprint and SetCells.
// afterInsideOut: of ShapeAim.
void SetAim(Blueprint& blueprint, bool afterInsideOut = false);

// Range and default of `magnetic_strength`, N·m².
inline constexpr double kMinMagneticStrength = 1e-7;
inline constexpr double kMaxMagneticStrength = 100;
inline constexpr double kDefaultMagneticStrength = 1e-3;
// Sets the contact law and what follows from it. To be called after FinishBlueprint. magneticStrength: K, N·m², of the
// magnetic law; the others ignore it.
void SetContactLaw(Blueprint& blueprint, ContactLaw law, double magneticStrength = kDefaultMagneticStrength);

// Whether, at 60 ticks a second, the body alone needs at most half of kMaxSubsteps, which leaves the other half to what
// it touches, and at most kMaxSubsteps on a rigid surface.
[[nodiscard]] bool IsSlowEnough(const Blueprint& blueprint);

}  // namespace wobble::physics
