// Who may not come in: addresses and accounts, for a time or for good, kept in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/transport/net_address.h"

namespace wobble::admission {

struct Ban {
  std::uint32_t number = 0;            // its name for who lifts it; unique as long as it is in force
  std::uint64_t until = 0;             // s since 1970; 0: for good
  std::uint64_t account = 0;           // 0: an address is banned
  transport::NetAddress address = {};  // IPv4: this one; IPv6: its /64, which one household has
  std::string reason;                  // one line, may be empty
};

// One thread at a time.
class Bans {
 public:
  // file: empty: bans end with the server. False with one line in `error`, which names the line of the file.
  [[nodiscard]] bool Load(const std::filesystem::path& file, std::string& error);
  // As Load, and writes nothing.
  [[nodiscard]] bool Read(const std::filesystem::path& file, std::string& error);
  // Reads the file again; without one nothing changes. False with one line in `error`, and nothing has changed.
  [[nodiscard]] bool Reload(std::string& error);

  // Each of these writes the file, too; what cannot be written is reported in `error` and holds for this run.
  // Takes the place of one of the same account or address.
  const Ban& Add(Ban ban, std::uint64_t now, std::string& error);
  // False: there is none with this number.
  [[nodiscard]] bool Lift(std::uint32_t number, std::uint64_t now, std::string& error);

  // Of the account or address of `subject`.
  [[nodiscard]] bool LiftOf(const Ban& subject, std::uint64_t now, std::string& error);

  // Whether bans outlive the server.
  [[nodiscard]] bool HasFile() const { return !m_file.empty(); }
  // Whether somebody of this account (0: none) and address is banned at this time, s since 1970.
  [[nodiscard]] bool IsBanned(const transport::NetAddress& address, std::uint64_t account, std::uint64_t now) const;
  // Those in force.
  [[nodiscard]] const std::vector<Ban>& All(std::uint64_t now);

 private:
  void DropOver(std::uint64_t now);
  void Save(std::string& error) const;

  std::filesystem::path m_file;
  std::vector<Ban> m_bans;
  std::uint32_t m_newest = 0;
};

}  // namespace wobble::admission
