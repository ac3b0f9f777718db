// Invites: secrets that let in whoever has them, each with a rank, an end and a number of uses, until revoked.
//
// Only hashes are kept, in memory and in the file: who reads the file can make no link of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/transport/admission.h"
#include "protocol/transport/vestibule/keys.h"

namespace wobble::admission {

struct Invite {
  std::uint32_t number = 0;  // from 1, never used again
  transport::Rank rank = transport::Rank::kPlayer;
  std::uint64_t until = 0;  // s since 1970; 0: for good
  std::uint32_t uses = 0;   // how often it may still be used; see isCounted
  bool isCounted = false;   // false: any number of times
  std::array<std::uint8_t, 32> hash{};
};

inline constexpr std::uint64_t kInviteSeconds = 24 * 3600;  // unless something else is asked for

// One thread at a time.
class Invites {
 public:
  // file: empty: invites end with the server. False with one line in `error`, which names the line of the file.
  [[nodiscard]] bool Load(const std::filesystem::path& file, std::string& error);
  // As Load, and writes nothing.
  [[nodiscard]] bool Read(const std::filesystem::path& file, std::string& error);
  // Reads the file again; without one nothing changes. False with one line in `error`, and nothing has changed.
  [[nodiscard]] bool Reload(std::string& error);

  // Returns the secret, which nobody can read again. number and hash of `invite` are set here. Files are written as by
  // Bans.
  std::string Make(Invite& invite, std::uint64_t now, const transport::vestibule::RandomSource& random,
                   std::string& error);
  [[nodiscard]] bool Revoke(std::uint32_t number, std::uint64_t now, std::string& error);

  // Whether invites outlive the server.
  [[nodiscard]] bool HasFile() const { return !m_file.empty(); }
  // Spends one use of the invite with this secret; nullopt: there is none, or it has ended.
  [[nodiscard]] std::optional<Invite> Use(std::span<const std::uint8_t> secret, std::uint64_t now);
  // Whether who came with it may come back.
  [[nodiscard]] bool IsValid(std::uint32_t number, std::uint64_t now) const;
  // Those in force, with those that have no uses left and whose guests may come back.
  [[nodiscard]] const std::vector<Invite>& All(std::uint64_t now);

 private:
  void DropOver(std::uint64_t now);
  void Save(std::string& error) const;

  std::filesystem::path m_file;
  std::vector<Invite> m_invites;
  std::uint32_t m_newest = 0;
};

}  // namespace wobble::admission
