// The functions of wobble.h but for its last part, which is in rules.cpp: each checks its arguments, then asks the
// client library. Pointers that are not null are trusted to have what they say, everything else is not.
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/c/calls.h"
#include "protocol/limits.h"
#include "protocol/messages.h"
#include "protocol/text.h"
#include "protocol/transport/vestibule/keys.h"
#include "protocol/transport/vestibule/token.h"
#include "protocol/version.h"

namespace wobble::c {
namespace {

namespace vestibule = transport::vestibule;
using protocol::wire::ObstacleKind;
using vestibule::Credential;

static_assert(WOBBLE_PLANE == static_cast<int>(ObstacleKind::Plane) &&
              WOBBLE_BOX == static_cast<int>(ObstacleKind::Box) &&
              WOBBLE_SPHERE == static_cast<int>(ObstacleKind::Sphere) &&
              WOBBLE_CAPSULE == static_cast<int>(ObstacleKind::Capsule));
static_assert(WOBBLE_MAY_GRAB == protocol::kMayGrab && WOBBLE_MAY_CUT == protocol::kMayCut &&
              WOBBLE_MAY_PUSH == protocol::kMayPush && WOBBLE_MAY_BUILD == protocol::kMayBuild &&
              WOBBLE_MAY_SAY == protocol::kMaySay && WOBBLE_MAY_EMOTE == protocol::kMayEmote);
static_assert(WOBBLE_RANK_WATCHER == static_cast<int>(protocol::wire::Rank::Watcher) &&
              WOBBLE_RANK_OWNER == static_cast<int>(protocol::wire::Rank::MAX));

// Does something with a text of 1 to maxBytes, while the client plays.
template <typename Call>
wobble_result Tell(wobble_client* client, const char* text, std::size_t maxBytes, Call&& call) {
  if (client == nullptr || text == nullptr) return WOBBLE_NULL;
  const auto line = ReadText(text);
  if (!line || line->empty() || line->size() > maxBytes) return WOBBLE_BAD_VALUE;
  if (!client->player->IsPlaying()) return WOBBLE_NOT_PLAYING;
  return Guard([&] {
    call(std::string(*line));
    return WOBBLE_OK;
  });
}

// nullopt: the text cannot be one.
std::optional<Credential> ReadCredential(const char* text, Credential::Kind kind) {
  const auto line = ReadText(text);
  if (!line) return {};
  Credential credential;
  credential.kind = kind;
  if (kind == Credential::Kind::kPassword) {
    credential.bytes.assign(line->begin(), line->end());
  } else if (auto bytes = vestibule::ParseSecret(*line)) {
    credential.bytes = std::move(*bytes);
  }
  if (credential.bytes.empty() || credential.bytes.size() > vestibule::kMaxCredentialBytes) return {};
  return credential;
}

// Reads what is shown to the server, and the key that it must have. Returns false when that cannot be.
bool ReadAccess(const wobble_connect_options& given, transport::ConnectOptions& access) {
  const std::pair<const char*, Credential::Kind> secrets[] = {{given.password, Credential::Kind::kPassword},
                                                              {given.token, Credential::Kind::kToken},
                                                              {given.invite, Credential::Kind::kInvite}};
  for (const auto& [text, kind] : secrets) {
    if (text == nullptr) continue;
    auto credential = ReadCredential(text, kind);
    if (!credential || access.credential.kind != Credential::Kind::kNone) return false;
    access.credential = std::move(*credential);
  }
  if (given.server_key == nullptr) return true;
  const auto key = ReadText(given.server_key);
  access.serverKey = key ? vestibule::ParseKey(*key) : std::nullopt;
  return access.serverKey.has_value();
}

wobble_result Connect(const wobble_connect_options& given, double now, wobble_client*& made) {
  if ((given.flags & ~std::uint32_t{WOBBLE_SPECTATE | WOBBLE_NO_REJOIN | WOBBLE_NO_PREDICTION}) != 0)
    return WOBBLE_BAD_FLAGS;
  if (!IsTime(now)) return WOBBLE_BAD_TIME;
  if (given.address == nullptr) return WOBBLE_NULL;
  PlayerOptions options;
  options.client.spectator = (given.flags & WOBBLE_SPECTATE) != 0;
  options.client.predict = (given.flags & WOBBLE_NO_PREDICTION) == 0;
  options.rejoins = (given.flags & WOBBLE_NO_REJOIN) == 0;

  const auto name = ReadText(given.name);
  if (!name || name->size() > protocol::kMaxNameBytes) return WOBBLE_BAD_VALUE;
  if (!name->empty()) options.client.name = protocol::MakeLine(*name, protocol::kMaxNameBytes);
  if (!ReadAccess(given, options.access)) return WOBBLE_BAD_SECRET;

  const auto text = ReadText(given.address);
  std::string error;
  const auto address = text ? command::ParseAddress(std::string(*text), error) : std::nullopt;
  if (!address) return WOBBLE_BAD_ADDRESS;
  options.server = *address;
  auto player = Player::Connect(std::move(options), now);
  if (player == nullptr) return WOBBLE_BAD_ADDRESS;
  made = new wobble_client{.player = std::move(player), .frames = {}, .now = now};
  return WOBBLE_OK;
}

std::int32_t FindState(const Player& player) {
  switch (player.Lasting().ReadState()) {
    case client::LastingState::kJoining:
      return WOBBLE_JOINING;
    case client::LastingState::kPlaying:
      return player.IsPlaying() ? WOBBLE_PLAYING : WOBBLE_JOINING;
    case client::LastingState::kRejoining:
      return WOBBLE_REJOINING;
    case client::LastingState::kEnded:
      break;
  }
  return WOBBLE_ENDED;
}

wobble_status MakeStatus(const Player& player) {
  const protocol::WelcomeFields& welcome = player.Current().Welcome();
  return {
      .struct_size = 0,
      .state = FindState(player),
      .ended_unasked = player.Lasting().EndedUnasked() ? 1 : 0,
      .client_id = welcome.clientId,
      .own_body = welcome.ownBody,
      .hands = std::uint32_t{welcome.hands} & (WOBBLE_MAY_GRAB | WOBBLE_MAY_CUT | WOBBLE_MAY_PUSH | WOBBLE_MAY_BUILD),
      .reach = welcome.reach,
      .pace = static_cast<float>(player.Current().Pace()),
      .scene = welcome.scene.c_str(),
      .reason = player.Lasting().Reason().c_str(),
      .server_key = player.ServerKey().c_str(),
      .rank = static_cast<std::int32_t>(welcome.rank),
      .talk = welcome.talk,
      .description = welcome.description.c_str()};
}

std::optional<wobble_obstacle> FindObstacle(const client::Client& client, std::uint32_t index) {
  const auto& obstacles = client.Welcome().obstacles;
  if (index >= obstacles.size()) return {};
  const protocol::wire::Obstacle& from = obstacles[index];
  return wobble_obstacle{.struct_size = 0,
                         .kind = static_cast<std::int32_t>(from.kind()),
                         .a = {from.a().x(), from.a().y(), from.a().z()},
                         .b = {from.b().x(), from.b().y(), from.b().z()},
                         .radius = from.radius()};
}

// Nothing before all its heights have come.
std::optional<wobble_ground> FindGround(const client::Client& client, std::uint32_t index) {
  if (index >= client.Grounds().size()) return {};
  const client::Ground& from = client.Grounds()[index];
  if (from.heights.size() != static_cast<std::size_t>(from.columns) * static_cast<std::size_t>(from.rows)) return {};
  return wobble_ground{.struct_size = 0,
                       .columns = static_cast<std::uint32_t>(from.columns),
                       .rows = static_cast<std::uint32_t>(from.rows),
                       .corner = {from.corner.x, from.corner.y},
                       .cell_size = from.cellSize,
                       .heights = from.heights.data()};
}

wobble_statistics MakeStatistics(const wobble_client& client) {
  const client::Client& current = client.player->Current();
  const client::Statistics& from = current.ReadStatistics();
  return {.struct_size = 0,
          .rejoins = static_cast<std::uint32_t>(client.player->Lasting().CountRejoins()),
          .snapshots = from.snapshots,
          .bad_messages = from.badMessages + from.badSnapshots + from.badRecords,
          .bytes_received = from.bytesReceived,
          .stalls = from.stalls,
          .events_lost = client.player->CountLostEvents(),
          .join_seconds = from.joinSeconds,
          .loss_share = from.lossShare,
          .snapshot_age = from.snapshotAge,
          .input_to_snapshot = from.inputToSnapshot,
          .interpolation_delay = current.InterpolationDelay(),
          .server_time = current.ServerTime(client.now)};
}

const char* Describe(wobble_result result) {
  switch (result) {
    case WOBBLE_OK:
      return "all went well";
    case WOBBLE_NO_EVENT:
      return "there is no event at present";
    case WOBBLE_TOO_SMALL:
      return "an array of the frame is too small; its counts say what is needed";
    case WOBBLE_NULL:
      return "a pointer is NULL that must not be";
    case WOBBLE_BAD_SIZE:
      return "struct_size is less than the struct has ever had; set it to sizeof";
    case WOBBLE_BAD_FLAGS:
      return "a bit is set that has no meaning";
    case WOBBLE_BAD_VALUE:
      return "a number is not finite or out of its range, or a text is too long";
    case WOBBLE_BAD_TIME:
      return "now is not finite, too large, or earlier than in a call before";
    case WOBBLE_BAD_ADDRESS:
      return "the address is no HOST:PORT, or the host has no address";
    case WOBBLE_BAD_SECRET:
      return "the password, token, invite or server key is none, or more than one is given";
    case WOBBLE_NOT_PLAYING:
      return "only a client that plays can do that";
    case WOBBLE_BAD_INDEX:
      return "there is nothing at this index";
    case WOBBLE_NO_MEMORY:
      return "there is not enough memory";
    case WOBBLE_INTERNAL:
      return "a defect of the library";
    default:
      return "no result of this library";
  }
}

}  // namespace
}  // namespace wobble::c

