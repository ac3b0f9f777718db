#include "client/gateway/films.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <utility>

namespace wobble::gateway {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".wobrec";
constexpr std::size_t kMaxNameBytes = 255;
constexpr double kStartPatience = 60;  // s: the recording is read once from beginning to end
// After its last watcher has left, s: who loads the page again comes back to it.
constexpr double kLinger = 8;
constexpr double kEndPatience = 3;  // s for a program to end; then it is killed
constexpr double kListEvery = 2;    // s at least
constexpr std::string_view kListening = "listening on UDP port ";
// A WebSocket's close has room for 123 bytes.
constexpr std::size_t kMaxReasonBytes = 120;

std::optional<char> DecodeHex(std::string_view digits) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (digits.size() != 2 || error != std::errc{} || end != digits.data() + 2) return {};
  return static_cast<char>(value);
}

// Returns what wobbled complained of, without its own name and the folder, which are nobody's business.
std::string Shorten(std::string line, const std::string& path) {
  constexpr std::string_view kPrefix = "wobbled: ";
  if (line.starts_with(kPrefix)) line.erase(0, kPrefix.size());
  if (const auto at = line.find(path); at != std::string::npos) line.replace(at, path.size(), "the recording");
  return line.substr(0, kMaxReasonBytes);
}

}  // namespace

std::optional<std::string> FindRecordingName(std::string_view encoded) {
  std::string name;
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    const auto decoded = encoded[i] == '%' ? DecodeHex(encoded.substr(i + 1, 2)) : encoded[i];
    if (!decoded || name.size() == kMaxNameBytes) return {};
    if (encoded[i] == '%') i += 2;
    name += *decoded;
  }
  const bool isPlain = !name.starts_with('.') && name.find('/') == std::string::npos &&
                       std::ranges::none_of(name, [](unsigned char c) { return c < ' ' || c == 0x7F; });
  return isPlain && name.size() > kEnding.size() && name.ends_with(kEnding) ? std::optional(name) : std::nullopt;
}

void Film::EndWith(std::string reason) {
  m_state = State::kOver;
  m_reason = std::move(reason);
  m_child.Signal(SIGTERM);
}

void Film::Start(const fs::path& folder, const std::string& program, std::size_t watchers, double now) {
  m_path = (folder / m_world.name).string();
  m_startBy = now + kStartPatience;
  m_watchedAt = now;
  std::error_code ignored;
  if (!fs::is_regular_file(m_path, ignored)) return EndWith("there is no such recording here");
  const std::string count = std::to_string(watchers);
  std::string error;
  if (!m_child.Start({program, "--replay", m_path, "--bind", "127.0.0.1", "--port", "0", "--max-clients", count,
                      "--status", "0", "--log-level", "error", "--untrained"},
                     error)) {
    EndWith("the recording cannot be shown: no program can be started");
  }
}

void Film::Update(double now) {
  m_child.Update();
  if (m_state == State::kOver) return;
  for (const std::string& line : m_child.TakeOutput()) {
    if (!line.starts_with(kListening)) continue;
    const char* digits = line.c_str() + kListening.size();
    m_world.server.host = "127.0.0.1";
    std::from_chars(digits, line.c_str() + line.size(), m_world.server.port);
    m_state = State::kShown;
  }
  for (std::string& line : m_child.TakeErrors()) m_error = std::move(line);
  if (!m_child.IsRunning()) {
    EndWith(m_error.empty() ? "the recording's server has ended" : Shorten(m_error, m_path));
  } else if (m_state == State::kStarting && now > m_startBy) {
    EndWith("the recording was not ready within a minute");
  }
}

Films::Films(const fs::path& folder, std::string program, std::size_t watchers)
    : m_folder(fs::absolute(folder)), m_program(std::move(program)), m_watchers(watchers) {
  StartListing(0);
}

std::shared_ptr<const Film> Films::Watch(const std::string& file, double now) {
  const auto isOn = [](const std::shared_ptr<Film>& film) { return film->m_state != Film::State::kOver; };
  const auto isIt = [&](const std::shared_ptr<Film>& film) { return film->m_world.name == file && isOn(film); };
  const auto found = std::ranges::find_if(m_films, isIt);
  if (found != m_films.end()) return *found;
  const auto film = std::make_shared<Film>();
  film->m_world.name = file;
  if (std::ranges::count_if(m_films, isOn) >= std::ptrdiff_t{kMostFilms}) {
    film->EndWith(std::to_string(kMostFilms) + " other recordings are being watched: join one of them, or come later");
    return film;
  }
  film->Start(m_folder, m_program, m_watchers, now);
  if (film->m_state != Film::State::kOver) m_films.push_back(film);
  return film;
}

void Films::StartListing(double now) {
  m_listedAt = now;
  m_lister = std::make_unique<command::Child>();
  m_lines.clear();
  std::string ignored;
  if (!m_lister->Start({m_program, "--list-recordings", m_folder.string()}, ignored)) m_lister.reset();
}

std::string Films::List(double now) {
  if (m_lister == nullptr && now > m_listedAt + kListEvery) StartListing(now);
  return "[" + m_list + "]";
}

void Films::Turn(double now) {
  for (const std::shared_ptr<Film>& film : m_films) {
    film->Update(now);
    if (film.use_count() > 1) film->m_watchedAt = now;
    if (film->m_state != Film::State::kOver && now > film->m_watchedAt + kLinger) film->EndWith("nobody watches");
  }
  std::erase_if(m_films, [now](const std::shared_ptr<Film>& film) {
    return film->m_state == Film::State::kOver &&
           (!film->m_child.IsRunning() || now > film->m_watchedAt + kLinger + kEndPatience);
  });
  if (m_lister == nullptr) return;
  m_lister->Update();
  for (const std::string& line : m_lister->TakeOutput()) m_lines += (m_lines.empty() ? "" : ",") + line;
  if (m_lister->IsRunning()) return;
  m_list = std::exchange(m_lines, {});
  m_lister.reset();
}

}  // namespace wobble::gateway
