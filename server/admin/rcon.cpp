#include "server/admin/rcon.h"

#include <span>
#include <utility>

namespace wobble::admin {
namespace {

namespace vestibule = transport::vestibule;

constexpr double kTries = 3;
constexpr double kTriesASecond = 1.0 / 60;  // after these

constexpr std::size_t kSizeBytes = 4;
constexpr std::size_t kHeadBytes = 8;  // id and type
constexpr std::size_t kMaxTextBytes = kMaxRconBytes - kMinRconBytes;

std::int32_t ReadNumber(std::string_view bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number |= std::uint32_t{static_cast<std::uint8_t>(bytes[i])} << 8 * i;
  return static_cast<std::int32_t>(number);
}

void AppendNumber(std::string& out, std::int32_t number) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(static_cast<std::uint32_t>(number) >> 8 * i));
}

void AppendPacket(std::string& out, std::int32_t id, RconType type, std::string_view text) {
  AppendNumber(out, static_cast<std::int32_t>(kMinRconBytes + text.size()));
  AppendNumber(out, id);
  AppendNumber(out, static_cast<std::int32_t>(type));
  out += text;
  out.append(2, '\0');
}

// How much of a text goes into one packet: whole lines, else whole characters, so that each can be read by itself.
std::size_t FindCut(std::string_view text) {
  if (text.size() <= kMaxTextBytes) return text.size();
  const std::size_t end = text.rfind('\n', kMaxTextBytes - 1);
  if (end != std::string_view::npos) return end + 1;
  std::size_t cut = kMaxTextBytes;
  while (cut > kMaxTextBytes - 4 && (static_cast<std::uint8_t>(text[cut]) & 0xC0U) == 0x80) --cut;
  return cut;
}

}  // namespace

RconGuard::RconGuard(std::string password, const vestibule::Key& hashKey)
    : m_password(std::move(password)), m_guesses(kTriesASecond, kTries, hashKey) {}

RconGuess RconGuard::Judge(const transport::NetAddress& from, std::string_view password, double now) {
  const transport::Subnet subnet = transport::FindSubnet(from);
  if (!m_guesses.Take(subnet, now)) return RconGuess::kShutOut;
  const auto bytesOf = [](std::string_view text) {
    return std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  };
  if (!vestibule::AreEqual(bytesOf(password), bytesOf(m_password))) return RconGuess::kWrong;
  m_guesses.Return(subnet);
  return RconGuess::kRight;
}

RconSession::Step RconSession::TakeNext(std::string& answer) {
  answer.clear();
  if (m_received.size() < kSizeBytes) return Step::kWaits;
  const auto size = static_cast<std::uint32_t>(ReadNumber(m_received));
  if (size < kMinRconBytes || size > kMaxRconBytes) return Step::kEnds;
  if (m_received.size() < kSizeBytes + size) return Step::kWaits;
  const std::string packet = m_received.substr(kSizeBytes, size);
  m_received.erase(0, kSizeBytes + size);
  const std::int32_t id = ReadNumber(packet);
  const std::int32_t type = ReadNumber(std::string_view(packet).substr(4));
  // Up to the first zero byte.
  const std::string text = packet.substr(kHeadBytes, packet.size() - kMinRconBytes).c_str();
  if (type == static_cast<std::int32_t>(RconType::kAuth)) return TakeAuth(id, text, answer);
  if (!m_isIn) {
    AppendPacket(answer, kRefusedRcon, RconType::kAuthResponse, "");
    return Step::kEnds;
  }
  std::string told;
  if (type == static_cast<std::int32_t>(RconType::kExecute)) {
    for (const std::string& line : m_obey(text)) told += line + "\n";
  } else if (type != static_cast<std::int32_t>(RconType::kValue)) {
    told = "unknown request " + std::to_string(type) + "\n";
  }
  std::string_view rest = told;
  do {
    const std::size_t cut = FindCut(rest);
    AppendPacket(answer, id, RconType::kValue, rest.substr(0, cut));
    rest.remove_prefix(cut);
  } while (!rest.empty());
  return Step::kAnswered;
}

RconSession::Step RconSession::TakeAuth(std::int32_t id, std::string_view password, std::string& answer) {
  const RconGuess guess = m_judge(password);
  m_isIn = guess == RconGuess::kRight;
  if (m_isIn) AppendPacket(answer, id, RconType::kValue, "");
  AppendPacket(answer, m_isIn ? id : kRefusedRcon, RconType::kAuthResponse, "");
  return guess == RconGuess::kShutOut ? Step::kEnds : Step::kAnswered;
}

}  // namespace wobble::admin
