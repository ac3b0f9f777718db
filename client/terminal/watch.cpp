// The loop with the clock: update the client, read keys, draw when a picture is due, wait for the next event.
//
// A picture is encoded only when the previous one has gone to the terminal in full: on a slow line pictures are
// skipped, and the picture shown is at most one picture old. The loop waits for time alone, so the connection and the
// keys go on whatever the terminal does.
#include "client/terminal/watch.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

#include "client/command/access.h"
#include "client/command/clock.h"
#include "client/command/exit_codes.h"
#include "client/files/kept_folder.h"
#include "client/lasting_client.h"
#include "client/terminal/answer.h"
#include "client/terminal/camera.h"
#include "client/terminal/controls.h"
#include "client/terminal/film.h"
#include "client/terminal/follow.h"
#include "client/terminal/guardian.h"
#include "client/terminal/hands.h"
#include "client/terminal/keys.h"
#include "client/terminal/line_field.h"
#include "client/terminal/people.h"
#include "client/terminal/picture_file.h"
#include "client/terminal/renderer.h"
#include "client/terminal/status.h"
#include "client/terminal/terminal.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::terminal {
namespace {

constexpr double kUpdateHz = 60;
constexpr Size kLeastSize{24, 6};
// Bytes of one picture after which the rest waits for the next round.
constexpr std::size_t kMaxFrameBytes = 64 * 1024;
constexpr double kGoodbyePatience = 1.5;  // s to wait for the server's answer to the goodbye, however bad the link
constexpr double kRateEvery = 1;          // s between measurements of the rate
constexpr double kSilence = 1.5;          // s without a snapshot after which the status line says so
constexpr double kFigureSmoothing = 0.1;
constexpr double kNoticeTime = 4;  // s for which an event is shown

class Watch {
 public:
  Watch(const WatchOptions& options, Terminal& terminal, Guard& guard, const std::function<bool()>& isStopAsked)
      : m_options(options),
        m_terminal(terminal),
        m_guard(guard),
        m_isStopAsked(isStopAsked),
        m_access(options.access),
        m_encoder(options.palette.value_or(FindPalette(std::getenv("COLORTERM"), std::getenv("TERM")))),
        m_camera(options.spectate ? CameraMode::kCircle : CameraMode::kFollow) {}

  int Run();
  [[nodiscard]] const CellGrid& Picture() const { return m_grid; }

 private:
  bool Connect();
  std::unique_ptr<transport::Transport> Dial(std::string& error);
  void Begin(client::Client& client);
  void Play();
  void NoteFirstPlay();
  void SayGoodbye();
  int Conclude();

  void ReadKeys(double now);
  [[nodiscard]] bool TakeLine(const KeyEvent& event);
  [[nodiscard]] bool MaySay();
  [[nodiscard]] bool MayOrder();
  void Send(const std::string& line);
  void FollowNext();
  void NoteEvent(const client::Client::Event& event);
  void NoteNextScene(const std::string& scene);
  void Show(const std::string& notice);

  void DrawFrame(double now);
  void DrawWorld(double now);
  void WriteFigures(double now);
  [[nodiscard]] std::vector<std::string> DescribeOtherKeys(bool isFilm);
  [[nodiscard]] int FindSide(std::uint32_t body);
  void DrawBodies(int width, int height);
  void FillCells(int width, int height);
  void Send(double begin);
  void MeasureRate(double now);
  void Wait(double until);
  [[nodiscard]] client::Client& Client() { return m_player->Current(); }
  [[nodiscard]] bool IsPlaying() const { return m_player->ReadState() == client::LastingState::kPlaying; }

  const WatchOptions& m_options;
  Terminal& m_terminal;
  Guard& m_guard;
  const std::function<bool()>& m_isStopAsked;

  transport::ConnectOptions m_access;
  // Of the newest connection; owned by m_player, so to be used only while it joins for the first time or plays.
  transport::EnetTransport* m_transport = nullptr;
  std::unique_ptr<client::LastingClient> m_player;
  std::vector<client::BodySample> m_samples;
  People m_people;
  Hands m_hands;
  FilmKeys m_film;
  Followed m_followed;
  Answer m_answer;
  std::string m_notice;
  double m_noticeUntil = 0;

  KeyDecoder m_decoder;
  Controls m_controls;
  LineField m_line;
  std::vector<KeyEvent> m_events;
  bool m_gone = false;  // the terminal has closed

