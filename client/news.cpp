#include "client/news.h"

namespace wobble::client {
namespace {

Tuning ReadTuning(const wire::Tuning& source) {
  const wire::Vec3& gravity = *source.gravity();
  return {.gravity = {gravity.x(), gravity.y(), gravity.z()},
          .stiffness = source.stiffness(),
          .timeRate = source.time_rate(),
          .may = source.may()};
}

Scoreboard ReadScoreboard(const wire::Scoreboard& source) {
  Scoreboard board{.phase = source.phase(),
                   .round = source.round(),
                   .secondsLeft = source.seconds_left(),
                   .pointsToWin = source.points_to_win(),
                   .winner = source.winner(),
                   .rounds = source.rounds(),
                   .winningSide = source.winning_side(),
                   .object = source.object(),
                   .bearer = source.bearer()};
  for (const wire::Score* score : *source.scores()) board.scores.push_back(*score);
  if (source.seats() != nullptr) {
    for (const wire::Seat* seat : *source.seats()) board.seats.push_back(*seat);
  }
  board.seats.resize(board.scores.size());
  if (source.sides() != nullptr) {
    for (const wire::SideScore* side : *source.sides()) board.sides.push_back(*side);
  }
  return board;
}

protocol::ForceField ReadField(const wire::ForceSet& source) {
  protocol::ForceField field{source.kind(), {}};
  const float step = source.scale() / protocol::kForceSteps;
  const auto& values = *source.values();
  for (flatbuffers::uoffset_t i = 0; i + 2 < values.size(); i += 3) {
    const auto read = [&](flatbuffers::uoffset_t at) { return static_cast<float>(values[at]) * step; };
    field.values.push_back({read(i), read(i + 1), read(i + 2)});
  }
  return field;
}

Forces ReadForces(const wire::Forces& source) {
  Forces forces{.body = source.body(), .tick = source.tick(), .stride = source.stride(), .fields = {}};
  for (const wire::ForceSet* set : *source.sets()) forces.fields.push_back(ReadField(*set));
  return forces;
}

}  // namespace

bool News::Take(const wire::ServerMessage& message) {
  if (const auto* fields = message.body_as_Tuning()) {
    tuning = ReadTuning(*fields);
  } else if (const auto* board = message.body_as_Scoreboard()) {
    scoreboard = ReadScoreboard(*board);
  } else if (const auto* fresh = message.body_as_Forces()) {
    forces = ReadForces(*fresh);
  } else {
    return false;
  }
  return true;
}

}  // namespace wobble::client
