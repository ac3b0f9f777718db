// The fields of all that is stored, in their order. A structured binding names every field of a type, so that a field
// that is added later and forgotten here does not compile. A change of what is stored needs a new kFormatVersion
// (block_file.h).
//
// Each function is for both directions: Archive is a Writer, and the value const, or it is a Reader.
#pragma once

#include <concepts>
#include <type_traits>

#include "server/play/playground_state.h"
#include "server/recording/archive.h"
#include "server/scenes/loader.h"

namespace wobble::recording {

template <>
inline constexpr auto kLast<physics::ContactPhase> = physics::ContactPhase::kAside;
template <>
inline constexpr auto kLast<physics::EdgePhase> = physics::EdgePhase::kTurned;
template <>
inline constexpr auto kLast<physics::SkinSide> = physics::SkinSide::kBack;
template <>
inline constexpr auto kLast<server::Match::Phase> = server::Match::Phase::kOver;
template <>
inline constexpr auto kLast<server::TuneCommand::Kind> = server::TuneCommand::Kind::kJump;
template <>
inline constexpr auto kLast<server::BuildCommand::Kind> = server::BuildCommand::Kind::kRemoveSpring;

// A value of this type, const or not.
template <class Value, class Type>
concept Is = std::same_as<std::remove_const_t<Value>, Type>;

}  // namespace wobble::recording

// In the types' own room, where calls by argument find them.
namespace wobble::physics {

using recording::Is;

template <class Archive, Is<Control> Value>
void Describe(Archive& archive, Value& value) {
  auto& [moveX, moveY, jump, puff, stiffen] = value;
  archive(moveX, moveY, jump, puff, stiffen);
}

template <class Archive, Is<ControlLimits> Value>
void Describe(Archive& archive, Value& value) {
  auto& [acceleration, speed, jumpSpeed, puffFactor, stiffenFactor] = value;
  archive(acceleration, speed, jumpSpeed, puffFactor, stiffenFactor);
}

template <class Archive, Is<StepHistory> Value>
void Describe(Archive& archive, Value& value) {
  StepHistory::Memory memory = value.Read();
  auto& [coefficients, next, error, substeps, ticksBelow] = memory;
  archive(coefficients, next, error, substeps, ticksBelow);
  if constexpr (!std::is_const_v<Value>) value = StepHistory(memory);
}

template <class Archive, class Value>
requires Is<Value, Contact<float>> || Is<Value, Contact<double>>
void Describe(Archive& archive, Value& value) {
  auto& [surface, vertex, touching, buried, anchor, slip, side] = value;
  archive(surface, vertex, touching, buried, anchor, slip, side);
}

template <class Archive, class Value>
requires Is<Value, BodyContact<float>> || Is<Value, BodyContact<double>>
void Describe(Archive& archive, Value& value) {
  auto& [vertex, face, phase, side, maxDepth, depth, leap, foot, slip, outward] = value;
  archive(vertex, face, phase, side, maxDepth, depth, leap, foot, slip, outward);
}

template <class Archive, class Value>
requires Is<Value, EdgeContact<float>> || Is<Value, EdgeContact<double>>
void Describe(Archive& archive, Value& value) {
  auto& [first, second, phase, depth, leap, s, t, normal, slip] = value;
  archive(first, second, phase, depth, leap, s, t, normal, slip);
}

// The range is of the tick.
template <class Archive, Is<CoreContact> Value>
void Describe(Archive& archive, Value& value) {
  auto& [seenApart, stiffness, range] = value;
  archive(seenApart, stiffness);
}

template <class Archive, class Value>
requires Is<Value, State<float>> || Is<Value, State<double>>
void Describe(Archive& archive, Value& value) {
  auto& [origin, positions, velocities, contacts, torn] = value;
  archive(origin, positions, velocities, contacts, torn);
}

template <class Archive, Is<Body> Value>
void Describe(Archive& archive, Value& value) {
  auto& [id, blueprint, state, control, limits, jumpHeld, touchesBody, gasFactor, stiffnessFactor, steps, selfRoom,
         selfAgitation, asleep, quietTicks, invertedTicks, lostTicks, tornTicks] = value;
  archive(id, blueprint, state, control, limits, jumpHeld, touchesBody, gasFactor, stiffnessFactor, steps, selfRoom,
          selfAgitation, asleep, quietTicks, invertedTicks, lostTicks, tornTicks);
}

// Places are found again from the bodies, and `met` is of the tick that made the pair.
template <class Archive, class Value>
requires Is<Value, BodyPair<float>> || Is<Value, BodyPair<double>>
void Describe(Archive& archive, Value& value) {
  auto& [first, second, places, sides, edges, core, gap, tangle, pulls, met] = value;
  archive(first, second, sides, edges, core, gap, tangle.ticks, tangle.untilLook);
}

template <class Archive, class Value>
requires Is<Value, PairsState<float>> || Is<Value, PairsState<double>>
void Describe(Archive& archive, Value& value) {
  auto& [awake, resting] = value;
  archive(awake, resting);
}

template <class Archive, Is<Box> Value>
void Describe(Archive& archive, Value& value) {
  auto& [low, high] = value;
  archive(low, high);
}

template <class Archive, Is<SleeperState> Value>
void Describe(Archive& archive, Value& value) {
  auto& [box, low, high, speed, agitation] = value;
  archive(box, low, high, speed, agitation);
}

template <class Archive, Is<Spring<double>> Value>
void Describe(Archive& archive, Value& value) {
  auto& [a, b, restLength, stiffness, damping] = value;
  archive(a, b, restLength, stiffness, damping);
}

template <class Archive, Is<GraphParts> Value>
void Describe(Archive& archive, Value& value) {
  auto& [rest, masses, fixed, springs] = value;
  archive(rest, masses, fixed, springs);
}

template <class Archive, Is<BlueprintRecipe> Value>
void Describe(Archive& archive, Value& value) {
  auto& [base, parts, torn] = value;
  archive(base, parts, torn);
}

template <class Archive, Is<SlotState> Value>
void Describe(Archive& archive, Value& value) {
  auto& [age, recipe] = value;
  archive(age, recipe);
}

template <class Archive, Is<Drive> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, vertices, force, gasFactor, wind, begin, end, period] = value;
  archive(body, vertices, force, gasFactor, wind, begin, end, period);
}