  FrameEncoder m_encoder;
  Camera m_camera;
  Renderer m_renderer;
  CellGrid m_grid;
  std::vector<DrawnBody> m_bodies;
  std::vector<Vector3> m_centroids;
  std::vector<Colour> m_pixels;
  std::string m_output;  // bytes of a picture not yet taken by the terminal

  StatusFigures m_figures;
  bool m_played = false;
  double m_lastDrawn = 0;
  std::uint64_t m_newsCount = 0;  // number of snapshots at the last picture
  double m_newsAt = 0;            // time of the last new snapshot
  double m_rateFrom = 0;
  std::uint64_t m_rateBytes = 0;
};

int Watch::Run() {
  if (!Connect()) return command::kExitBadUse;
  Play();
  m_guard.LeaveIfAlone();
  SayGoodbye();
  return Conclude();
}

// On failure prints one line and returns false.
bool Watch::Connect() {
  std::string error;
  auto transport = Dial(error);
  if (transport == nullptr) {
    std::fprintf(stderr, "wobble watch: %s\n", error.c_str());
    return false;
  }
  client::LastingOptions options;
  options.client.name = m_options.name;
  options.client.spectator = m_options.spectate;
  files::UseKeptFolder(files::FindBasesFolder(), command::Describe(m_options.server), options.client);
  options.rejoin = m_options.rejoin;
  options.connect = [this](std::string& reason) { return Dial(reason); };
  options.prepare = [this](client::Client& client) { Begin(client); };
  m_player = std::make_unique<client::LastingClient>(std::move(transport), options, command::ReadClock());
  return true;
}

std::unique_ptr<transport::Transport> Watch::Dial(std::string& error) {
  auto transport = transport::EnetTransport::Connect(m_options.server.host, m_options.server.port, error, m_access);
  m_transport = transport.get();
  return transport;
}

void Watch::Begin(client::Client& client) {
  m_people.BeginAnew();
  m_hands = {};
  m_rateBytes = 0;
  client.OnEvent([this](const client::Client::Event& event) { NoteEvent(event); });
  client.OnNextScene([this](const std::string& scene) { NoteNextScene(scene); });
  client.OnNotice([this](const std::string& text) {
    if (!m_film.TakeNotice(text)) m_answer.Add(MakePlain(text), command::ReadClock());
  });
}

// From now on it has to be this server, also after it was restarted. A ticket stands for a token or an invite that may
// be good only once.
void Watch::NoteFirstPlay() {
  m_played = true;
  command::NoteServer(m_options.server, *m_transport);
  m_access.serverKey = m_transport->ReadServerKey();
  const std::vector<std::uint8_t> ticket = m_transport->ReadTicket();
  if (!ticket.empty()) m_access.credential = {transport::vestibule::Credential::Kind::kToken, ticket};
}

void Watch::Play() {
  const double begin = command::ReadClock();
  double nextUpdate = begin, nextFrame = begin;
  m_lastDrawn = m_rateFrom = begin;
  while (!m_gone && !m_controls.IsQuitAsked() && !m_isStopAsked() && !m_guard.IsAlone()) {
    const double now = command::ReadClock();
    if (m_options.duration > 0 && now >= begin + m_options.duration) return;
    if (now >= nextUpdate) {
      m_player->Update(now);
      nextUpdate = std::max(nextUpdate + 1 / kUpdateHz, now);
      if (m_player->ReadState() == client::LastingState::kEnded) return;
      if (!m_played && IsPlaying()) NoteFirstPlay();
    }
    if (m_guard.Update()) {
      m_encoder.Invalidate();
      m_output.clear();
    }
    if (m_guard.IsPaused()) {
      m_controls.ReleaseAll();
    } else {
      ReadKeys(now);
    }
    Client().SetInput(m_controls.MakeInput(now, m_camera));
    if (m_guard.IsPaused()) m_output.clear();  // the rest of a frame that the terminal was slow to take
    if (!m_terminal.Write(m_output)) return;
    if (now >= nextFrame) {
      if (!m_guard.IsPaused() && m_output.empty()) DrawFrame(now);
      nextFrame = std::max(nextFrame + 1 / m_options.fps, now);
    }
    Wait(std::min(nextUpdate, nextFrame));
  }
}

void Watch::SayGoodbye() {
  m_player->Leave(command::ReadClock());
  const double end = command::ReadClock() + kGoodbyePatience;
  while (m_player->ReadState() != client::LastingState::kEnded && command::ReadClock() < end) {
    m_player->Update(command::ReadClock());
    static_cast<void>(poll(nullptr, 0, 10));
  }
}

int Watch::Conclude() {
  if (!m_player->EndedUnasked()) return command::kExitGood;
  const std::string address = command::Describe(m_options.server);
  const std::string reason = m_player->Reason() + command::AdviseOn(m_player->Reason(), m_options.server);
  if (m_played) {
    std::fprintf(stderr, "wobble watch: %s is no longer there: %s\n", address.c_str(), reason.c_str());
    return command::kExitFailed;
  }
  if (m_transport->ReadStatistics().bytesIn == 0) {
    std::fprintf(stderr, "wobble watch: no server answers at %s\n", address.c_str());
  } else {
    std::fprintf(stderr, "wobble watch: could not join %s: %s\n", address.c_str(), reason.c_str());
  }
  return command::kExitBadUse;
}

void Watch::ReadKeys(double now) {
  m_events.clear();
  std::string bytes;
  if (!m_terminal.Read(bytes)) m_gone = true;
  m_decoder.Feed(bytes, now, m_events);
  const bool hasBody = IsPlaying() && Client().Welcome().ownBody != 0;
  const bool hasWatched = hasBody || m_followed.Body() != 0;
  for (const KeyEvent& event : m_events) {
    if (!TakeLine(event)) m_controls.Take(event, now, hasWatched, m_camera);
  }
  if (m_controls.TakePause()) m_guard.Pause();
  for (const char32_t key : m_controls.TakeOthers()) {
    if (hasBody) m_hands.Take(key, m_camera, m_samples, Client());
    if (IsPlaying() && FilmKeys::IsFilm(Client())) m_film.Take(key, Client());
    if (IsPlaying() && hasBody && key == kReadyKey && !Client().Welcome().game.empty()) Client().Order("ready");
    if (IsPlaying() && !hasBody && key == kFollowKey) FollowNext();
  }
}

// False: the key is for others.
bool Watch::TakeLine(const KeyEvent& event) {
  constexpr char32_t kControlC = 3, kControlZ = 26;
  if (!IsPlaying() || event.key == kControlC || event.key == kControlZ) return false;
  if (m_line.IsOpen()) {
    if (const auto line = m_line.Take(event); line && !line->empty()) Send(*line);
    return event.key != kReleasesReported;  // which is no key
  }
  if (event.key != kKeyEnter || event.released || !(MaySay() || MayOrder())) return false;
  m_controls.ReleaseAll();
  m_line.Open();
  return true;
}

bool Watch::MaySay() { return (Client().Welcome().talk & protocol::kMaySay) != 0; }

// Who plays, and may show emotes, and who rules.
bool Watch::MayOrder() {
  const protocol::WelcomeFields& welcome = Client().Welcome();
  return (welcome.talk & protocol::kMayEmote) != 0 || welcome.rank >= wire::Rank::Moderator;
}

void Watch::Send(const std::string& line) {
  if (line[0] == '/') {
    Client().Order(line.substr(1));
  } else if (MaySay()) {
    Client().Say(line);
  } else {
    Show("nobody says lines here; what begins with / is an order: /help");
  }
}

void Watch::FollowNext() {
  Show(m_followed.ChooseNext(m_people.Players()));
  m_camera.Choose(m_followed.Body() != 0 ? CameraMode::kFollow : CameraMode::kCircle);
}

void Watch::NoteEvent(const client::Client::Event& event) {
  const std::string line = m_people.Note(event);
  if (!line.empty()) Show(line);
}

void Watch::NoteNextScene(const std::string& scene) {
  m_people.BeginAnew();
  m_hands = {};
  Show("next scene: " + MakePlain(scene));
}

void Watch::Show(const std::string& notice) {
  m_notice = notice;
  m_noticeUntil = command::ReadClock() + kNoticeTime;
}

void Watch::DrawFrame(double now) {
  const double begin = command::ReadClock();
  const Size size = m_terminal.ReadSize();
  if (size != Size{m_grid.columns, m_grid.rows}) m_encoder.Invalidate();
  m_grid.Resize(size.columns, size.rows);
  if (IsPlaying()) MeasureRate(now);
  if (size.columns < kLeastSize.columns || size.rows < kLeastSize.rows) {
    char text[80];
    std::snprintf(text, sizeof text, "too small: %dx%d, needs %dx%d", size.columns, size.rows, kLeastSize.columns,
                  kLeastSize.rows);
    m_grid.Write(0, 0, text, {255, 255, 255}, {});
  } else if (m_played) {
    DrawWorld(now);
  } else {
    const bool connecting = Client().ReadState() == client::State::kConnecting;
    WriteBox(m_grid, {(connecting ? "connecting to " : "joining ") + command::Describe(m_options.server) + " ..."});
    WriteStatus(m_grid, "", "Q: quit");
  }
  Send(begin);
}

void Watch::DrawWorld(double now) {
  Client().Sample(now, client::Detail::kVertices, m_samples);
  const int width = m_grid.columns, height = 2 * (m_grid.rows - 1);
  const std::uint32_t own = Client().Welcome().ownBody;
  std::optional<Vector3> watched;
  m_centroids.clear();
  for (const client::BodySample& sample : m_samples) {
    m_centroids.push_back(sample.pose.centroid);
    if (sample.body == (own != 0 ? own : m_followed.Body())) watched = sample.pose.centroid;
  }
  m_camera.Update(now - m_lastDrawn, watched, m_centroids);
  m_lastDrawn = now;
  m_hands.Update(m_camera, m_samples, Client());
  DrawBodies(width, height);
  FillCells(width, height);
  WriteFigures(now);
}

void Watch::WriteFigures(double now) {
  const client::Statistics& statistics = Client().ReadStatistics();
  if (statistics.inputToSnapshot > 0) m_figures.inputMs = statistics.inputToSnapshot * 1000;
  m_figures.interpolationDelayMs = Client().InterpolationDelay() * 1000;
  m_figures.pace = Client().Pace();
  m_figures.stalls = statistics.stalls;
  m_figures.bodies = m_samples.size();
  m_figures.players = m_people.Players().size();
  if (statistics.snapshots != m_newsCount) m_newsAt = now;
  m_newsCount = statistics.snapshots;
  const bool isFilm = FilmKeys::IsFilm(Client());
  if (isFilm) {
    m_film.Update(now, Client());
    WriteTop(m_grid, m_film.MakeLine(m_grid.columns - 2));
  } else if (!Client().Welcome().game.empty()) {
    WriteTop(m_grid, FormatScores(Client().ReadScoreboard(), [this](std::uint32_t id) { return m_people.NameOf(id); }));
  }
  if (const std::vector<std::string> answer = m_answer.Read(now); !answer.empty()) WriteAnswer(m_grid, answer);
  std::string words = now < m_noticeUntil ? m_notice : FormatStatus(m_figures);
  if (now >= m_newsAt + kSilence) words = FormatSilence(now - m_newsAt);
  if (!IsPlaying()) words = FormatRejoining(MakePlain(m_player->Reason()));
  if (m_line.IsOpen()) words = FormatField(m_line.Text(), m_grid.columns);
  WriteStatus(m_grid, words, m_line.IsOpen() ? "Enter: say it" : "?: keys");
  if (m_controls.ShowsKeys()) WriteBox(m_grid, DescribeKeys(m_figures, DescribeOtherKeys(isFilm)));
}

// Those that only some have.
std::vector<std::string> Watch::DescribeOtherKeys(bool isFilm) {
  std::vector<std::string> lines = isFilm ? DescribeFilmKeys() : DescribeHandKeys(Client());
  if (Client().Welcome().ownBody == 0) lines.emplace_back("B                follow the next player");
  if ((Client().Welcome().talk & protocol::kMaySay) != 0) lines.emplace_back("Enter            say a line to all");
  return lines;
}

// The side of a player's body in a game; 0: none.
int Watch::FindSide(std::uint32_t body) {
  const client::Scoreboard& board = Client().ReadScoreboard();
  const std::uint32_t owner = m_people.FindOwner(body);
  if (owner == 0) return 0;
  for (std::size_t i = 0; i < board.scores.size() && i < board.seats.size(); ++i) {
    if (board.scores[i].client_id() == owner) return std::min<int>(board.seats[i].side(), 2);
  }
  return 0;
}

void Watch::DrawBodies(int width, int height) {
  m_bodies.clear();
  for (const client::BodySample& sample : m_samples) {
    if (sample.vertices.size() != sample.blueprint->rest.size()) continue;
    const int side = FindSide(sample.body);
    const Light colour = side != 0                                   ? kSideColours[side - 1]
                         : sample.body == Client().Welcome().ownBody ? kOwnColour
                         : m_people.Players().contains(sample.body)  ? FindPlayerColour(sample.body)
                                                                     : kSceneColour;
    const client::Blueprint& blueprint = *sample.blueprint;
    m_bodies.push_back({.vertices = sample.vertices,
                        .rest = blueprint.rest,
                        .faces = blueprint.faces,
                        .colour = colour,
                        .open = blueprint.open,
                        .edges = blueprint.edges});
  }
  const World world{.obstacles = Client().Welcome().obstacles,
                    .bodies = m_bodies,
                    .focus = m_camera.Focus(),
                    .grounds = Client().Grounds()};
  m_renderer.Draw(world, m_camera.MakeView(), width, height, m_pixels);
}

void Watch::FillCells(int width, int height) {
  for (int y = 0; y < height; y += 2) {
    for (int x = 0; x < width; ++x) {
      const auto upper = static_cast<std::size_t>(y * width + x);
      m_grid.At(x, y / 2) = {kUpperHalf, m_pixels[upper], m_pixels[upper + static_cast<std::size_t>(width)]};
    }
  }
}

void Watch::Send(double begin) {
  m_encoder.Encode(m_grid, kMaxFrameBytes, m_output);
  m_figures.frameKilobytes +=
      (static_cast<double>(m_output.size()) / 1000 - m_figures.frameKilobytes) * kFigureSmoothing;
  m_figures.frameMs += ((command::ReadClock() - begin) * 1000 - m_figures.frameMs) * kFigureSmoothing;
  if (!m_terminal.Write(m_output)) m_gone = true;
}

void Watch::MeasureRate(double now) {
  if (now < m_rateFrom + kRateEvery) return;
  const std::uint64_t bytes = m_transport->ReadStatistics().bytesIn;
  m_figures.kbitPerSecond = static_cast<double>(bytes - m_rateBytes) * 8 / 1000 / (now - m_rateFrom);
  m_rateBytes = bytes;
  m_rateFrom = now;
}

// Waits until `until`, a key, a signal, or room in the terminal for more output.
void Watch::Wait(double until) {
  const double seconds = std::clamp(until - command::ReadClock(), 0.0, 1.0);
  pollfd descriptor{m_terminal.Descriptor(), POLLIN, 0};
  if (!m_output.empty()) descriptor.events |= POLLOUT;
  const nfds_t count = m_guard.IsPaused() ? 0 : 1;
  static_cast<void>(poll(&descriptor, count, static_cast<int>(std::ceil(seconds * 1000))));
}

bool BeginsWith(std::string_view text, std::string_view beginning) {
  return text.substr(0, beginning.size()) == beginning;
}

}  // namespace

