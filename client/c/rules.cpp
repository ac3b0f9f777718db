// The last part of wobble.h: building, tuning, scores and orders.
#include <cmath>
#include <optional>
#include <string>

#include "client/c/calls.h"
#include "protocol/limits.h"
#include "protocol/messages.h"

namespace wobble::c {
namespace {

namespace wire = protocol::wire;

static_assert(WOBBLE_ADD_PARTICLE == static_cast<int>(wire::BuildKind::AddParticle) &&
              WOBBLE_ADD_SPRING == static_cast<int>(wire::BuildKind::AddSpring) &&
              WOBBLE_SET_PARTICLE == static_cast<int>(wire::BuildKind::SetParticle) &&
              WOBBLE_SET_SPRING == static_cast<int>(wire::BuildKind::SetSpring) &&
              WOBBLE_REMOVE_PARTICLE == static_cast<int>(wire::BuildKind::RemoveParticle) &&
              WOBBLE_REMOVE_SPRING == static_cast<int>(wire::BuildKind::MAX));
static_assert(WOBBLE_TUNE_GRAVITY == static_cast<int>(wire::TuneKind::Gravity) &&
              WOBBLE_TUNE_STIFFNESS == static_cast<int>(wire::TuneKind::Stiffness) &&
              WOBBLE_TUNE_TIME_RATE == static_cast<int>(wire::TuneKind::TimeRate) &&
              WOBBLE_JUMP_AHEAD == static_cast<int>(wire::TuneKind::MAX));
static_assert(WOBBLE_MAY_TUNE_GRAVITY == protocol::kMayTuneGravity &&
              WOBBLE_MAY_TUNE_STIFFNESS == protocol::kMayTuneStiffness &&
              WOBBLE_MAY_TUNE_TIME == protocol::kMayTuneTime);
static_assert(WOBBLE_ROUND_PLAYING == static_cast<int>(wire::GamePhase::Playing) &&
              WOBBLE_MATCH_OVER == static_cast<int>(wire::GamePhase::MAX));

constexpr std::uint32_t kMayTune = WOBBLE_MAY_TUNE_GRAVITY | WOBBLE_MAY_TUNE_STIFFNESS | WOBBLE_MAY_TUNE_TIME;
constexpr std::uint32_t kMaxNumber = 0xFFFF;  // of a particle or spring

// Of the workshop's body as the last sample shows it; nullptr when there is none.
const client::Blueprint* FindWorkshop(const wobble_client& client) {
  const std::uint32_t body = client.player->Current().Welcome().workshop;
  return body == 0 ? nullptr : client.frames.FindBlueprint(body);
}

wobble_workshop MakeWorkshop(const wobble_client& client) {
  const client::Blueprint* blueprint = FindWorkshop(client);
  const auto count = [&](const auto& parts) { return static_cast<std::uint32_t>(parts.size()); };
  return {.struct_size = 0,
          .body = client.player->Current().Welcome().workshop,
          .particle_count = blueprint == nullptr ? 0 : count(blueprint->particles),
          .spring_count = blueprint == nullptr ? 0 : count(blueprint->springs)};
}

std::optional<wobble_particle> FindParticle(const wobble_client& client, std::uint32_t index) {
  const client::Blueprint* blueprint = FindWorkshop(client);
  if (blueprint == nullptr || index >= blueprint->particles.size()) return {};
  const wire::ParticleTag& from = blueprint->particles[index];
  return wobble_particle{.struct_size = 0,
                         .number = from.number(),
                         .owner = from.owner(),
                         .fixed = from.fixed() ? 1 : 0,
                         .mass = from.mass()};
}

std::optional<wobble_spring> FindSpring(const wobble_client& client, std::uint32_t index) {
  const client::Blueprint* blueprint = FindWorkshop(client);
  if (blueprint == nullptr || index >= blueprint->springs.size()) return {};
  const wire::SpringTag& from = blueprint->springs[index];
  const auto& ends = blueprint->edges[index];  // as many as springs: messages_check.cpp
  return wobble_spring{.struct_size = 0,
                       .number = from.number(),
                       .owner = from.owner(),
                       .ends = {ends[0], ends[1]},
                       .stiffness = from.stiffness(),
                       .damping = from.damping(),
                       .rest_length = from.rest_length()};
}

// nullopt: a value that no change can have. Ranges beyond that are the server's.
std::optional<protocol::BuildFields> ReadChange(const wobble_change& given) {
  const auto at = ReadVector(given.at);
  const bool isGood = given.kind >= WOBBLE_ADD_PARTICLE && given.kind <= WOBBLE_REMOVE_SPRING &&
                      given.a <= kMaxNumber && given.b <= kMaxNumber && at && std::isfinite(given.mass) &&
                      (given.fixed == 0 || given.fixed == 1) && std::isfinite(given.stiffness) &&
                      std::isfinite(given.damping) && std::isfinite(given.rest_length);
  if (!isGood) return {};
  return protocol::BuildFields{.kind = static_cast<wire::BuildKind>(given.kind),
                               .a = static_cast<std::uint16_t>(given.a),
                               .b = static_cast<std::uint16_t>(given.b),
                               .at = *at,
                               .mass = given.mass,
                               .fixed = given.fixed == 1,
                               .stiffness = given.stiffness,
                               .damping = given.damping,
                               .restLength = given.rest_length};
}

wobble_tuning MakeTuning(const client::Client& client) {
  const client::Tuning& from = client.ReadTuning();
  return {.struct_size = 0,
          .may = from.may & kMayTune,
          .gravity = {from.gravity.x, from.gravity.y, from.gravity.z},
          .stiffness = from.stiffness,
          .time_rate = from.timeRate};
}

wobble_scoreboard MakeScoreboard(const client::Client& client) {
  const client::Scoreboard& from = client.ReadScoreboard();
  const bool hasSides = from.sides.size() == 2;
  const auto first = hasSides ? from.sides[0] : wire::SideScore();
  const auto second = hasSides ? from.sides[1] : wire::SideScore();
  return {.struct_size = 0,
          .phase = static_cast<std::int32_t>(from.phase),
          .round = from.round,
          .seconds_left = from.secondsLeft,
          .points_to_win = from.pointsToWin,
          .winner = from.winner,
          .score_count = static_cast<std::uint32_t>(from.scores.size()),
          .rounds = from.rounds,
          .game = client.Welcome().game.c_str(),
          .winning_side = from.winningSide,
          .side_points = {first.points(), second.points()},
          .side_rounds = {first.rounds(), second.rounds()},
          .object = from.object,
          .bearer = from.bearer,
          .reserved = 0};
}

std::optional<wobble_score> FindScore(const client::Client& client, std::uint32_t index) {
  const client::Scoreboard& board = client.ReadScoreboard();
  const auto& scores = board.scores;
  if (index >= scores.size()) return {};
  const wire::Seat seat = index < board.seats.size() ? board.seats[index] : wire::Seat();
  return wobble_score{.struct_size = 0,
                      .client_id = scores[index].client_id(),
                      .points = scores[index].points(),
                      .rounds = scores[index].rounds(),
                      .side = seat.side(),
                      .ready = seat.ready() ? 1 : 0,
                      .bot = seat.bot() ? 1 : 0};
}

// Sends a command, where the client plays.
template <typename Send>
wobble_result Command(wobble_client& client, Send&& send) {
  if (!client.player->IsPlaying()) return WOBBLE_NOT_PLAYING;
  return Guard([&] {
    send(client.player->Current());
    return WOBBLE_OK;
  });
}

}  // namespace
}  // namespace wobble::c

