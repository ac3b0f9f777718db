// The door with ENet behind it, in virtual time: datagrams of any bytes from a few addresses, callers who shake hands,
// and what a caller who is in may say to ENet, sealed as it should be.
#include "protocol/transport/enet_host.h"

#include <unistd.h>

#include <deque>
#include <map>
#include <memory>

#include "protocol/server_query.h"
#include "protocol/transport/vestibule/caller.h"
#include "protocol/transport/vestibule/door.h"
#include "tests/fuzz/feed.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

namespace vestibule = transport::vestibule;
using vestibule::Caller;
using vestibule::Door;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kCallers = 3;
constexpr std::size_t kMostVisitors = 4;

transport::NetAddress MakeAddress(std::uint8_t host) {
  return {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 192, 0, 2, host}, 1000};
}

// A caller with what it knows of ENet's connection.
struct Client {
  std::unique_ptr<Caller> caller = std::make_unique<Caller>(Caller::Settings{});
  unsigned peer = 0;
  Bytes sentTime{0, 0};
};

class Yard {
 public:
  Yard()
      : m_bridge{
            .receive = [this](ENetHost& host) { return Receive(host); },
            .send = [this](enet_uint32 connection, std::span<const ENetBuffer> parts) { Send(connection, parts); }} {
    m_host =
        transport::MakeHost(m_bridge, vestibule::CountSlots(kMostVisitors), true, protocol::kMaxPacketBytes, m_pairEnd);
    Require(m_host != nullptr);
  }
  ~Yard() {
    enet_host_destroy(m_host);
    close(m_pairEnd);
  }
  Yard(const Yard&) = delete;
  Yard& operator=(const Yard&) = delete;

  void Act(Feed& feed) {
    const std::uint8_t choice = feed.TakeByte();
    const std::size_t who = choice / 8 % kCallers;
    switch (choice % 8) {
      case 0:
        Deliver(who, feed.TakeSome());
        break;
      case 1: {  // the next datagram of a handshake
        Bytes datagram;
        m_now += 0.5;
        m_clients[who].caller->FindDue(m_now, datagram);
        if (!datagram.empty()) Deliver(who, datagram);
        break;
      }
      case 2:
        Say(who, MakeConnect(who));
        break;
      case 3:
        Say(who, MakePlain(who, {0x01, 0xFF, 0, 1, 0, 1, m_clients[who].sentTime[0], m_clients[who].sentTime[1]}));
        break;
      case 4:  // commands of ENet to the right peer
        Say(who, MakePlain(who, feed.TakeSome()));
        break;
      case 5:
        Say(who, feed.TakeSome());
        break;
      case 6:
        m_now += feed.TakeByte() / 8.0;
        m_door.RemoveOverdue(m_now, m_overdue);
        break;
      default:
        m_clients[who] = {};
        break;
    }
    Service();
    Require(m_door.CountVisitors() <= vestibule::CountSlots(kMostVisitors));
  }