template <class Archive, Is<VertexForce<double>> Value>
void Describe(Archive& archive, Value& value) {
  auto& [vertex, force] = value;
  archive(vertex, force);
}

template <class Archive, Is<StepForce> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, force] = value;
  archive(body, force);
}

template <class Archive, Is<WorldState> Value>
void Describe(Archive& archive, Value& value) {
  auto& [tick, gravity, stiffnessFactor, nextId, slots, bodies, sleepers, tearing, drives, stepForces, pairs] = value;
  archive(tick, gravity, stiffnessFactor, nextId, slots, bodies, sleepers, tearing, drives, stepForces, pairs);
}

}  // namespace wobble::physics

namespace wobble::scenes {

using recording::Is;

template <class Archive, Is<SceneSource> Value>
void Describe(Archive& archive, Value& value) {
  auto& [name, text, meshes] = value;
  archive(name, text, meshes);
}

}  // namespace wobble::scenes

namespace wobble::server {

using recording::Is;

template <class Archive, Is<HandCommand> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, vertex, grip, target] = value;
  archive(body, vertex, grip, target);
}

template <class Archive, Is<ShoveCommand> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, vertex, direction] = value;
  archive(body, vertex, direction);
}

template <class Archive, Is<CutCommand> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, eye, from, to] = value;
  archive(body, eye, from, to);
}

template <class Archive, Is<TuneCommand> Value>
void Describe(Archive& archive, Value& value) {
  auto& [kind, amount] = value;
  archive(kind, amount);
}

template <class Archive, Is<BuildCommand> Value>
void Describe(Archive& archive, Value& value) {
  auto& [kind, a, b, at, mass, fixed, stiffness, damping, restLength] = value;
  archive(kind, a, b, at, mass, fixed, stiffness, damping, restLength);
}

template <class Archive, Is<JoinEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [client, isSpectator, name, isBot] = value;
  archive(client, isSpectator, name, isBot);
}

template <class Archive, Is<LeaveEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [client] = value;
  archive(client);
}