using namespace wobble::c;

wobble_result wobble_read_workshop(const wobble_client* client, wobble_workshop* workshop) {
  return Answer(client, workshop, [&] { return std::optional(MakeWorkshop(*client)); });
}

wobble_result wobble_read_particle(const wobble_client* client, uint32_t index, wobble_particle* particle) {
  return Answer(client, particle, [&] { return FindParticle(*client, index); });
}

wobble_result wobble_read_spring(const wobble_client* client, uint32_t index, wobble_spring* spring) {
  return Answer(client, spring, [&] { return FindSpring(*client, index); });
}

wobble_result wobble_build(wobble_client* client, const wobble_change* change) {
  if (client == nullptr) return WOBBLE_NULL;
  if (const wobble_result bad = CheckStruct(change); bad != WOBBLE_OK) return bad;
  const auto fields = ReadChange(Read(*change));
  if (!fields) return WOBBLE_BAD_VALUE;
  return Command(*client, [&](wobble::client::Client& playing) { playing.Build(*fields); });
}

wobble_result wobble_read_tuning(const wobble_client* client, wobble_tuning* tuning) {
  return Answer(client, tuning, [&] { return std::optional(MakeTuning(client->player->Current())); });
}

wobble_result wobble_tune(wobble_client* client, int32_t kind, const float value[3]) {
  if (client == nullptr || value == nullptr) return WOBBLE_NULL;
  if (kind < WOBBLE_TUNE_GRAVITY || kind > WOBBLE_JUMP_AHEAD) return WOBBLE_BAD_VALUE;
  const auto wanted = ReadVector(value);
  if (!wanted) return WOBBLE_BAD_VALUE;
  return Command(*client, [&](wobble::client::Client& playing) {
    playing.Tune(static_cast<wobble::protocol::wire::TuneKind>(kind), *wanted);
  });
}

wobble_result wobble_read_scoreboard(const wobble_client* client, wobble_scoreboard* scoreboard) {
  return Answer(client, scoreboard, [&] { return std::optional(MakeScoreboard(client->player->Current())); });
}

wobble_result wobble_read_score(const wobble_client* client, uint32_t index, wobble_score* score) {
  return Answer(client, score, [&] { return FindScore(client->player->Current(), index); });
}

wobble_result wobble_order(wobble_client* client, const char* line) {
  if (client == nullptr || line == nullptr) return WOBBLE_NULL;
  const auto text = ReadText(line);
  if (!text || text->empty() || text->size() > wobble::protocol::kMaxOrderBytes) return WOBBLE_BAD_VALUE;
  return Command(*client, [&](wobble::client::Client& playing) { playing.Order(std::string(*text)); });
}