using namespace wobble::c;
using wobble::protocol::kMaxBodyVertices;

const char* wobble_describe(wobble_result result) { return Describe(result); }
const char* wobble_version() { return wobble::kVersion; }

wobble_result wobble_connect(const wobble_connect_options* options, double now, wobble_client** client) {
  if (client == nullptr) return WOBBLE_NULL;
  *client = nullptr;
  if (const wobble_result bad = CheckStruct(options); bad != WOBBLE_OK) return bad;
  return Guard([&] { return Connect(Read(*options), now, *client); });
}

void wobble_destroy(wobble_client* client) { delete client; }

wobble_result wobble_update(wobble_client* client, double now) {
  return At(client, now, [&] {
    client->player->Update(now);
    return WOBBLE_OK;
  });
}

wobble_result wobble_leave(wobble_client* client, double now) {
  return At(client, now, [&] {
    client->player->Leave(now);
    return WOBBLE_OK;
  });
}

wobble_result wobble_read_status(const wobble_client* client, wobble_status* status) {
  return Answer(client, status, [&] { return MakeStatus(*client->player); });
}

wobble_result wobble_set_input(wobble_client* client, const wobble_input* input) {
  if (client == nullptr) return WOBBLE_NULL;
  if (const wobble_result bad = CheckStruct(input); bad != WOBBLE_OK) return bad;
  const wobble_input given = Read(*input);
  if ((given.buttons & ~std::uint32_t{WOBBLE_JUMP | WOBBLE_PUFF | WOBBLE_STIFFEN}) != 0) return WOBBLE_BAD_FLAGS;
  if (!(std::abs(given.move_x) <= 1 && std::abs(given.move_y) <= 1)) return WOBBLE_BAD_VALUE;  // also what is no number
  client->player->SetInput({.moveX = given.move_x,
                            .moveY = given.move_y,
                            .jump = (given.buttons & WOBBLE_JUMP) != 0,
                            .puff = (given.buttons & WOBBLE_PUFF) != 0,
                            .stiffen = (given.buttons & WOBBLE_STIFFEN) != 0});
  return WOBBLE_OK;
}

