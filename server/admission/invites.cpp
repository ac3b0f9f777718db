// A line of the file: "NUMBER RANK UNTIL USES HASH", where UNTIL is "ever" or seconds since 1970, and USES "any" or a
// number. The first line that is no comment may be "newest NUMBER", so that numbers are not used again.
#include "server/admission/invites.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "protocol/transport/vestibule/token.h"
#include "server/admission/rank.h"
#include "server/admission/record_file.h"

namespace wobble::admission {

namespace vestibule = transport::vestibule;

namespace {

constexpr std::size_t kSecretBytes = 16;

std::array<std::uint8_t, 32> HashSecret(std::span<const std::uint8_t> secret) {
  static constexpr std::array<std::uint8_t, 6> kPurpose{'i', 'n', 'v', 'i', 't', 'e'};
  std::array<std::uint8_t, 32> hash;
  vestibule::ComputeHash(hash, kPurpose, secret);
  return hash;
}

template <class Number>
bool ReadNumber(const std::string& text, Number& number) {
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
  return result == std::errc{} && end == text.data() + text.size();
}

bool ParseInvite(const std::string& line, Invite& invite) {
  std::istringstream in(line);
  std::string number, rank, until, uses, hash, more;
  in >> number >> rank >> until >> uses >> hash;
  const auto parsedRank = ParseRank(rank);
  const auto parsedHash = vestibule::ParseKey(hash);
  const bool isGood = ReadNumber(number, invite.number) && parsedRank && parsedHash && !(in >> more) &&
                      (until == "ever" || ReadNumber(until, invite.until)) &&
                      (uses == "any" || ReadNumber(uses, invite.uses));
  if (!isGood) return false;
  invite.rank = *parsedRank;
  invite.isCounted = uses != "any";
  invite.hash = *parsedHash;
  return true;
}

std::string WriteInvite(const Invite& invite) {
  return std::to_string(invite.number) + " " + NameOf(invite.rank) + " " +
         (invite.until == 0 ? "ever" : std::to_string(invite.until)) + " " +
         (invite.isCounted ? std::to_string(invite.uses) : "any") + " " + vestibule::FormatKey(invite.hash);
}

bool HasEnded(const Invite& invite, std::uint64_t now) { return invite.until != 0 && invite.until <= now; }

}  // namespace

bool Invites::Load(const std::filesystem::path& file, std::string& error) {
  if (!Read(file, error)) return false;
  if (!HasFile()) return true;
  Save(error);  // what cannot be written is found now, not when it is needed
  return error.empty();
}

bool Invites::Reload(std::string& error) {
  if (!HasFile()) return true;
  Invites read;
  if (!read.Read(m_file, error)) return false;
  read.m_newest = std::max(read.m_newest, m_newest);
  *this = std::move(read);
  return true;
}

bool Invites::Read(const std::filesystem::path& file, std::string& error) {
  m_file = file;
  std::vector<std::string> lines;
  if (file.empty()) return true;
  if (!ReadLines(file, lines, error)) return false;
  constexpr const char* kNewest = "newest ";
  for (const std::string& line : lines) {
    if (line.rfind(kNewest, 0) == 0 && ReadNumber(line.substr(std::string(kNewest).size()), m_newest)) continue;
    Invite invite;
    if (!ParseInvite(line, invite)) {
      error = file.string() + ": '" + line.substr(0, 60) + "' must be a number, a rank, a time, uses and a hash";
      return false;
    }
    m_newest = std::max(m_newest, invite.number);
    m_invites.push_back(invite);
  }
  return true;
}

std::string Invites::Make(Invite& invite, std::uint64_t now, const vestibule::RandomSource& random,
                          std::string& error) {
  DropOver(now);
  std::array<std::uint8_t, kSecretBytes> secret;
  random(secret);
  invite.number = ++m_newest;
  invite.hash = HashSecret(secret);
  m_invites.push_back(invite);
  Save(error);
  return vestibule::FormatSecret(secret);
}

bool Invites::Revoke(std::uint32_t number, std::uint64_t now, std::string& error) {
  DropOver(now);
  if (std::erase_if(m_invites, [&](const Invite& invite) { return invite.number == number; }) == 0) return false;
  Save(error);
  return true;
}

std::optional<Invite> Invites::Use(std::span<const std::uint8_t> secret, std::uint64_t now) {
  const auto hash = HashSecret(secret);
  const auto found = std::find_if(m_invites.begin(), m_invites.end(),
                                  [&](const Invite& invite) { return vestibule::AreEqual(invite.hash, hash); });
  if (found == m_invites.end() || HasEnded(*found, now) || (found->isCounted && found->uses == 0)) return {};
  if (found->isCounted) {
    --found->uses;
    std::string ignored;  // the uses that are left are right again with the next write
    Save(ignored);
  }
  return *found;
}

bool Invites::IsValid(std::uint32_t number, std::uint64_t now) const {
  return std::any_of(m_invites.begin(), m_invites.end(),
                     [&](const Invite& invite) { return invite.number == number && !HasEnded(invite, now); });
}

const std::vector<Invite>& Invites::All(std::uint64_t now) {
  DropOver(now);
  return m_invites;
}

void Invites::DropOver(std::uint64_t now) {
  std::erase_if(m_invites, [&](const Invite& invite) { return HasEnded(invite, now); });
}

void Invites::Save(std::string& error) const {
  if (m_file.empty()) return;
  std::vector<std::string> lines{"newest " + std::to_string(m_newest)};
  for (const Invite& invite : m_invites) lines.push_back(WriteInvite(invite));
  static_cast<void>(WriteLines(m_file, "wobble invites: NUMBER RANK UNTIL USES HASH", lines, error));
}

}  // namespace wobble::admission
