// Integers are little-endian. A reader takes each field from the front and fails at the first that is not whole.
#include "protocol/transport/vestibule/handshake.h"

#include <algorithm>
#include <cassert>

namespace wobble::transport::vestibule {
namespace {

template <std::size_t size>
void Append(std::vector<std::uint8_t>& out, const std::array<std::uint8_t, size>& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

class ByteReader {
 public:
  ByteReader(std::span<const std::uint8_t> bytes, OpenKind kind) : m_left(bytes) {
    m_isGood = TakeByte() == static_cast<std::uint8_t>(kind);
  }
  explicit ByteReader(std::span<const std::uint8_t> bytes) : m_left(bytes) {}

  std::uint8_t TakeByte() {
    const auto byte = Take(1);
    return byte.empty() ? std::uint8_t{0} : byte[0];
  }
  std::uint32_t TakeNumber(std::size_t size) {
    std::uint32_t number = 0;
    const auto bytes = Take(size);
    for (std::size_t i = 0; i < bytes.size(); ++i) number |= std::uint32_t{bytes[i]} << 8 * i;
    return number;
  }
  template <std::size_t size>
  void Take(std::array<std::uint8_t, size>& field) {
    const auto bytes = Take(size);
    std::copy(bytes.begin(), bytes.end(), field.begin());
  }
  // Empty, and the reader is no longer good, when there are fewer.
  std::span<const std::uint8_t> Take(std::size_t size) {
    if (size > m_left.size()) m_isGood = false;
    if (!m_isGood) return {};
    const auto taken = m_left.first(size);
    m_left = m_left.subspan(size);
    return taken;
  }
  std::span<const std::uint8_t> TakeRest() { return Take(m_left.size()); }
  [[nodiscard]] bool IsGood() const { return m_isGood; }
  [[nodiscard]] bool IsAtEnd() const { return m_isGood && m_left.empty(); }

 private:
  std::span<const std::uint8_t> m_left;
  bool m_isGood = true;
};

}  // namespace

Echo MakeEcho(const Key& client) {
  Echo echo;
  std::copy_n(client.begin(), echo.size(), echo.begin());
  return echo;
}

void Write(const Request& request, std::vector<std::uint8_t>& out) {
  const std::size_t begin = out.size();
  out.push_back(static_cast<std::uint8_t>(OpenKind::kRequest));
  out.push_back(request.version);
  Append(out, request.client);
  out.resize(begin + kRequestBytes);
}

void Write(const Challenge& challenge, std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(OpenKind::kChallenge));
  Append(out, challenge.echo);
  out.push_back(challenge.epoch);
  Append(out, challenge.cookie);
  Append(out, challenge.server);
  Append(out, challenge.started);
  out.push_back(challenge.wantsCredential ? 1 : 0);
}

void Write(const OtherVersion& other, std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(OpenKind::kOtherVersion));
  Append(out, other.echo);
  out.push_back(other.version);
}

void Write(const Response& response, std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(OpenKind::kResponse));
  out.push_back(response.epoch);
  Append(out, response.cookie);
  Append(out, response.client);
  out.push_back(static_cast<std::uint8_t>(response.credential.size()));
  out.push_back(static_cast<std::uint8_t>(response.credential.size() >> 8U));
  out.insert(out.end(), response.credential.begin(), response.credential.end());
  out.insert(out.end(), response.first.begin(), response.first.end());
}

void Write(const Answer& answer, std::vector<std::uint8_t>& plain) {
  plain.push_back(static_cast<std::uint8_t>(answer.refusal));
  Append(plain, answer.reset);
  plain.insert(plain.end(), answer.ticket.begin(), answer.ticket.end());
}

void Write(const Reset& reset, std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(OpenKind::kReset));
  for (int i = 0; i < 3; ++i) out.push_back(static_cast<std::uint8_t>(reset.session >> 8 * i));
  Append(out, reset.token);
}

std::optional<Request> ReadRequest(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kRequestBytes) return {};
  ByteReader reader(datagram, OpenKind::kRequest);
  Request request;
  request.version = reader.TakeByte();
  reader.Take(request.client);
  return reader.IsGood() ? std::optional(request) : std::nullopt;
}

std::optional<Challenge> ReadChallenge(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram, OpenKind::kChallenge);
  Challenge challenge;
  reader.Take(challenge.echo);
  challenge.epoch = reader.TakeByte();
  reader.Take(challenge.cookie);
  reader.Take(challenge.server);
  reader.Take(challenge.started);
  challenge.wantsCredential = reader.TakeByte() != 0;
  return reader.IsAtEnd() ? std::optional(challenge) : std::nullopt;
}

std::optional<OtherVersion> ReadOtherVersion(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram, OpenKind::kOtherVersion);
  OtherVersion other;
  reader.Take(other.echo);
  other.version = reader.TakeByte();
  return reader.IsAtEnd() ? std::optional(other) : std::nullopt;
}

std::optional<Response> ReadResponse(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram, OpenKind::kResponse);
  Response response;
  response.epoch = reader.TakeByte();
  reader.Take(response.cookie);
  reader.Take(response.client);
  const std::uint32_t bytes = reader.TakeNumber(2);
  response.credential = reader.Take(bytes);
  response.first = reader.TakeRest();
  return reader.IsGood() ? std::optional(response) : std::nullopt;
}

std::optional<Answer> ReadAnswer(std::span<const std::uint8_t> plain) {
  ByteReader reader(plain);
  Answer answer;
  const std::uint8_t refusal = reader.TakeByte();
  reader.Take(answer.reset);
  const auto ticket = reader.TakeRest();
  const bool isGood =
      reader.IsGood() && ticket.size() <= kMaxCredentialBytes && refusal <= static_cast<std::uint8_t>(Refusal::kBanned);
  if (!isGood) return {};
  answer.ticket.assign(ticket.begin(), ticket.end());
  answer.refusal = static_cast<Refusal>(refusal);
  return answer;
}

std::optional<Reset> ReadReset(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram, OpenKind::kReset);
  Reset reset;
  reset.session = reader.TakeNumber(3);
  reader.Take(reset.token);
  return reader.IsAtEnd() ? std::optional(reset) : std::nullopt;
}

std::vector<std::uint8_t> WriteCredential(const Credential& credential) {
  assert(credential.bytes.size() <= kMaxCredentialBytes);
  std::vector<std::uint8_t> plain(1 + credential.bytes.size());
  plain[0] = static_cast<std::uint8_t>(credential.kind);
  std::copy(credential.bytes.begin(), credential.bytes.end(), plain.begin() + 1);
  return plain;
}

std::optional<Credential> ReadCredential(std::span<const std::uint8_t> plain) {
  ByteReader reader(plain);
  Credential credential;
  const std::uint8_t kind = reader.TakeByte();
  const auto bytes = reader.TakeRest();
  if (!reader.IsGood() || kind > static_cast<std::uint8_t>(Credential::Kind::kIntroduced) ||
      bytes.size() > kMaxCredentialBytes) {
    return {};
  }
  credential.kind = static_cast<Credential::Kind>(kind);
  credential.bytes.assign(bytes.begin(), bytes.end());
  return credential;
}

}  // namespace wobble::transport::vestibule