wobble_result wobble_set_hand(wobble_client* client, const wobble_hand* hand) {
  if (client == nullptr) return WOBBLE_NULL;
  std::optional<wobble::client::Hand> grip;
  if (hand != nullptr) {
    if (const wobble_result bad = CheckStruct(hand); bad != WOBBLE_OK) return bad;
    const wobble_hand given = Read(*hand);
    const auto target = ReadVector(given.target);
    if (!target || given.vertex >= kMaxBodyVertices) return WOBBLE_BAD_VALUE;
    grip = {given.body, static_cast<std::uint16_t>(given.vertex), *target};
  }
  if (!client->player->IsPlaying()) return WOBBLE_NOT_PLAYING;
  client->player->Current().SetHand(grip);
  return WOBBLE_OK;
}

wobble_result wobble_push(wobble_client* client, uint32_t body, uint32_t vertex, const float direction[3]) {
  if (client == nullptr || direction == nullptr) return WOBBLE_NULL;
  const auto along = ReadVector(direction);
  if (!along || (along->x == 0 && along->y == 0 && along->z == 0) || vertex >= kMaxBodyVertices) {
    return WOBBLE_BAD_VALUE;
  }
  if (!client->player->IsPlaying()) return WOBBLE_NOT_PLAYING;
  return Guard([&] {
    client->player->Current().Push(body, static_cast<std::uint16_t>(vertex), *along);
    return WOBBLE_OK;
  });
}

