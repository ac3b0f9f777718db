// A line of the file: "UNTIL WHOM REASON", where UNTIL is "ever" or seconds since 1970, and WHOM an address or
// "account:NUMBER".
#include "server/admission/bans.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "server/admission/record_file.h"

namespace wobble::admission {
namespace {

constexpr const char* kAccount = "account:";

bool ReadWhole(const std::string& text, std::uint64_t& number) {
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
  return result == std::errc{} && end == text.data() + text.size();
}

bool ParseBan(const std::string& line, Ban& ban) {
  std::istringstream in(line);
  std::string until, whom;
  in >> until >> whom;
  std::getline(in >> std::ws, ban.reason);
  if (until != "ever" && (!ReadWhole(until, ban.until) || ban.until == 0)) return false;
  if (whom.rfind(kAccount, 0) == 0) return ReadWhole(whom.substr(std::string(kAccount).size()), ban.account);
  const auto address = transport::ParseIp(whom);
  if (address) ban.address = *address;
  return address.has_value();
}

std::string WriteBan(const Ban& ban) {
  return (ban.until == 0 ? "ever" : std::to_string(ban.until)) + " " +
         (ban.account != 0 ? kAccount + std::to_string(ban.account) : transport::FormatIp(ban.address)) +
         (ban.reason.empty() ? "" : " " + ban.reason);
}

bool IsOver(const Ban& ban, std::uint64_t now) { return ban.until != 0 && ban.until <= now; }

bool CoversAddress(const Ban& ban, const transport::NetAddress& address) {
  if (ban.account != 0) return false;
  if (address.IsIpv4() || ban.address.IsIpv4()) return ban.address.ip == address.ip;
  return transport::FindSubnet(ban.address) == transport::FindSubnet(address);
}

bool HaveSameSubject(const Ban& a, const Ban& b) {
  return a.account != 0 || b.account != 0 ? a.account == b.account : CoversAddress(a, b.address);
}

}  // namespace

bool Bans::Load(const std::filesystem::path& file, std::string& error) {
  if (!Read(file, error)) return false;
  if (!HasFile()) return true;
  Save(error);  // what cannot be written is found now, not when it is needed
  return error.empty();
}

bool Bans::Reload(std::string& error) {
  if (!HasFile()) return true;
  Bans read;
  if (!read.Read(m_file, error)) return false;
  read.m_newest = std::max(read.m_newest, m_newest);
  *this = std::move(read);
  return true;
}

bool Bans::Read(const std::filesystem::path& file, std::string& error) {
  m_file = file;
  std::vector<std::string> lines;
  if (file.empty()) return true;
  if (!ReadLines(file, lines, error)) return false;
  for (const std::string& line : lines) {
    Ban ban;
    if (!ParseBan(line, ban)) {
      error = file.string() + ": '" + line.substr(0, 60) +
              "' must be a time (seconds since 1970, or ever), an address or account:NUMBER, and a reason";
      return false;
    }
    ban.number = ++m_newest;
    m_bans.push_back(std::move(ban));
  }
  return true;
}

const Ban& Bans::Add(Ban ban, std::uint64_t now, std::string& error) {
  DropOver(now);
  std::erase_if(m_bans, [&](const Ban& old) { return HaveSameSubject(old, ban); });
  ban.number = ++m_newest;
  m_bans.push_back(std::move(ban));
  Save(error);
  return m_bans.back();
}

bool Bans::Lift(std::uint32_t number, std::uint64_t now, std::string& error) {
  DropOver(now);
  if (std::erase_if(m_bans, [&](const Ban& ban) { return ban.number == number; }) == 0) return false;
  Save(error);
  return true;
}

bool Bans::LiftOf(const Ban& subject, std::uint64_t now, std::string& error) {
  DropOver(now);
  if (std::erase_if(m_bans, [&](const Ban& ban) { return HaveSameSubject(ban, subject); }) == 0) return false;
  Save(error);
  return true;
}

bool Bans::IsBanned(const transport::NetAddress& address, std::uint64_t account, std::uint64_t now) const {
  return std::any_of(m_bans.begin(), m_bans.end(), [&](const Ban& ban) {
    return !IsOver(ban, now) && (CoversAddress(ban, address) || (account != 0 && ban.account == account));
  });
}

const std::vector<Ban>& Bans::All(std::uint64_t now) {
  DropOver(now);
  return m_bans;
}

void Bans::DropOver(std::uint64_t now) {
  std::erase_if(m_bans, [&](const Ban& ban) { return IsOver(ban, now); });
}

void Bans::Save(std::string& error) const {
  if (m_file.empty()) return;
  std::vector<std::string> lines;
  for (const Ban& ban : m_bans) lines.push_back(WriteBan(ban));
  static_cast<void>(WriteLines(m_file, "wobble bans: UNTIL (seconds since 1970, or ever) WHOM REASON", lines, error));
}

}  // namespace wobble::admission
