#include "protocol/server_query.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <string_view>

namespace wobble::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kWhole = 0xFFFFFFFF, kPart = 0xFFFFFFFE;
constexpr std::string_view kInfoWords{"Source Engine Query\0", 20};
constexpr std::uint8_t kChallenge = 'A', kInfo = 'I', kPlayers = 'D', kRules = 'E';
constexpr std::size_t kHeadBytes = 5;  // kWhole, and the kind
constexpr std::size_t kChallengeBytes = kHeadBytes + 4;

// Of kInfo. The version of Valve's protocol; what kind of server on what system; which fields follow.
constexpr std::uint8_t kVersionOfQuery = 17;
constexpr std::uint8_t kDedicated = 'd', kLinux = 'l';
constexpr std::uint8_t kHasPort = 0x80, kHasKeywords = 0x20;
constexpr std::string_view kFolder = "wobble", kGame = "wobble: soft bodies";

// The head of a part: kPart, number, parts, this part, and the size at which answers are parted.
constexpr std::size_t kPartHeadBytes = 12;
constexpr std::size_t kPartBytes = kMaxQueryBytes - kPartHeadBytes;
// They are counted in a byte: 255 names of 200 bytes are 39 parts.
constexpr std::size_t kMostParts = 255;

void Append(Bytes& out, std::uint64_t number, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

void Append(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
  out.push_back(0);
}

void AppendHead(Bytes& out, std::uint8_t kind) {
  Append(out, kWhole, 4);
  out.push_back(kind);
}

std::uint8_t Count(std::size_t number) { return static_cast<std::uint8_t>(std::min(number, kMaxCountedPlayers)); }

// Reads from the front; false once something was missing.
class QueryReader {
 public:
  explicit QueryReader(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {}

  std::uint64_t TakeNumber(std::size_t bytes) {
    std::uint64_t number = 0;
    if (bytes > m_bytes.size()) return m_isWhole = false, number;
    for (std::size_t i = 0; i < bytes; ++i) number |= std::uint64_t{m_bytes[i]} << 8 * i;
    m_bytes = m_bytes.subspan(bytes);
    return number;
  }
  std::string TakeText() {
    const auto end = std::find(m_bytes.begin(), m_bytes.end(), 0);
    if (end == m_bytes.end()) return m_isWhole = false, "";
    std::string text(m_bytes.begin(), end);
    m_bytes = m_bytes.subspan(text.size() + 1);
    return text;
  }
  [[nodiscard]] bool IsWhole() const { return m_isWhole; }

 private:
  std::span<const std::uint8_t> m_bytes;
  bool m_isWhole = true;
};

void AppendInfo(Bytes& out, const ServerPicture& picture) {
  AppendHead(out, kInfo);
  out.push_back(kVersionOfQuery);
  Append(out, picture.name);
  Append(out, picture.scene);
  Append(out, kFolder);
  Append(out, kGame);
  Append(out, 0, 2);  // number of the game at Steam: it is not there
  out.push_back(Count(picture.players));
  out.push_back(Count(picture.maxPlayers));
  out.push_back(0);  // bots: they are clients like others
  out.push_back(kDedicated);
  out.push_back(kLinux);
  out.push_back(picture.isPrivate ? 1 : 0);
  out.push_back(0);  // not guarded by Valve
  Append(out, picture.version);
  out.push_back(kHasPort | kHasKeywords);
  Append(out, picture.port, 2);
  Append(out, kFolder);
}

void AppendPlayers(Bytes& out, const ServerPicture& picture) {
  AppendHead(out, kPlayers);
  const std::size_t count = Count(picture.named.size());
  out.push_back(static_cast<std::uint8_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(0);  // its number, which is 0 for all by custom
    Append(out, picture.named[i].name);
    Append(out, picture.named[i].score, 4);
    const auto seconds = static_cast<float>(picture.named[i].seconds);
    std::uint32_t bits;
    std::memcpy(&bits, &seconds, sizeof bits);
    Append(out, bits, 4);
  }
}

void AppendRules(Bytes& out, const ServerPicture& picture) {
  AppendHead(out, kRules);
  Append(out, picture.rules.size(), 2);
  for (const auto& [name, value] : picture.rules) {
    Append(out, name);
    Append(out, value);
  }
}

}  // namespace

std::optional<Query> ReadQuery(std::span<const std::uint8_t> datagram) {
  QueryReader reader(datagram);
  if (reader.TakeNumber(4) != kWhole) return {};
  const std::uint64_t kind = reader.TakeNumber(1);
  if (!reader.IsWhole()) return {};
  Query query{.kind = static_cast<QueryKind>(kind), .challenge = {}};
  if (query.kind == QueryKind::kInfo) {
    const std::size_t begin = kHeadBytes, size = kInfoWords.size();
    if (datagram.size() < begin + size || std::memcmp(&datagram[begin], kInfoWords.data(), size) != 0) return {};
    reader = QueryReader(datagram.subspan(begin + size));
  } else if (query.kind != QueryKind::kPlayers && query.kind != QueryKind::kRules) {
    return {};
  }
  const auto challenge = static_cast<std::uint32_t>(reader.TakeNumber(4));
  if (reader.IsWhole()) query.challenge = challenge;
  if (!query.challenge && query.kind != QueryKind::kInfo) return {};
  return query;
}

std::vector<std::uint8_t> MakeQuery(const Query& query) {
  Bytes out;
  AppendHead(out, static_cast<std::uint8_t>(query.kind));
  if (query.kind == QueryKind::kInfo) Append(out, kInfoWords.substr(0, kInfoWords.size() - 1));
  if (query.challenge || query.kind != QueryKind::kInfo) Append(out, query.challenge.value_or(kWhole), 4);
  return out;
}

void WriteChallenge(std::uint32_t challenge, std::vector<std::uint8_t>& datagram) {
  datagram.clear();
  AppendHead(datagram, kChallenge);
  Append(datagram, challenge, 4);
}

std::optional<std::uint32_t> ReadChallenge(std::span<const std::uint8_t> datagram) {
  QueryReader reader(datagram);
  if (datagram.size() < kChallengeBytes || reader.TakeNumber(4) != kWhole || reader.TakeNumber(1) != kChallenge) {
    return {};
  }
  return static_cast<std::uint32_t>(reader.TakeNumber(4));
}

std::vector<std::vector<std::uint8_t>> MakeAnswer(QueryKind kind, const ServerPicture& picture, std::uint32_t number) {
  Bytes whole;
  switch (kind) {
    case QueryKind::kInfo:
      AppendInfo(whole, picture);
      break;
    case QueryKind::kPlayers:
      AppendPlayers(whole, picture);
      break;
    case QueryKind::kRules:
      AppendRules(whole, picture);
      break;
  }
  if (whole.size() <= kMaxQueryBytes) return {std::move(whole)};
  const std::size_t count = (whole.size() + kPartBytes - 1) / kPartBytes;
  assert(count <= kMostParts);
  std::vector<Bytes> parts(count);
  for (std::size_t i = 0; i < count; ++i) {
    Append(parts[i], kPart, 4);
    Append(parts[i], number & 0x7FFFFFFFU, 4);  // the highest bit would say that it is compressed
    parts[i].push_back(static_cast<std::uint8_t>(count));
    parts[i].push_back(static_cast<std::uint8_t>(i));
    Append(parts[i], kMaxQueryBytes, 2);
    const std::span<const std::uint8_t> rest = std::span(whole).subspan(i * kPartBytes);
    const auto bytes = rest.first(std::min(rest.size(), kPartBytes));
    parts[i].insert(parts[i].end(), bytes.begin(), bytes.end());
  }
  return parts;
}

std::optional<ServerPicture> ReadInfo(std::span<const std::uint8_t> datagram) {
  QueryReader reader(datagram);
  if (reader.TakeNumber(4) != kWhole || reader.TakeNumber(1) != kInfo) return {};
  ServerPicture picture;
  reader.TakeNumber(1);
  picture.name = reader.TakeText();
  picture.scene = reader.TakeText();
  reader.TakeText();
  reader.TakeText();
  reader.TakeNumber(2);
  picture.players = reader.TakeNumber(1);
  picture.maxPlayers = reader.TakeNumber(1);
  reader.TakeNumber(3);
  picture.isPrivate = reader.TakeNumber(1) != 0;
  reader.TakeNumber(1);
  picture.version = reader.TakeText();
  if (!reader.IsWhole()) return {};
  if ((reader.TakeNumber(1) & kHasPort) != 0) picture.port = static_cast<std::uint16_t>(reader.TakeNumber(2));
  return picture;
}

}  // namespace wobble::protocol
