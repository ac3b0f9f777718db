// A recording in the terminal: the server that shows it, and the keys and the line that wind it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/command/address.h"

namespace wobble::terminal {

// A wobbled of our own that shows a recording on this machine, and ends with this object.
class FilmServer {
 public:
  // Null with one line in `error` when the file cannot be shown or no wobbled is found beside this program.
  [[nodiscard]] static std::unique_ptr<FilmServer> Start(const std::string& file, std::string& error);
  ~FilmServer();

  [[nodiscard]] const command::Address& Address() const { return m_address; }

 private:
  FilmServer();
  struct Process;
  std::unique_ptr<Process> m_process;
  command::Address m_address;
};

// Where a film stands, as its server says in words.
struct FilmPlace {
  bool isPlaying = false;
  double time = 0;  // s
  double end = 0;   // s
  double speed = 1;
};
[[nodiscard]] std::optional<FilmPlace> ReadPlace(const std::string& notice);

class FilmKeys {
 public:
  // Whether the server shows a recording.
  [[nodiscard]] static bool IsFilm(const client::Client& client);
  // Gives the order of `key`, if it has one.
  void Take(char32_t key, client::Client& client);
  // Asks where the film stands, twice a second. now: s.
  void Update(double now, client::Client& client);
  // True: the notice said where it stands, and is not for people.
  bool TakeNotice(const std::string& notice);
  // A time line for a row of so many columns; empty until the server has said where it stands.
  [[nodiscard]] std::string MakeLine(int columns) const;

 private:
  std::optional<FilmPlace> m_place;
  double m_nextAsked = 0;  // s
};

// One line for each key of a film.
[[nodiscard]] std::vector<std::string> DescribeFilmKeys();

}  // namespace wobble::terminal
