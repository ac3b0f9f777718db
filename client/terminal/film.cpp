#include "client/terminal/film.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "client/command/child.h"
#include "client/command/clock.h"
#include "client/command/command.h"

namespace wobble::terminal {
namespace {

constexpr double kStartPatience = 60;  // s: the recording is read once from beginning to end
constexpr double kAskEvery = 0.5;      // s
constexpr const char* kListening = "listening on UDP port ";

struct FilmBinding {
  char32_t key;
  const char* order;
  const char* words;  // for people; empty: said with the key before
};
constexpr std::array kFilmBindings{
    FilmBinding{U'o', "film play", "O play, N pause"},
    FilmBinding{U'n', "film pause", ""},
    FilmBinding{U',', "film step -1", ", . one tick back, on"},
    FilmBinding{U'.', "film step 1", ""},
    FilmBinding{U'<', "film by -5", "< > five seconds back, on"},
    FilmBinding{U'>', "film by 5", ""},
    FilmBinding{U'0', "film to 0", "0 to the beginning"},
    FilmBinding{U'1', "film speed 0.25", "1 2 3 4 5 a quarter, half, usual, four and sixteen times the speed"},
    FilmBinding{U'2', "film speed 0.5", ""},
    FilmBinding{U'3', "film speed 1", ""},
    FilmBinding{U'4', "film speed 4", ""},
    FilmBinding{U'5', "film speed 16", ""},
    FilmBinding{U'8', "film speed -4", "8 9 backwards four times as fast, as usual"},
    FilmBinding{U'9', "film speed -1", ""},
};

std::string FormatTime(double seconds) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%d:%02d", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  return text.data();
}

}  // namespace

struct FilmServer::Process {
  command::Child child;
};

FilmServer::FilmServer() : m_process(std::make_unique<Process>()) {}
FilmServer::~FilmServer() { m_process->child.Signal(SIGTERM); }

std::unique_ptr<FilmServer> FilmServer::Start(const std::string& file, std::string& error) {
  std::unique_ptr<FilmServer> server(new FilmServer());
  command::Child& child = server->m_process->child;
  const std::string program = (command::FindProgramFolder() / "wobbled").string();
  const std::vector<std::string> words{program, "--replay",    file,    "--bind",   "127.0.0.1", "--port",
                                       "0",     "--log-level", "error", "--status", "0",         "--untrained"};
  if (!child.Start(words, error)) return nullptr;
  for (const double end = command::ReadClock() + kStartPatience; command::ReadClock() < end;) {
    child.Update();
    for (const std::string& line : child.TakeOutput()) {
      const auto at = line.find(kListening);
      if (at == std::string::npos) continue;
      const auto port = command::ParseAddress(
          "127.0.0.1:" + std::to_string(std::atoi(line.c_str() + at + std::string(kListening).size())), error);
      if (!port) return nullptr;
      server->m_address = *port;
      return server;
    }
    for (const std::string& line : child.TakeErrors()) error = line;
    if (!child.IsRunning()) {
      if (error.empty()) error = program + " ended";
      return nullptr;
    }
    static_cast<void>(poll(nullptr, 0, 10));
  }
  error = file + ": " + program + " does not show it within a minute";
  return nullptr;
}

std::optional<FilmPlace> ReadPlace(const std::string& notice) {
  FilmPlace place;
  std::array<char, 8> word{};
  int minutes = 0;
  int endMinutes = 0;
  const bool isPlaying = notice.starts_with("plays ");
  const char* format = isPlaying ? "%7s %d:%lf of %d:%lf, speed %lf" : "%7s at %d:%lf of %d:%lf, speed %lf";
  if (std::sscanf(notice.c_str(), format, word.data(), &minutes, &place.time, &endMinutes, &place.end, &place.speed) !=
      6) {
    return {};
  }
  place.isPlaying = isPlaying;
  place.time += 60 * minutes;
  place.end += 60 * endMinutes;
  return place;
}

bool FilmKeys::IsFilm(const client::Client& client) { return client.Welcome().game == "film"; }

void FilmKeys::Take(char32_t key, client::Client& client) {
  const auto binding = std::find_if(kFilmBindings.begin(), kFilmBindings.end(),
                                    [key](const FilmBinding& each) { return each.key == key; });
  if (binding != kFilmBindings.end()) client.Order(binding->order);
}

void FilmKeys::Update(double now, client::Client& client) {
  if (now < m_nextAsked) return;
  m_nextAsked = now + kAskEvery;
  client.Order("film");
}

bool FilmKeys::TakeNotice(const std::string& notice) {
  const auto place = ReadPlace(notice);
  if (place) m_place = place;
  return place.has_value();
}

std::string FilmKeys::MakeLine(int columns) const {
  if (!m_place) return {};
  std::array<char, 96> words{};
  std::snprintf(words.data(), words.size(), " %s of %s, %s x%g", FormatTime(m_place->time).c_str(),
                FormatTime(m_place->end).c_str(), m_place->isPlaying ? "plays" : "paused", m_place->speed);
  const int bar = columns - static_cast<int>(std::string(words.data()).size()) - 2;
  if (bar < 4) return words.data();
  const double share = m_place->end > 0 ? std::clamp(m_place->time / m_place->end, 0.0, 1.0) : 0;
  const auto done = static_cast<std::size_t>(std::lround(share * (bar - 1)));
  std::string line = "[" + std::string(done, '=') + ">" + std::string(static_cast<std::size_t>(bar) - 1 - done, '-');
  return line + "]" + words.data();
}

std::vector<std::string> DescribeFilmKeys() {
  std::vector<std::string> lines;
  for (const FilmBinding& each : kFilmBindings) {
    if (*each.words != 0) lines.emplace_back(each.words);
  }
  return lines;
}

}  // namespace wobble::terminal
