// Recordings of a folder, each shown by a wobbled of its own as long as somebody watches it.
//
// A client knows no physics and no recording's format: wobbled lists them, and shows them at a port of this machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/command/child.h"
#include "client/gateway/gateway.h"

namespace wobble::gateway {

// Shown at once: each costs what a world with its players costs.
inline constexpr std::size_t kMostFilms = 4;

// Shows one recording that somebody asked to watch; who watches holds it.
class Film {
 public:
  //   kStarting --> kShown      its wobbled listens
  //       |            |
  //       +------------+--> kOver      with a reason
  enum class State { kStarting, kShown, kOver };

  [[nodiscard]] State ReadState() const { return m_state; }
  // Where it is, once it is shown; its name is the file's.
  [[nodiscard]] const World& ReadWorld() const { return m_world; }
  // Why it is over: a line for people.
  [[nodiscard]] const std::string& Reason() const { return m_reason; }

 private:
  friend class Films;
  void Start(const std::filesystem::path& folder, const std::string& program, std::size_t watchers, double now);
  void Update(double now);
  void EndWith(std::string reason);

  State m_state = State::kStarting;
  World m_world;
  std::string m_path;
  std::string m_reason;
  std::string m_error;  // the last line that its wobbled complained in
  command::Child m_child;
  double m_startBy = 0;    // s
  double m_watchedAt = 0;  // s, when somebody last did
};

class Films {
 public:
  // folder: is there. program: wobbled. watchers: the most of one film.
  Films(const std::filesystem::path& folder, std::string program, std::size_t watchers);

  // The film of this file, shown or on the way there; over at once if there is no such file or kMostFilms are shown.
  [[nodiscard]] std::shared_ptr<const Film> Watch(const std::string& file, double now);
  // The recordings as a JSON array: the newest that are known. Asking for it has the folder looked at again.
  [[nodiscard]] std::string List(double now);
  // Follows the programs, and ends those that nobody watches. To be called several times a second.
  void Turn(double now);

 private:
  void StartListing(double now);

  std::filesystem::path m_folder;  // absolute
  std::string m_program;
  std::size_t m_watchers;
  std::vector<std::shared_ptr<Film>> m_films;  // and those whose program has not ended yet
  std::unique_ptr<command::Child> m_lister;    // null: none runs
  double m_listedAt = 0;                       // s, when the last lister began
  std::string m_lines;                         // of the lister that runs
  std::string m_list;
};

// The file that a request's path names behind "/play/", percent-encoded; nullopt unless it is a recording's plain name.
[[nodiscard]] std::optional<std::string> FindRecordingName(std::string_view encoded);

}  // namespace wobble::gateway
