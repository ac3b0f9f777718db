// The last step of every maker of blueprints: all that follows from a rest shape and its coefficients, computed once,
// and the choices that a scene makes for a whole kind of body (method, law of contact).
#pragma once

#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Adds `value` to the errors unless it is valid.
void CheckField(std::vector<FieldError>& errors, const char* field, double value, bool valid, const char* range);

// Fills everything that follows from `rest` and `full`: single precision, sizes, masses, volume, stability, topology.
// Vertices in `full.fixed` lose their inverse masses.
void FinishBlueprint(Blueprint& blueprint);
// The same without stability, for those who know it: the power iteration takes longer than all the rest.
void FinishBlueprintButStability(Blueprint& blueprint);

// How the body is stepped in lanes, from its coefficients and its grid.
void MakePlans(Blueprint& blueprint);

// Sets the method and makes what it needs; after FinishBlueprint.
void SetIntegrator(Blueprint& blueprint, Integrator integrator);

// What may be asked of `magnetic_strength`, N·m², and what it is unless it is asked for.
inline constexpr double kMinMagneticStrength = 1e-7;
inline constexpr double kMaxMagneticStrength = 100;
inline constexpr double kDefaultMagneticStrength = 1e-3;
// Sets the law and what follows from it; after FinishBlueprint. magneticStrength: K, for that law only.
void SetContactLaw(Blueprint& blueprint, ContactLaw law, double magneticStrength = kDefaultMagneticStrength);

// Whether the body by itself leaves half of the largest number of substeps, at 60 ticks a second, to what it touches,
// and needs no more than all of them on a rigid surface.
[[nodiscard]] bool IsSlowEnough(const Blueprint& blueprint);

}  // namespace wobble::physics