wobble_result wobble_cut(wobble_client* client, uint32_t body, const float eye[3], const float from[3],
                         const float to[3]) {
  if (client == nullptr || eye == nullptr || from == nullptr || to == nullptr) return WOBBLE_NULL;
  const auto first = ReadVector(eye), second = ReadVector(from), third = ReadVector(to);
  if (!first || !second || !third) return WOBBLE_BAD_VALUE;
  if (!client->player->IsPlaying()) return WOBBLE_NOT_PLAYING;
  return Guard([&] {
    client->player->Current().Cut(body, *first, *second, *third);
    return WOBBLE_OK;
  });
}

wobble_result wobble_say(wobble_client* client, const char* text) {
  return Tell(client, text, wobble::protocol::kMaxSaidBytes,
              [&](const std::string& line) { client->player->Current().Say(line); });
}

wobble_result wobble_emote(wobble_client* client, int32_t emote) {
  if (client == nullptr) return WOBBLE_NULL;
  if (emote < WOBBLE_WAVE || emote > WOBBLE_CHEER) return WOBBLE_BAD_VALUE;
  if (!client->player->IsPlaying()) return WOBBLE_NOT_PLAYING;
  return Guard([&] {
    client->player->Current().Emote(static_cast<wobble::protocol::wire::EmoteKind>(emote));
    return WOBBLE_OK;
  });
}

wobble_result wobble_rename(wobble_client* client, const char* name) {
  return Tell(client, name, wobble::protocol::kMaxNameBytes,
              [&](const std::string& line) { client->player->Rename(line); });
}

wobble_result wobble_sample(wobble_client* client, double now, wobble_frame* frame) {
  if (client == nullptr) return WOBBLE_NULL;
  if (frame != nullptr) {
    if (const wobble_result bad = CheckStruct(frame); bad != WOBBLE_OK) return bad;
  }
  return At(client, now, [&]() -> wobble_result {
    client->frames.Take(client->player->Current(), now);
    if (frame == nullptr) return WOBBLE_OK;
    wobble_frame known = Read(*frame);
    const bool fits = client->frames.CopyTo(known);
    Write(known, *frame);
    return fits ? WOBBLE_OK : WOBBLE_TOO_SMALL;
  });
}

wobble_result wobble_read_body(const wobble_client* client, uint32_t index, wobble_body* body) {
  return Answer(client, body, [&] { return client->frames.Find(index); });
}

wobble_result wobble_read_obstacle(const wobble_client* client, uint32_t index, wobble_obstacle* obstacle) {
  return Answer(client, obstacle, [&] { return FindObstacle(client->player->Current(), index); });
}

wobble_result wobble_read_ground(const wobble_client* client, uint32_t index, wobble_ground* ground) {
  return Answer(client, ground, [&] { return FindGround(client->player->Current(), index); });
}

wobble_result wobble_next_event(wobble_client* client, wobble_event* event) {
  if (client == nullptr) return WOBBLE_NULL;
  if (const wobble_result bad = CheckStruct(event); bad != WOBBLE_OK) return bad;
  const Event* taken = client->player->TakeEvent();
  if (taken == nullptr) return WOBBLE_NO_EVENT;
  Write(wobble_event{.struct_size = 0,
                     .kind = taken->kind,
                     .client_id = taken->clientId,
                     .body = taken->body,
                     .text = taken->text.c_str(),
                     .emote = taken->emote,
                     .reserved = 0},
        *event);
  return WOBBLE_OK;
}

wobble_result wobble_read_statistics(const wobble_client* client, wobble_statistics* statistics) {
  return Answer(client, statistics, [&] { return MakeStatistics(*client); });
}
