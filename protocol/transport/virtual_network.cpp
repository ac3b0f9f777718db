// Links on virtual time.
//
// Each link and direction has its own generators, and each unreliable message takes the same number of draws whatever
// the conditions are: one client's traffic does not change another's, and more loss loses a superset. An unreliable
// message gets its time of arrival, or none, when it is sent. A reliable one is repeated after a loss, with a time-out
// that doubles as ENet's does; messages are handed over in order, so a loss delays all behind it. Opening and closing
// travel like reliable messages, so nothing overtakes them.
#include "protocol/transport/virtual_network.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <deque>
#include <limits>
#include <map>
#include <utility>

#include "protocol/random.h"
#include "protocol/transport/link_emulation.h"

namespace wobble::transport {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kCloseTimeout = 3;        // seconds, as over ENet
constexpr double kGuessedRoundTrip = 0.5;  // seconds, as ENet's until one has been measured
constexpr ConnectionId kClientConnection = 1;

enum class Side : std::uint8_t { kServer = 0, kClient = 1 };
constexpr Side OtherSide(Side side) { return side == Side::kServer ? Side::kClient : Side::kServer; }
constexpr std::size_t IndexOf(Side side) { return static_cast<std::size_t>(side); }

enum class Content : std::uint8_t { kOpen, kAccept, kRefuse, kClose, kClosed, kMessage };

struct Parcel {
  Content content = Content::kMessage;
  Channel channel = Channel::kControl;
  std::vector<std::uint8_t> bytes;
};

// A reliable parcel that has not been handed to its receiver.
struct Pending {
  Parcel parcel;
  double nextTry;
  double timeout = 0;       // seconds from nextTry to the try after it; 0 before the first try
  double arrival = kNever;  // of the try that got through
};

// One direction of one link.
struct Way {
  explicit Way(std::uint64_t seed) : unreliable(seed), reliableRandom(~seed) {}
  LinkDirection unreliable;
  protocol::Random reliableRandom;  // separate, since the number of retransmissions varies
  std::deque<Pending> pending;
  double lastRelease = 0;
};

// One side's view of its connection.
enum class Phase : std::uint8_t { kNone, kConnecting, kOpen, kClosing, kGone };
struct End {
  Phase phase = Phase::kNone;
  double deadline = kNever;  // of connecting or closing
};

struct Link {
  Link(std::uint64_t toServerSeed, std::uint64_t toClientSeed) : ways{Way(toServerSeed), Way(toClientSeed)} {}
  std::array<Way, 2> ways;  // by the side that receives
  std::array<End, 2> ends;  // by side
};

}  // namespace

struct VirtualNetwork::State {
  explicit State(const VirtualNetworkOptions& networkOptions) : options(networkOptions) {}

  std::size_t AddLink();
  bool TryTrip(Side to, protocol::Random& random, double at, double& trip) const;
  [[nodiscard]] double RoundTrip() const;
  void SendReliably(std::size_t link, Side to, Parcel parcel, double now);
  void SendUnreliably(std::size_t link, Side to, Parcel parcel, double now);
  void Retry(Side to, Way& way, double now);
  void Release(std::size_t link, Side to, double now);

  // The order of handing over: by time, then by the order of sending.
  struct Key {
    double arrival;
    std::uint64_t number;
    bool operator<(const Key& other) const {
      return std::pair(arrival, number) < std::pair(other.arrival, other.number);
    }
  };
  struct Arrival {
    std::size_t link;
    Parcel parcel;
  };
  using Inbox = std::map<Key, Arrival>;
  Inbox& InboxOf(std::size_t link, Side side) { return side == Side::kServer ? serverInbox : clientInboxes[link]; }

  VirtualNetworkOptions options;
  std::array<LinkConditions, 2> conditions;  // by the side that receives
  std::array<LinkCounts, 2> counts;          // likewise
  bool isBlack = false;
  bool hasServer = false;
  std::vector<Link> links;  // index + 1 is the server's id of it
  Inbox serverInbox;
  std::vector<Inbox> clientInboxes;  // by link
  std::uint64_t parcels = 0;
};

namespace {

// An endpoint of either side; a client has one link, the server all.
class VirtualEndpoint final : public Transport {
 public:
  VirtualEndpoint(std::shared_ptr<VirtualNetwork::State> state, Side side, std::size_t link)
      : m_state(std::move(state)), m_side(side), m_link(link) {}