template <class Archive, Is<MoveEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [client, control, hand] = value;
  archive(client, control, hand);
}

template <class Archive, Is<ActEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [client, isHost, mayChangeAll, command] = value;
  archive(client, isHost, mayChangeAll, command);
}

template <class Archive, Is<ProtectEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [isProtected] = value;
  archive(isProtected);
}

template <class Archive, class Value>
requires Is<Value, ResetEntry> || Is<Value, RestartEntry>
void Describe(Archive& /*archive*/, Value& /*value*/) {}

template <class Archive, Is<MotionEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, positions, velocities] = value;
  archive(body, positions, velocities);
}

template <class Archive, Is<ReadyEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [client, isReady] = value;
  archive(client, isReady);
}

template <class Archive, Is<MatchEntry> Value>
void Describe(Archive& archive, Value& value) {
  auto& [rounds] = value;
  archive(rounds);
}

template <class Archive, Is<Playground::Player> Value>
void Describe(Archive& archive, Value& value) {
  auto& [body, name, control, hand] = value;
  archive(body, name, control, hand);
}

template <class Archive, Is<Hands::Grip> Value>
void Describe(Archive& archive, Value& value) {
  auto& [command, own, vertices, offsets] = value;
  archive(command, own, vertices, offsets);
}

template <class Archive, Is<Hands::Shove> Value>
void Describe(Archive& archive, Value& value) {
  auto& [command, own, vertices, ticksLeft, ticksToRest] = value;
  archive(command, own, vertices, ticksLeft, ticksToRest);
}

template <class Archive, Is<Hands::Memory> Value>
void Describe(Archive& archive, Value& value) {
  auto& [grips, shoves] = value;
  archive(grips, shoves);
}

template <class Archive, Is<PartTag> Value>
void Describe(Archive& archive, Value& value) {
  auto& [number, owner] = value;
  archive(number, owner);
}

template <class Archive, Is<Workshop::Memory> Value>
void Describe(Archive& archive, Value& value) {
  auto& [isProtected, draft, particles, springs, kept, fresh, shownParticles, shownSprings, changed, changes,
         sinceUpdate, lastNumber] = value;
  archive(isProtected, draft, particles, springs, kept, fresh, shownParticles, shownSprings, changed, changes,
          sinceUpdate, lastNumber);
}

template <class Archive, Is<Match::Standing> Value>
void Describe(Archive& archive, Value& value) {
  auto& [client, side, points, rounds, isReady, isBot] = value;
  archive(client, side, points, rounds, isReady, isBot);
}

template <class Archive, Is<Match::Side> Value>
void Describe(Archive& archive, Value& value) {
  auto& [points, rounds] = value;
  archive(points, rounds);
}

template <class Archive, Is<Match::Memory> Value>
void Describe(Archive& archive, Value& value) {
  auto& [players, sides, phase, round, rounds, matches, secondsLeft, playLeft, now, winner, winningSide, places,
         revision] = value;
  archive(players, sides, phase, round, rounds, matches, secondsLeft, playLeft, now, winner, winningSide, places,
          revision);
}

template <class Archive, Is<Sumo::Touch> Value>
void Describe(Archive& archive, Value& value) {
  auto& [by, at] = value;
  archive(by, at);
}

template <class Archive, Is<Sumo> Value>
void Describe(Archive& archive, Value& value) {
  auto& [touches] = value;
  archive(touches);
}

template <class Archive, Is<Goals> Value>
void Describe(Archive& archive, Value& value) {
  auto& [touchedBy] = value;
  archive(touchedBy);
}

template <class Archive, Is<Crown> Value>
void Describe(Archive& archive, Value& value) {
  auto& [bearer, loser, since, worn, vertex, grip, lift] = value;
  archive(bearer, loser, since, worn, vertex, grip, lift);
}

template <class Archive, Is<Game::Memory> Value>
void Describe(Archive& archive, Value& value) {
  auto& [match, rules] = value;
  archive(match, rules);
}

template <class Archive, Is<PlaygroundState> Value>
void Describe(Archive& archive, Value& value) {
  auto& [world, players, hands, gravity, stiffness, workshop, game] = value;
  archive(world, players, hands, gravity, stiffness, workshop, game);
}

}  // namespace wobble::server
