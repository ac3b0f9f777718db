// Client: a player or spectator of a server, over client/wobble.h.
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "client/wobble.h"
#include "server/library/python/client.h"

namespace wobble::python {
namespace {

// A body of a frame.
struct Shown {
  wobble_body body{};
  std::string blueprint;
  py::array positions;
  py::array normals;
  py::array faces;
};
struct Frame {
  py::array positions;
  py::array normals;
  py::array faces;
  std::vector<Shown> bodies;
};
struct Event {
  std::string kind;
  wobble_event event{};
  std::string text;
};

using Seconds = std::optional<double>;

double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
// Goes on from the last time that was given, so that with and without `now` it never goes back.
double ReadTime(Player& player, const Seconds& now) {
  if (now && std::isfinite(*now)) player.ahead = *now - ReadClock();
  return now ? *now : ReadClock() + player.ahead;
}

const char* Text(const std::optional<std::string>& text) { return text ? text->c_str() : nullptr; }

std::unique_ptr<Player> Connect(const std::string& address, const std::optional<std::string>& name,
                                const std::optional<std::string>& password, const std::optional<std::string>& token,
                                const std::optional<std::string>& invite, const std::optional<std::string>& serverKey,
                                bool spectate, bool rejoin, bool predict, const Seconds& now) {
  auto options = MakeStruct<wobble_connect_options>();
  options.flags =
      (spectate ? WOBBLE_SPECTATE : 0) | (rejoin ? 0 : WOBBLE_NO_REJOIN) | (predict ? 0 : WOBBLE_NO_PREDICTION);
  options.address = address.c_str();
  options.name = Text(name);
  options.password = Text(password);
  options.token = Text(token);
  options.invite = Text(invite);
  options.server_key = Text(serverKey);
  auto player = std::make_unique<Player>();
  wobble_client* made = nullptr;
  const double begin = ReadTime(*player, now);
  const auto result = TakeTurn(player->turn, [&] { return wobble_connect(&options, begin, &made); });
  player->client.reset(made);
  Check(result, "Client");
  return player;
}

void Update(Player& player, const Seconds& now) {
  Ask(player, "update", [time = ReadTime(player, now)](wobble_client* client) { return wobble_update(client, time); });
}

wobble_status ReadStatus(Player& player) {
  auto status = MakeStruct<wobble_status>();
  Ask(player, "status", [&](wobble_client* client) { return wobble_read_status(client, &status); });
  return status;
}

// A text of the status, copied before the next call.
std::string ReadText(Player& player, const char* wobble_status::*text) {
  auto status = MakeStruct<wobble_status>();
  std::string copy;
  Ask(player, "status", [&](wobble_client* client) {
    const auto result = wobble_read_status(client, &status);
    if (result >= 0) copy = status.*text;
    return result;
  });
  return copy;
}

constexpr const char* kStates[] = {"joining", "playing", "rejoining", "ended"};
constexpr const char* kHands[] = {"grab", "cut", "push", "build"};
constexpr const char* kTalk[] = {"say", "emote"};
constexpr const char* kRanks[] = {"watcher", "player", "moderator", "owner"};
constexpr const char* kEvents[] = {"join",      "leave", "respawn", "body_removed", "fall", "notice",
                                   "new_world", "said",  "emoted",  "renamed",      "goal", "crown"};
static_assert(std::size(kStates) == WOBBLE_ENDED + 1 && WOBBLE_MAY_BUILD == 1 << (std::size(kHands) - 1) &&
              WOBBLE_MAY_EMOTE == 1 << (std::size(kTalk) - 1) && std::size(kRanks) == WOBBLE_RANK_OWNER + 1 &&
              std::size(kEvents) == WOBBLE_CROWN + 1);

// Says goodbye and waits until the server knows, 5 s at most, as wobble_leave promises.
void Leave(Player& player) {
  for (int i = 0; i < 1000; ++i) {
    const bool isFirst = i == 0;
    Ask(player, "leave", [&](wobble_client* client) {
      const double now = ReadTime(player, {});
      const auto result = isFirst ? wobble_leave(client, now) : WOBBLE_OK;
      return result < 0 ? result : wobble_update(client, now);
    });
    if (ReadStatus(player).state == WOBBLE_ENDED) return;
    const py::gil_scoped_release released;
    std::this_thread::sleep_for(std::chrono::milliseconds(6));
  }
}

void SetInput(Player& player, const Numbers& move, bool jump, bool puff, bool stiffen) {
  const std::vector<float> share = ReadFloats("move", move, 2);
  auto input = MakeStruct<wobble_input>();
  input.buttons = (jump ? WOBBLE_JUMP : 0) | (puff ? WOBBLE_PUFF : 0) | (stiffen ? WOBBLE_STIFFEN : 0);
  input.move_x = share[0];
  input.move_y = share[1];
  Ask(player, "set_input", [&](wobble_client* client) { return wobble_set_input(client, &input); });
}

void Grab(Player& player, std::uint32_t body, std::uint32_t vertex, const Numbers& target) {
  const std::vector<float> place = ReadFloats("target", target);
  auto hand = MakeStruct<wobble_hand>();
  hand.body = body;
  hand.vertex = vertex;
  std::copy_n(place.data(), 3, hand.target);
  Ask(player, "grab", [&](wobble_client* client) { return wobble_set_hand(client, &hand); });
}

void Push(Player& player, std::uint32_t body, std::uint32_t vertex, const Numbers& direction) {
  const std::vector<float> along = ReadFloats("direction", direction);
  Ask(player, "push", [&](wobble_client* client) { return wobble_push(client, body, vertex, along.data()); });
}

void Cut(Player& player, std::uint32_t body, const Numbers& eye, const Numbers& from, const Numbers& to) {
  const std::vector<float> a = ReadFloats("eye", eye), b = ReadFloats("start", from), c = ReadFloats("end", to);
  Ask(player, "cut", [&](wobble_client* client) { return wobble_cut(client, body, a.data(), b.data(), c.data()); });
}

template <typename Number>
py::array Slice(const py::array& rows, Number begin, Number count) {
  return rows[py::slice(py::ssize_t{begin}, py::ssize_t{begin} + py::ssize_t{count}, 1)];
}

// The library writes into the frame's arrays. They are as large as the last sample, and larger when that is not enough.
Frame Sample(Player& player, const Seconds& now) {
  const double time = ReadTime(player, now);
  auto taken = MakeStruct<wobble_frame>();
  Frame frame;
  std::vector<wobble_body> bodies;
  std::vector<std::string> names;
  for (wobble_result result = WOBBLE_TOO_SMALL; result == WOBBLE_TOO_SMALL;) {
    taken.vertex_capacity = player.vertices;
    taken.index_capacity = player.indices;
    py::array_t<float> positions({py::ssize_t{taken.vertex_capacity}, py::ssize_t{3}});
    py::array_t<float> normals({py::ssize_t{taken.vertex_capacity}, py::ssize_t{3}});
    py::array_t<std::uint32_t> faces({py::ssize_t{taken.index_capacity / 3}, py::ssize_t{3}});
    taken.positions = positions.mutable_data();
    taken.normals = normals.mutable_data();
    taken.indices = faces.mutable_data();
    Ask(player, "sample", [&](wobble_client* client) {
      result = wobble_sample(client, time, &taken);
      bodies.assign(result == WOBBLE_OK ? taken.body_count : 0, MakeStruct<wobble_body>());
      names.clear();
      for (std::uint32_t i = 0; i < bodies.size(); ++i) {
        wobble_read_body(client, i, &bodies[i]);
        names.emplace_back(bodies[i].blueprint);
      }
      return result;
    });
    player.vertices = taken.vertex_count;
    player.indices = taken.index_count;
    frame.positions = Slice(positions, 0U, taken.vertex_count);
    frame.normals = Slice(normals, 0U, taken.vertex_count);
    frame.faces = Slice(faces, 0U, taken.index_count / 3);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const wobble_body& body = bodies[i];
    frame.bodies.push_back({body, names[i], Slice(frame.positions, body.first_vertex, body.vertex_count),
                            Slice(frame.normals, body.first_vertex, body.vertex_count),
                            Slice(frame.faces, body.first_index / 3, body.face_count)});
  }
  return frame;
}

std::vector<Event> TakeEvents(Player& player) {
  std::vector<Event> events;
  Ask(player, "events", [&](wobble_client* client) {
    auto event = MakeStruct<wobble_event>();
    wobble_result result = WOBBLE_OK;
    while ((result = wobble_next_event(client, &event)) == WOBBLE_OK) {
      events.push_back({NameAt(kEvents, event.kind), event, event.text});
    }
    return result;
  });
  return events;
}

py::dict ReadStatistics(Player& player) {
  auto read = MakeStruct<wobble_statistics>();
  Ask(player, "statistics", [&](wobble_client* client) { return wobble_read_statistics(client, &read); });
  py::dict named;
  named["rejoins"] = read.rejoins;
  named["snapshots"] = read.snapshots;
  named["bad_messages"] = read.bad_messages;
  named["bytes_received"] = read.bytes_received;
  named["stalls"] = read.stalls;
  named["events_lost"] = read.events_lost;
  named["join_seconds"] = read.join_seconds;
  named["loss_share"] = read.loss_share;
  named["snapshot_age"] = read.snapshot_age;
  named["input_to_snapshot"] = read.input_to_snapshot;
  named["interpolation_delay"] = read.interpolation_delay;
  named["server_time"] = read.server_time;
  return named;
}

void DefineFrames(py::module_& module) {
  py::class_<Shown>(module, "ShownBody", "A body of a Frame; its arrays are slices of the frame's.")
      .def_property_readonly("number", [](const Shown& shown) { return shown.body.body; })
      .def_readonly("blueprint", &Shown::blueprint, "Such as \"ball\".")
      .def_property_readonly(
          "centroid", [](const Shown& shown) { return py::array_t<float>(3, shown.body.centroid); }, "m, world.")
      .def_property_readonly(
          "rotation", [](const Shown& shown) { return py::array_t<float>(4, shown.body.rotation); },
          "Unit quaternion, w x y z.")
      .def_property_readonly(
          "age", [](const Shown& shown) { return shown.body.age; }, "Of the newest data that is shown, s.")
      .def_property_readonly(
          "is_held", [](const Shown& shown) { return shown.body.held != 0; }, "Recent data is missing.")
      .def_property_readonly(
          "lead", [](const Shown& shown) { return py::array_t<float>(3, shown.body.lead); },
          "How far the own body is shown ahead of the server's, by what the input will do; m, in the positions "
          "already.")
      .def_readonly("positions", &Shown::positions, "float32 (n, 3), m, world.")
      .def_readonly("normals", &Shown::normals, "float32 (n, 3), unit length; 0 in bodies without faces.")
      .def_readonly("faces", &Shown::faces, "uint32 (m, 3), of the frame's vertices, counter-clockwise from outside.");
  py::class_<Frame>(module, "Frame", "All bodies at one moment, in arrays that are yours.")
      .def_readonly("positions", &Frame::positions, "float32 (n, 3), m, world.")
      .def_readonly("normals", &Frame::normals, "float32 (n, 3), unit length; 0 in bodies without faces.")
      .def_readonly("faces", &Frame::faces, "uint32 (m, 3), counter-clockwise from outside.")
      .def_readonly("bodies", &Frame::bodies, "By ascending number.");
  py::class_<Event>(module, "Event", "What has happened.")
      .def_readonly("kind", &Event::kind,
                    "join, leave, respawn, body_removed, fall, notice, new_world, said, emoted, renamed, goal, crown; "
                    "\"unknown\": one that this version does not know.")
      .def_property_readonly("client_id", [](const Event& event) { return event.event.client_id; })
      .def_property_readonly(
          "body", [](const Event& event) { return event.event.body; },
          "Its number; of a goal the ball, of a crown the crown; 0: none.")
      .def_property_readonly(
          "emote",
          [](const Event& event) { return event.event.kind == WOBBLE_EMOTED ? NameEmote(event.event.emote) : ""; },
          "Of an emoted one: wave, laugh, love, wow, sad or cheer.")
      .def_readonly("text", &Event::text, "A player's name, a line for the player or of one, or a scene's name.");
}

}  // namespace

void DefineClient(py::module_& module) {
  DefineFrames(module);
  DefineSurroundings(module);
  const auto now = py::arg("now") = py::none();
  py::class_<Player> client(module, "Client",
                            R"(A player of a server, or a spectator: the same client as that of C++ and C.

address: "HOST:PORT". At most one of password, token and invite. server_key: that the server must have. rejoin: tries for a
minute to come back when the connection is lost. predict: shows the own body ahead of the others, by what the input will do.
`now`, here and in update and sample: seconds since any moment, which never go back; by default the system's clock goes on
from there.

Call update 60 times a second. `with` says goodbye at the end. ValueError and RuntimeError say what cannot be.

>>> wobble.Client("nowhere")
Traceback (most recent call last):
ValueError: Client: the address is no HOST:PORT, or the host has no address
)");
  client.def(py::init(&Connect), py::arg("address"), py::kw_only(), py::arg("name") = py::none(),
             py::arg("password") = py::none(), py::arg("token") = py::none(), py::arg("invite") = py::none(),
             py::arg("server_key") = py::none(), py::arg("spectate") = false, py::arg("rejoin") = true,
             py::arg("predict") = true, now);
  client.def("update", &Update, now, "Takes in what has arrived, answers, and sends the input that is due.");
  client.def("leave", &Leave, "Says goodbye and waits for the answer, 5 s at most. `with` does it.");
  client.def(
      "__enter__", [](Player& self) -> Player& { return self; }, py::return_value_policy::reference_internal);
  client.def("__exit__", [](Player& self, const py::args&) { Leave(self); });
  client.def_property_readonly(
      "state", [](Player& self) { return NameAt(kStates, ReadStatus(self).state); },
      "joining, playing, rejoining or ended.");
  client.def_property_readonly(
      "reason", [](Player& self) { return ReadText(self, &wobble_status::reason); }, "One line for people, or \"\".");
  client.def_property_readonly(
      "scene", [](Player& self) { return ReadText(self, &wobble_status::scene); }, "Its name.");
  client.def_property_readonly(
      "description", [](Player& self) { return ReadText(self, &wobble_status::description); },
      "Of the scene, one line; \"\" if it has none.");
  client.def_property_readonly(
      "server_key", [](Player& self) { return ReadText(self, &wobble_status::server_key); },
      "For Client the next time; \"\" before it plays.");
  client.def_property_readonly(
      "own_body", [](Player& self) { return ReadStatus(self).own_body; }, "Its number; 0: none.");
  client.def_property_readonly(
      "client_id", [](Player& self) { return ReadStatus(self).client_id; }, "As in events.");
  client.def_property_readonly(
      "rank", [](Player& self) { return NameAt(kRanks, ReadStatus(self).rank); },
      "watcher, player, moderator (also gives orders about players) or owner (does everything).");
  client.def_property_readonly(
      "talk", [](Player& self) { return NameBits(kTalk, ReadStatus(self).talk); },
      "What this player may tell the others: say, emote.");
  client.def_property_readonly(
      "hands", [](Player& self) { return NameBits(kHands, ReadStatus(self).hands); },
      "What the scene lets players do: grab, cut, push, build.");
  client.def_property_readonly(
      "reach", [](Player& self) { return ReadStatus(self).reach; },
      "Of hands, m from the own body's centroid; 0: any distance.");
  client.def_property_readonly(
      "pace", [](Player& self) { return ReadStatus(self).pace; },
      "How fast the world runs; less than 1 when the server is overloaded.");
  client.def_property_readonly("obstacles", &ListObstacles, "What stands still.");
  client.def_property_readonly("grounds", &ListGrounds, "Grounds whose heights have come.");
  client.def_property_readonly("statistics", &ReadStatistics, "Of the connection, by name; client/wobble.h explains.");
  client.def("set_input", &SetInput, py::arg("move") = py::make_tuple(0, 0), py::kw_only(), py::arg("jump") = false,
             py::arg("puff") = false, py::arg("stiffen") = false,
             "Holds until the next one. move: along the world's x and y, each from -1 to 1.");
  client.def("grab", &Grab, py::arg("body"), py::arg("vertex"), py::arg("target"),
             "Pulls the vertices around this one so that it follows the target, m, until the next grab or release.");
  client.def(
      "release",
      [](Player& self) { Ask(self, "release", [](wobble_client* asked) { return wobble_set_hand(asked, nullptr); }); },
      "Lets go.");
  client.def("push", &Push, py::arg("body"), py::arg("vertex"), py::arg("direction"), "Pushes once.");
  client.def("cut", &Cut, py::arg("body"), py::arg("eye"), py::arg("start"), py::arg("end"),
             "Cuts the springs of the body that pass through this triangle.");
  client.def("sample", &Sample, now, "All bodies as they are to be shown now; none before it plays.");
  client.def("events", &TakeEvents, "Takes what has happened since the last call, oldest first.");
  DefineRules(module, client);
}

}  // namespace wobble::python