  ~VirtualEndpoint() override {
    for (std::size_t link = FirstLink(); link < EndLink(); ++link) {
      const Phase phase = EndOf(link).phase;
      if (phase != Phase::kNone && phase != Phase::kGone) SendContent(link, Content::kClose);
      EndOf(link).phase = Phase::kGone;
    }
  }

  void Poll(double now, const Sink& sink) override;
  [[nodiscard]] SendResult Send(ConnectionId connection, Channel channel,
                                std::span<const std::uint8_t> message) override;
  void Disconnect(ConnectionId connection) override;
  void Flush() override {}  // messages leave at once
  [[nodiscard]] Statistics ReadStatistics() const override { return m_statistics; }
  [[nodiscard]] double ReadRoundTrip(ConnectionId) const override { return m_state->RoundTrip(); }

 private:
  std::size_t FirstLink() const { return m_side == Side::kServer ? 0 : m_link; }
  std::size_t EndLink() const { return m_side == Side::kServer ? m_state->links.size() : m_link + 1; }
  End& EndOf(std::size_t link) { return m_state->links[link].ends[IndexOf(m_side)]; }
  ConnectionId IdOf(std::size_t link) const {
    return m_side == Side::kServer ? static_cast<ConnectionId>(link + 1) : kClientConnection;
  }
  End* FindEnd(ConnectionId connection, std::size_t& link);
  void SendContent(std::size_t link, Content content) {
    m_state->SendReliably(link, OtherSide(m_side), {content, Channel::kControl, {}}, m_now);
  }
  void Begin();
  void GiveUpOverdue(const Sink& sink);
  void Take(std::size_t link, const Parcel& parcel, const Sink& sink);
  void Answer(std::size_t link, End& end, const Sink& sink);
  void Leave(std::size_t link, const Sink& sink);
  bool IsFull() const;