 private:
  static enet_uint32 ConnectionOf(std::size_t who) { return 0x01010101U * static_cast<enet_uint32>(who + 1); }
  static void Append(Bytes& out, std::uint32_t number, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<std::uint8_t>(number >> 8 * i));
  }
  static Bytes MakeConnect(std::size_t who) {
    Bytes bytes{0x8F, 0xFF, 0, 1, 0, 0, 0, 0, 0x82, 0xFF, 0, 1, 0, 0, 0, 0};
    for (const std::uint32_t field : {transport::kMtu, 65536U, 3U, 0U, 0U, 5000U, 2U, 2U}) Append(bytes, field, 4);
    Append(bytes, ConnectionOf(who), 4);
    Append(bytes, 0, 4);
    return bytes;
  }
  [[nodiscard]] Bytes MakePlain(std::size_t who, const Bytes& commands) const {
    Bytes plain;
    Append(plain, m_clients[who].peer, 2);
    Append(plain, ConnectionOf(who), 4);
    plain.insert(plain.end(), commands.begin(), commands.end());
    return plain;
  }

  void Say(std::size_t who, const Bytes& plain) {
    Caller& caller = *m_clients[who].caller;
    if (!caller.CanSeal()) return;
    const std::span<const std::uint8_t> part = plain;
    Bytes datagram;
    caller.Seal({&part, 1}, m_now, datagram);
    Deliver(who, datagram);
  }
  void Deliver(std::size_t who, const Bytes& datagram) {
    const transport::NetAddress from = MakeAddress(static_cast<std::uint8_t>(1 + who));
    const Door::Result result = m_door.TakeDatagram(from, datagram, m_now);
    if (!result.plain.empty()) m_toEnet.push_back({result.visitor, {result.plain.begin(), result.plain.end()}});
    if (result.visitor != 0) m_callerOf[result.visitor] = who;
    if (!result.told.empty()) return TakeChallenge(from, datagram, Bytes(result.told.front()));
    if (result.answer.empty()) return;
    Require(result.answer.size() <= datagram.size() || result.visitor != 0);
    static_cast<void>(m_clients[who].caller->TakeDatagram(Bytes(result.answer.begin(), result.answer.end()), m_now));
  }

  // Nobody here can guess a challenge; who shows it is answered.
  void TakeChallenge(const transport::NetAddress& from, const Bytes& query, const Bytes& answer) {
    Require(answer.size() <= query.size());
    const auto challenge = protocol::ReadChallenge(answer);
    Require(challenge.has_value());
    const auto kind = protocol::ReadQuery(query)->kind;
    const auto told = m_door.TakeDatagram(from, protocol::MakeQuery({kind, *challenge}), m_now).told;
    for (const Bytes& each : told) Require(!protocol::ReadChallenge(each) && each.size() <= protocol::kMaxQueryBytes);
  }

  bool Receive(ENetHost& host) {
    if (m_toEnet.empty()) return false;
    m_present = std::move(m_toEnet.front());
    m_toEnet.pop_front();
    host.receivedData = m_present.plain.data();
    host.receivedDataLength = m_present.plain.size();
    host.receivedAddress = {m_present.visitor, 1};
    return true;
  }
  // What ENet answers tells the number that it has given to the peer.
  void Send(enet_uint32 connection, std::span<const ENetBuffer> parts) {
    Bytes plain;
    for (const ENetBuffer& part : parts) {
      const auto* data = static_cast<const std::uint8_t*>(part.data);
      plain.insert(plain.end(), data, data + part.dataLength);
    }
    const std::size_t head = (plain[0] & 0x80U) != 0 ? 8 : 6;
    if (plain.size() < head + 8 || (plain[head] & 0x0FU) != 3) return;
    for (std::size_t who = 0; who < kCallers; ++who) {
      enet_uint32 own;
      const Bytes bytes = [&] {
        Bytes number;
        Append(number, ConnectionOf(who), 4);
        return number;
      }();
      std::memcpy(&own, bytes.data(), sizeof own);
      if (own != connection) continue;
      m_clients[who].peer = static_cast<unsigned>(plain[head + 4] << 8U | plain[head + 5]) |
                            static_cast<unsigned>(plain[head + 7] & 3U) << 12U;
      m_clients[who].sentTime = {plain[2], plain[3]};
    }
  }
  void Service() {
    for (std::size_t left = m_toEnet.size(); left > 0; --left) static_cast<void>(write(m_pairEnd, "x", 1));
    ENetEvent event;
    while (enet_host_service(m_host, &event, 0) > 0) {
      if (event.type == ENET_EVENT_TYPE_RECEIVE) enet_packet_destroy(event.packet);
    }
  }

  struct Passed {
    vestibule::VisitorId visitor;
    Bytes plain;
  };
  Door m_door{[] {
    Door::Settings settings;
    settings.identity = vestibule::MakeKeyPair(vestibule::Key{1});
    settings.maxVisitors = kMostVisitors;
    settings.pictures = std::make_shared<vestibule::PictureSlot>();
    settings.pictures->Put(std::make_unique<const protocol::ServerPicture>(
        protocol::ServerPicture{.named = std::vector<protocol::ServerPicture::Player>(200)}));
    return settings;
  }()};
  transport::Bridge m_bridge;
  ENetHost* m_host = nullptr;
  int m_pairEnd = -1;
  std::array<Client, kCallers> m_clients;
  std::map<vestibule::VisitorId, std::size_t> m_callerOf;
  std::deque<Passed> m_toEnet;
  Passed m_present;
  std::vector<vestibule::VisitorId> m_overdue;
  double m_now = 1;
};

void FuzzOne(std::span<const std::uint8_t> bytes) {
  static const bool isReady = vestibule::InitialiseSodium() && transport::InitialiseEnet();
  Require(isReady);
  Feed feed(bytes);
  Yard yard;
  for (int i = 0; i < 200 && !feed.IsEmpty(); ++i) yard.Act(feed);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne({data, size});
  return 0;
}
