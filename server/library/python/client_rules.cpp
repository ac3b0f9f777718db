// What a player does beside moving: talk, orders, the score, tuning and building, as the last part of client/wobble.h
// has them. What the server keeps is read in one turn, so that the parts of an answer belong together.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "server/library/python/client.h"

namespace wobble::python {
namespace {

struct Scoreboard {
  wobble_scoreboard read{};
  std::string game;
  std::vector<wobble_score> scores;
};
struct Workshop {
  std::uint32_t body = 0;
  std::vector<wobble_particle> particles;
  std::vector<wobble_spring> springs;
};

constexpr const char* kEmotes[] = {"wave", "laugh", "love", "wow", "sad", "cheer"};
constexpr const char* kPhases[] = {"playing", "won", "lobby", "kick-off", "golden", "over"};
constexpr const char* kTunings[] = {"gravity", "stiffness", "time"};
static_assert(std::size(kEmotes) == WOBBLE_CHEER + 1 && std::size(kPhases) == WOBBLE_MATCH_OVER + 1 &&
              WOBBLE_MAY_TUNE_TIME == 1 << (std::size(kTunings) - 1));

// Reads what has an index, until there is no more.
template <typename Struct, typename Read>
std::vector<Struct> ReadAll(const Read& read, const wobble_client* client) {
  std::vector<Struct> all;
  for (auto next = MakeStruct<Struct>(); read(client, static_cast<std::uint32_t>(all.size()), &next) == WOBBLE_OK;) {
    all.push_back(next);
  }
  return all;
}

// C ends a text at its first zero byte, and would send what is before.
template <typename Send>
void Tell(Player& player, const char* what, const std::string& text, const Send& send) {
  if (text.find('\0') != std::string::npos) throw py::value_error(std::string(what) + ": a zero byte is in the text");
  Ask(player, what, [&](wobble_client* client) { return send(client, text.c_str()); });
}

void Emote(Player& player, const std::string& sign) {
  for (std::size_t i = 0; i < std::size(kEmotes); ++i) {
    if (sign != kEmotes[i]) continue;
    return Ask(player, "emote",
               [&](wobble_client* asked) { return wobble_emote(asked, static_cast<std::int32_t>(i)); });
  }
  throw py::value_error("emote: sign = '" + sign + "': must be wave, laugh, love, wow, sad or cheer");
}

std::optional<Scoreboard> ReadScoreboard(Player& player) {
  Scoreboard board{MakeStruct<wobble_scoreboard>(), {}, {}};
  Ask(player, "scoreboard", [&](wobble_client* client) {
    const auto result = wobble_read_scoreboard(client, &board.read);
    if (result < 0) return result;
    board.game = board.read.game;
    board.scores = ReadAll<wobble_score>(wobble_read_score, client);
    return result;
  });
  if (board.game.empty()) return {};
  return board;
}

wobble_tuning ReadTuning(Player& player) {
  auto tuning = MakeStruct<wobble_tuning>();
  Ask(player, "tuning", [&](wobble_client* client) { return wobble_read_tuning(client, &tuning); });
  return tuning;
}

void SendTuning(Player& player, const char* what, std::int32_t kind, const std::vector<float>& value) {
  Ask(player, what, [&](wobble_client* client) { return wobble_tune(client, kind, value.data()); });
}

// All is checked before anything is sent.
void Tune(Player& player, const std::optional<Numbers>& gravity, std::optional<float> stiffness,
          std::optional<float> timeRate) {
  std::vector<std::pair<std::int32_t, std::vector<float>>> wanted;
  if (gravity) wanted.emplace_back(WOBBLE_TUNE_GRAVITY, ReadFloats("gravity", *gravity));
  if (stiffness) wanted.push_back({WOBBLE_TUNE_STIFFNESS, {*stiffness, 0, 0}});
  if (timeRate) wanted.push_back({WOBBLE_TUNE_TIME_RATE, {*timeRate, 0, 0}});
  if (wanted.empty()) throw py::value_error("tune: gravity, stiffness or time_rate must be given");
  for (const auto& [kind, value] : wanted) {
    if (!std::isfinite(value[0])) throw py::value_error("tune: a number is not finite");
  }
  for (const auto& [kind, value] : wanted) SendTuning(player, "tune", kind, value);
}

std::optional<Workshop> ReadWorkshop(Player& player) {
  Workshop workshop;
  Ask(player, "workshop", [&](wobble_client* client) {
    auto read = MakeStruct<wobble_workshop>();
    const auto result = wobble_read_workshop(client, &read);
    workshop.body = read.body;
    workshop.particles = ReadAll<wobble_particle>(wobble_read_particle, client);
    workshop.springs = ReadAll<wobble_spring>(wobble_read_spring, client);
    return result;
  });
  if (workshop.body == 0) return {};
  return workshop;
}

wobble_change MakeChange(std::int32_t kind, std::uint32_t a = 0, std::uint32_t b = 0) {
  auto change = MakeStruct<wobble_change>();
  change.kind = kind;
  change.a = a;
  change.b = b;
  return change;
}

void Build(Player& player, const char* what, const wobble_change& change) {
  Ask(player, what, [&](wobble_client* client) { return wobble_build(client, &change); });
}

void BuildParticle(Player& player, const char* what, wobble_change change, float mass, bool fixed) {
  change.mass = mass;
  change.fixed = fixed ? 1 : 0;
  Build(player, what, change);
}

void BuildSpring(Player& player, const char* what, wobble_change change, float stiffness, float damping,
                 float restLength) {
  change.stiffness = stiffness;
  change.damping = damping;
  change.rest_length = restLength;
  Build(player, what, change);
}

void AddParticle(Player& player, const Numbers& at, float mass, bool fixed) {
  auto change = MakeChange(WOBBLE_ADD_PARTICLE);
  std::ranges::copy(ReadFloats("at", at), change.at);
  BuildParticle(player, "add_particle", change, mass, fixed);
}

void SetParticle(Player& player, std::uint32_t number, float mass, bool fixed) {
  BuildParticle(player, "set_particle", MakeChange(WOBBLE_SET_PARTICLE, number), mass, fixed);
}

void AddSpring(Player& player, std::uint32_t a, std::uint32_t b, float stiffness, float damping, float restLength) {
  BuildSpring(player, "add_spring", MakeChange(WOBBLE_ADD_SPRING, a, b), stiffness, damping, restLength);
}

void SetSpring(Player& player, std::uint32_t number, float stiffness, float damping, float restLength) {
  BuildSpring(player, "set_spring", MakeChange(WOBBLE_SET_SPRING, number), stiffness, damping, restLength);
}

void RemoveParticle(Player& player, std::uint32_t number) {
  Build(player, "remove_particle", MakeChange(WOBBLE_REMOVE_PARTICLE, number));
}

void RemoveSpring(Player& player, std::uint32_t number) {
  Build(player, "remove_spring", MakeChange(WOBBLE_REMOVE_SPRING, number));
}

void DefineScores(py::module_& module) {
  py::class_<wobble_score>(module, "Score", "A player's place in a Scoreboard.")
      .def_readonly("client_id", &wobble_score::client_id, "As in events.")
      .def_readonly("points", &wobble_score::points, "In this round.")
      .def_readonly("rounds", &wobble_score::rounds, "That the player has won.")
      .def_readonly("side", &wobble_score::side, "1 or 2; 0: the game has none.")
      .def_property_readonly(
          "is_ready", [](const wobble_score& score) { return score.ready != 0; }, "For the match.")
      .def_property_readonly(
          "is_bot", [](const wobble_score& score) { return score.bot != 0; }, "No person plays.");

  const auto pair = [](const std::uint32_t(&of)[2]) { return std::pair(of[0], of[1]); };
  py::class_<Scoreboard> board(module, "Scoreboard", "How a scene's game stands.");
  board.def_readonly("game", &Scoreboard::game, "sumo, goals or crown; others may come.")
      .def_property_readonly(
          "phase", [](const Scoreboard& self) { return NameAt(kPhases, self.read.phase); },
          "lobby, kick-off, playing, golden (the next point wins), won or over.")
      .def_property_readonly(
          "side_points", [pair](const Scoreboard& self) { return pair(self.read.side_points); },
          "Of sides 1 and 2, in this round; 0 where there are none.")
      .def_property_readonly(
          "side_rounds", [pair](const Scoreboard& self) { return pair(self.read.side_rounds); }, "That they have won.")
      .def_readonly("scores", &Scoreboard::scores, "Of all players, the best first.");
  const auto define = [&](const char* name, std::uint32_t wobble_scoreboard::*field, const char* document) {
    board.def_property_readonly(
        name, [field](const Scoreboard& self) { return self.read.*field; }, document);
  };
  define("round", &wobble_scoreboard::round, "From 1.");
  define("rounds", &wobble_scoreboard::rounds, "That make a match; 0: it never ends.");
  define("seconds_left", &wobble_scoreboard::seconds_left, "Of the phase.");
  define("points_to_win", &wobble_scoreboard::points_to_win, "A round at once.");
  define("winner", &wobble_scoreboard::winner, "client_id of the last round's, or the match's; 0: nobody.");
  define("winning_side", &wobble_scoreboard::winning_side, "1 or 2, where there are sides; 0: none.");
  define("object", &wobble_scoreboard::object, "Body of the ball or the crown; 0: none.");
  define("bearer", &wobble_scoreboard::bearer, "client_id of who wears the crown; 0: nobody.");
}

void DefineTuning(py::module_& module) {
  py::class_<wobble_tuning>(module, "Tuning", "What holds for everybody in the world.")
      .def_property_readonly(
          "may", [](const wobble_tuning& tuning) { return NameBits(kTunings, tuning.may); },
          "What this player may tune: gravity, stiffness, time.")
      .def_property_readonly(
          "gravity", [](const wobble_tuning& tuning) { return py::array_t<float>(3, tuning.gravity); }, "m/s².")
      .def_readonly("stiffness", &wobble_tuning::stiffness, "Times every spring's stiffness and damping.")
      .def_readonly("time_rate", &wobble_tuning::time_rate, "Seconds of the world a second.");
}

void DefineWorkshop(py::module_& module) {
  py::class_<wobble_particle>(module, "Particle", "Of a Workshop.")
      .def_readonly("number", &wobble_particle::number, "Its own for as long as it is there.")
      .def_readonly("owner", &wobble_particle::owner, "client_id of the player who has built it; 0: the scene.")
      .def_readonly("mass", &wobble_particle::mass, "kg.")
      .def_property_readonly(
          "is_fixed", [](const wobble_particle& particle) { return particle.fixed != 0; }, "Stays where it is.");
  py::class_<wobble_spring>(module, "Spring", "Of a Workshop.")
      .def_readonly("number", &wobble_spring::number, "Its own for as long as it is there.")
      .def_readonly("owner", &wobble_spring::owner, "client_id of the player who has built it; 0: the scene.")
      .def_property_readonly(
          "ends", [](const wobble_spring& spring) { return std::pair(spring.ends[0], spring.ends[1]); },
          "Indices in the workshop's particles.")
      .def_readonly("stiffness", &wobble_spring::stiffness, "N/m.")
      .def_readonly("damping", &wobble_spring::damping, "N s/m.")
      .def_readonly("rest_length", &wobble_spring::rest_length, "m.");
  py::class_<Workshop>(module, "Workshop", "The body that players build together, as the last sample shows it.")
      .def_readonly("body", &Workshop::body, "Its number.")
      .def_readonly("particles", &Workshop::particles,
                    "In the order of the body's positions; none before a sample has the body.")
      .def_readonly("springs", &Workshop::springs);
}

void DefineBuilding(py::class_<Player>& client) {
  const auto number = py::arg("number");
  const auto mass = py::arg("mass") = 1, stiffness = py::arg("stiffness") = 100, damping = py::arg("damping") = 1,
             fixed = py::arg("fixed") = false, restLength = py::arg("rest_length") = 0;
  client.def_property_readonly("workshop", &ReadWorkshop, "What players build together; None: the scene has none.");
  client.def("add_particle", &AddParticle, py::arg("at"), py::kw_only(), mass, fixed,
             "Adds one to the workshop. at: m, world; mass: kg; fixed: stays where it is.");
  client.def("add_spring", &AddSpring, py::arg("a"), py::arg("b"), py::kw_only(), stiffness, damping, restLength,
             "Joins two particles, by their numbers. N/m, N s/m, m; rest_length 0: as far as they are apart.");
  client.def("set_particle", &SetParticle, number, py::kw_only(), py::arg("mass"), fixed, "Changes one.");
  client.def("set_spring", &SetSpring, number, py::kw_only(), py::arg("stiffness"), py::arg("damping"), restLength,
             "Changes one. rest_length 0: as far as its ends are apart.");
  client.def("remove_particle", &RemoveParticle, number, "Removes one, and the springs at it.");
  client.def("remove_spring", &RemoveSpring, number, "Removes one.");
}

}  // namespace

const char* NameEmote(std::int32_t emote) { return NameAt(kEmotes, emote); }

void DefineRules(py::module_& module, py::class_<Player>& client) {
  DefineScores(module);
  DefineTuning(module);
  DefineWorkshop(module);
  client.def(
      "say", [](Player& self, const std::string& text) { Tell(self, "say", text, wobble_say); }, py::arg("text"),
      "Says a line to everybody, of 1 to 200 bytes: one a second, and four at once.");
  client.def("emote", &Emote, py::arg("sign"),
             "Shows a sign over the own body: wave, laugh, love, wow, sad or cheer. It counts as a line does.");
  client.def(
      "rename", [](Player& self, const std::string& name) { Tell(self, "rename", name, wobble_rename); },
      py::arg("name"), "Another name, of 1 to 32 bytes, also for returns. An event tells when it is in force.");
  client.def(
      "order", [](Player& self, const std::string& line) { Tell(self, "order", line, wobble_order); }, py::arg("line"),
      "A line to the administration, of 1 to 200 bytes, such as a player's \"ready\" in a game's lobby or an owner's\n"
      "\"kick 7\". The answer comes as notices.");
  client.def_property_readonly("scoreboard", &ReadScoreboard, "How the game stands; None: the scene has none.");
  client.def_property_readonly("tuning", &ReadTuning, "What holds for everybody in the world, and may be changed.");
  client.def("tune", &Tune, py::kw_only(), py::arg("gravity") = py::none(), py::arg("stiffness") = py::none(),
             py::arg("time_rate") = py::none(), "Changes what is given, in the units of `tuning`.");
  client.def(
      "jump_ahead",
      [](Player& self, float seconds) {
        SendTuning(self, "jump_ahead", WOBBLE_JUMP_AHEAD, {seconds, 0, 0});
      },
      py::arg("seconds"), "Of the world, played as fast as the server can.");
  DefineBuilding(client);
}

}  // namespace wobble::python