  std::shared_ptr<VirtualNetwork::State> m_state;
  Side m_side;
  std::size_t m_link;  // of a client
  double m_now = 0;
  bool m_hasPolled = false;
  bool m_isPolling = false;
  Statistics m_statistics;
};

End* VirtualEndpoint::FindEnd(ConnectionId connection, std::size_t& link) {
  const bool exists = m_side == Side::kServer ? connection >= 1 && connection <= m_state->links.size()
                                              : connection == kClientConnection;
  if (!exists) return nullptr;
  link = m_side == Side::kServer ? connection - 1 : m_link;
  End& end = EndOf(link);
  return end.phase == Phase::kNone || end.phase == Phase::kGone ? nullptr : &end;
}

void VirtualEndpoint::Begin() {
  m_hasPolled = true;
  if (m_side == Side::kServer) return;
  End& end = EndOf(m_link);
  if (end.phase != Phase::kConnecting) return;
  end.deadline = std::min(end.deadline, m_now + m_state->options.connectTimeout);
  SendContent(m_link, Content::kOpen);
}

void VirtualEndpoint::GiveUpOverdue(const Sink& sink) {
  for (std::size_t link = FirstLink(); link < EndLink(); ++link) {
    if (EndOf(link).deadline > m_now) continue;
    if (EndOf(link).phase == Phase::kConnecting) SendContent(link, Content::kClose);
    Leave(link, sink);
  }
}

void VirtualEndpoint::Poll(double now, const Sink& sink) {
  assert(!m_isPolling && (!m_hasPolled || now >= m_now));
  m_isPolling = true;
  m_now = now;
  if (!m_hasPolled) Begin();
  GiveUpOverdue(sink);
  for (std::size_t link = FirstLink(); link < EndLink(); ++link) m_state->Release(link, m_side, now);
  for (;;) {
    // Looked up anew each time: the sink may make a client, which moves the inboxes.
    VirtualNetwork::State::Inbox& inbox = m_state->InboxOf(m_link, m_side);
    if (inbox.empty() || inbox.begin()->first.arrival > now) break;
    const auto arrived = inbox.extract(inbox.begin());
    Take(arrived.mapped().link, arrived.mapped().parcel, sink);
  }
  m_isPolling = false;
}

bool VirtualEndpoint::IsFull() const {
  const auto isTaken = [](const Link& link) {
    const Phase phase = link.ends[IndexOf(Side::kServer)].phase;
    return phase == Phase::kOpen || phase == Phase::kClosing;
  };
  const auto taken = std::count_if(m_state->links.begin(), m_state->links.end(), isTaken);
  return static_cast<std::size_t>(taken) >= m_state->options.maxConnections;
}

// The server's answer to a client that asks to be connected.
void VirtualEndpoint::Answer(std::size_t link, End& end, const Sink& sink) {
  if (end.phase != Phase::kNone) return;
  if (IsFull()) {
    end.phase = Phase::kGone;
    SendContent(link, Content::kRefuse);
    return;
  }
  end.phase = Phase::kOpen;
  SendContent(link, Content::kAccept);
  sink({.kind = Event::Kind::kConnected, .connection = IdOf(link)});
}

void VirtualEndpoint::Take(std::size_t link, const Parcel& parcel, const Sink& sink) {
  End& end = EndOf(link);
  switch (parcel.content) {
    case Content::kOpen:
      Answer(link, end, sink);
      break;
    case Content::kAccept:
      if (end.phase != Phase::kConnecting) break;
      end = {Phase::kOpen, kNever};
      sink({.kind = Event::Kind::kConnected, .connection = IdOf(link)});
      break;
    case Content::kRefuse:
    case Content::kClosed:
      Leave(link, sink);
      break;
    case Content::kClose:
      if (end.phase == Phase::kOpen || end.phase == Phase::kClosing) SendContent(link, Content::kClosed);
      Leave(link, sink);
      break;
    case Content::kMessage:
      if (end.phase != Phase::kOpen) break;
      m_statistics.bytesIn += parcel.bytes.size();
      sink({.kind = Event::Kind::kMessage, .connection = IdOf(link), .channel = parcel.channel, .bytes = parcel.bytes});
      break;
  }
}

// Ends the connection; a sink that was told of it is told of its end.
void VirtualEndpoint::Leave(std::size_t link, const Sink& sink) {
  End& end = EndOf(link);
  const bool isKnown = end.phase != Phase::kNone && end.phase != Phase::kGone;
  end = {Phase::kGone, kNever};
  if (isKnown) sink({.kind = Event::Kind::kDisconnected, .connection = IdOf(link)});
}

SendResult VirtualEndpoint::Send(ConnectionId connection, Channel channel, std::span<const std::uint8_t> message) {
  assert(static_cast<std::size_t>(channel) < kChannelCount);
  std::size_t link = 0;
  const End* end = FindEnd(connection, link);
  if (end == nullptr) return SendResult::kUnknownConnection;
  const std::size_t maxControlBytes =
      m_side == Side::kServer ? protocol::kMaxServerMessageBytes : protocol::kMaxClientMessageBytes;
  const bool isControl = channel == Channel::kControl;
  if (message.size() > (isControl ? maxControlBytes : protocol::kMaxPacketBytes)) return SendResult::kTooLarge;
  if (end->phase != Phase::kOpen) return SendResult::kFailed;

  m_statistics.bytesOut += message.size();
  Parcel parcel{Content::kMessage, channel, {message.begin(), message.end()}};
  if (isControl) {
    m_state->SendReliably(link, OtherSide(m_side), std::move(parcel), m_now);
  } else {
    m_state->SendUnreliably(link, OtherSide(m_side), std::move(parcel), m_now);
  }
  return SendResult::kQueued;
}

void VirtualEndpoint::Disconnect(ConnectionId connection) {
  std::size_t link = 0;
  End* end = FindEnd(connection, link);
  if (end == nullptr || end->phase == Phase::kClosing) return;
  if (end->phase == Phase::kConnecting) {  // there is nothing to wait for: the event comes with the next Poll
    end->deadline = -kNever;
    return;
  }
  *end = {Phase::kClosing, m_now + kCloseTimeout};
  SendContent(link, Content::kClose);
}

}  // namespace

std::size_t VirtualNetwork::State::AddLink() {
  const std::size_t link = links.size();
  const LinkSeeds seeds = MakeLinkSeeds(options.seed, link);
  links.emplace_back(seeds.toServer, seeds.toClient);
  clientInboxes.emplace_back();
  links[link].ends[IndexOf(Side::kClient)].phase = Phase::kConnecting;
  return link;
}

// One try of a reliable parcel: whether it gets through, and how long it then takes.
bool VirtualNetwork::State::TryTrip(Side to, protocol::Random& random, double at, double& trip) const {
  const LinkConditions& link = conditions[IndexOf(to)];
  const double lossDraw = random.NextShare();
  trip = link.delay + link.jitter * random.NextShare();
  const bool black = isBlack || IsBlack(link.blackout, at) || IsBlack(link.blackout, at + trip);
  return !black && lossDraw >= link.loss;
}