Palette FindPalette(const char* colorTerm, const char* term) {
  const std::string_view depth = colorTerm == nullptr ? "" : colorTerm;
  const std::string_view kind = term == nullptr ? "" : term;
  const bool known = kind.find("direct") != std::string_view::npos || BeginsWith(kind, "xterm-kitty") ||
                     BeginsWith(kind, "alacritty") || BeginsWith(kind, "foot") || BeginsWith(kind, "wezterm") ||
                     BeginsWith(kind, "xterm-ghostty");
  return depth == "truecolor" || depth == "24bit" || known ? Palette::kTruecolour : Palette::k256;
}

int RunWatch(const WatchOptions& options, const std::function<bool()>& isStopAsked) {
  std::string error;
  const auto terminal = Terminal::Open(error);
  if (terminal == nullptr) {
    std::fprintf(stderr, "wobble watch: %s\n", error.c_str());
    return command::kExitBadUse;
  }
  std::ofstream capture;
  if (!options.captureFile.empty()) {
    errno = 0;
    capture.open(options.captureFile, std::ios::binary | std::ios::trunc);
    if (!capture) {
      std::fprintf(stderr, "wobble watch: --capture: '%s' cannot be written: %s\n", options.captureFile.c_str(),
                   std::strerror(errno));
      return command::kExitBadUse;
    }
  }
  return RunGuarded(*terminal, [&](Guard& guard) {
    Watch watch(options, *terminal, guard, isStopAsked);
    const int code = watch.Run();
    if (capture.is_open()) capture << MakeSvg(watch.Picture()) << std::flush;
    if (capture) return code;
    std::fprintf(stderr, "wobble watch: --capture: '%s' could not be written in full\n", options.captureFile.c_str());
    return command::kExitBadUse;
  });
}

}  // namespace wobble::terminal