// The round trip that a transport would measure on average.
double VirtualNetwork::State::RoundTrip() const {
  double seconds = 0;
  for (const LinkConditions& way : conditions) seconds += way.delay + way.jitter / 2;
  return seconds;
}

void VirtualNetwork::State::SendUnreliably(std::size_t link, Side to, Parcel parcel, double now) {
  const Fate fate = links[link].ways[IndexOf(to)].unreliable.Decide(conditions[IndexOf(to)], now, parcel.bytes.size());
  LinkCounts& count = counts[IndexOf(to)];
  ++count.sent;
  if (isBlack || fate.copies == 0) {
    ++count.lost;
    return;
  }
  if (fate.isHeldBack) ++count.heldBack;
  if (fate.copies == 2) ++count.duplicated;
  for (std::size_t copy = 0; copy < fate.copies; ++copy) {
    InboxOf(link, to).emplace(Key{fate.due[copy], ++parcels}, Arrival{link, parcel});
  }
}

void VirtualNetwork::State::SendReliably(std::size_t link, Side to, Parcel parcel, double now) {
  Way& way = links[link].ways[IndexOf(to)];
  way.pending.push_back({std::move(parcel), now});
  Retry(to, way, now);
}

// Makes every try that is due. A sender notices a loss only by the missing acknowledgement, hence the round trip.
void VirtualNetwork::State::Retry(Side to, Way& way, double now) {
  const LinkConditions& conditionsTo = conditions[IndexOf(to)];
  for (Pending& waiting : way.pending) {
    while (waiting.arrival == kNever && waiting.nextTry <= now) {
      double trip = 0;
      if (TryTrip(to, way.reliableRandom, waiting.nextTry, trip)) {
        waiting.arrival = waiting.nextTry + trip;
        break;
      }
      const bool isHandshake = waiting.parcel.content == Content::kOpen || waiting.parcel.content == Content::kAccept;
      const double first = isHandshake ? kGuessedRoundTrip : 2 * (conditionsTo.delay + conditionsTo.jitter) + 0.05;
      const double longest = std::max(first, FindLongestRetry(isHandshake ? kGuessedRoundTrip : RoundTrip()));
      waiting.timeout = waiting.timeout == 0 ? first : std::min(2 * waiting.timeout, longest);
      waiting.nextTry += waiting.timeout;
    }
  }
}

// Moves reliable parcels that have arrived, up to the first that has not, to their receiver's inbox.
void VirtualNetwork::State::Release(std::size_t link, Side to, double now) {
  Way& way = links[link].ways[IndexOf(to)];
  Retry(to, way, now);
  while (!way.pending.empty() && way.pending.front().arrival <= now) {
    way.lastRelease = std::max(way.lastRelease, way.pending.front().arrival);
    InboxOf(link, to).emplace(Key{way.lastRelease, ++parcels}, Arrival{link, std::move(way.pending.front().parcel)});
    way.pending.pop_front();
  }
}

VirtualNetwork::VirtualNetwork(const VirtualNetworkOptions& options) : m_state(std::make_shared<State>(options)) {}
VirtualNetwork::~VirtualNetwork() = default;

std::unique_ptr<Transport> VirtualNetwork::MakeServer() {
  assert(!m_state->hasServer);
  m_state->hasServer = true;
  return std::make_unique<VirtualEndpoint>(m_state, Side::kServer, 0);
}

std::unique_ptr<Transport> VirtualNetwork::MakeClient() {
  return std::make_unique<VirtualEndpoint>(m_state, Side::kClient, m_state->AddLink());
}

void VirtualNetwork::SetConditions(const LinkConditions& bothWays) { SetConditions(bothWays, bothWays); }

void VirtualNetwork::SetConditions(const LinkConditions& toServer, const LinkConditions& toClients) {
  assert(ValidateLinkConditions(toServer).empty() && ValidateLinkConditions(toClients).empty());
  m_state->conditions[IndexOf(Side::kServer)] = toServer;
  m_state->conditions[IndexOf(Side::kClient)] = toClients;
}

void VirtualNetwork::SetBlackout(bool isBlack) { m_state->isBlack = isBlack; }

LinkCounts VirtualNetwork::CountsToServer() const { return m_state->counts[IndexOf(Side::kServer)]; }
LinkCounts VirtualNetwork::CountsToClients() const { return m_state->counts[IndexOf(Side::kClient)]; }

}  // namespace wobble::transport
