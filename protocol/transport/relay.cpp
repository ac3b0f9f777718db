// Sockets around LinkDirection: a datagram that arrives gets its fate at once, waits in one queue ordered by time, and
// leaves.
//
// One thread, without a clock of its own. All sockets are in one epoll, which is waited for with ppoll: it counts in
// nanoseconds, where epoll_wait counts in milliseconds and would be late by up to one. Each turn takes a limited number
// of datagrams, so that those which are due do not wait for a flood to end.
//
// Memory is bounded: the number of clients, the bytes in the queue, and a silent address is forgotten with its socket.
// Clients live in slots. A datagram that waits for a client which has gone is recognised by the client's number.
#include "protocol/transport/relay.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

#include "protocol/transport/link_emulation.h"

namespace wobble::transport {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Datagrams taken from the players, taken from the server (and from one socket of it), and sent, before the clock is
// read again: at about 3 us each none of them waits for a millisecond.
constexpr int kTakenPerTurn = 64;
constexpr int kTakenPerSocket = 16;
constexpr int kSentPerTurn = 4 * kTakenPerTurn;

// Bytes that may wait: 500 clients at 384 kbit/s through 2 s of delay are 48 MB. kWaitingCost is added for each
// datagram, for its place in the queue.
constexpr std::size_t kMaxWaitingBytes = std::size_t{96} << 20;
constexpr std::size_t kWaitingCost = 96;

constexpr std::size_t kLargestDatagram = 65536;
// After a late tick a server sends to all of its clients at once, and the clients send at once as well.
constexpr int kSocketBytes = 4 * 1024 * 1024;

constexpr double kForgetEvery = 1;

// A file descriptor that is closed in the destructor.
class Handle {
 public:
  explicit Handle(int descriptor) : m_descriptor(descriptor) {}
  Handle(Handle&& other) noexcept : m_descriptor(std::exchange(other.m_descriptor, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(m_descriptor, other.m_descriptor);
    return *this;
  }
  ~Handle() {
    if (m_descriptor >= 0) close(m_descriptor);
  }
  [[nodiscard]] int Get() const { return m_descriptor; }
  [[nodiscard]] bool IsOpen() const { return m_descriptor >= 0; }

 private:
  int m_descriptor;
};

Handle OpenSocket() {
  Handle handle(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!handle.IsOpen()) return handle;
  for (const int option : {SO_RCVBUF, SO_SNDBUF}) {  // the system may silently give less, which is enough
    setsockopt(handle.Get(), SOL_SOCKET, option, &kSocketBytes, sizeof kSocketBytes);
  }
  return handle;
}

std::uint64_t KeyOf(const sockaddr_in& address) {
  return std::uint64_t{address.sin_addr.s_addr} << 16 | address.sin_port;
}

bool Resolve(const RelayOptions& options, sockaddr_in& address, std::string& error) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(options.serverHost.c_str(), nullptr, &wanted, &found) != 0 || found == nullptr) {
    error = "no IPv4 address is known for \"" + options.serverHost + "\"";
    return false;
  }
  std::memcpy(&address, found->ai_addr, sizeof address);
  freeaddrinfo(found);
  address.sin_port = htons(options.serverPort);
  return true;
}

struct Client {
  Client(std::uint64_t clientNumber, const sockaddr_in& source, Handle socket, LinkSeeds seeds)
      : number(clientNumber), address(source), upstream(std::move(socket)), up(seeds.toServer), down(seeds.toClient) {}
  std::uint64_t number;  // from 1, in the order in which addresses were first seen
  sockaddr_in address;
  Handle upstream;  // connected to the server
  LinkDirection up;
  LinkDirection down;
  double lastHeard = 0;  // from its address
};

struct Waiting {
  double due;
  std::uint64_t order;  // of arrival, for those due at the same moment
  std::size_t slot;
  std::uint64_t number;  // of the client that had the slot
  bool isUp;
  std::vector<std::uint8_t> bytes;
};
struct IsLater {
  bool operator()(const Waiting& a, const Waiting& b) const {
    return std::pair(a.due, a.order) > std::pair(b.due, b.order);
  }
};

// A std::priority_queue whose top can be moved out.
class WaitingQueue : public std::priority_queue<Waiting, std::vector<Waiting>, IsLater> {
 public:
  Waiting Take() {
    std::pop_heap(c.begin(), c.end(), comp);
    Waiting waiting = std::move(c.back());
    c.pop_back();
    return waiting;
  }
};

}  // namespace

void Lateness::Add(double seconds) {
  const double bucket = std::clamp(seconds * 1e4, 0.0, static_cast<double>(m_buckets.size() - 1));
  ++m_buckets[static_cast<std::size_t>(bucket)];
  ++m_count;
}

double Lateness::FindPercentileMs(double share) const {
  if (m_count == 0) return 0;
  std::uint64_t seen = 0;
  std::size_t bucket = 0;
  while (bucket + 1 < m_buckets.size()) {
    seen += m_buckets[bucket];
    if (static_cast<double>(seen) >= share * static_cast<double>(m_count)) break;
    ++bucket;
  }
  return static_cast<double>(bucket + 1) / 10;
}

struct Relay::Impl {
  explicit Impl(const RelayOptions& relayOptions) : options(relayOptions) {}

  bool TakeArrivals(double now);
  int TakeFromClients(int most, double now);
  int TakeFromServer(std::size_t slot, int most, double now);
  Client* FindOrMakeClient(const sockaddr_in& source, double now, std::size_t& slot);
  bool Watch(int descriptor, std::uint64_t tag) const;
  void Enter(Client& client, std::size_t slot, bool isUp, std::size_t length, double now);
  bool SendDue(double now);
  bool SendOut(const Client& client, const Waiting& waiting) const;
  void ForgetIdle(double now);

  RelayOptions options;
  sockaddr_in server{};
  std::uint16_t port = 0;
  Handle epoll{-1};
  Handle listener{-1};
  std::vector<std::unique_ptr<Client>> slots;  // null: free
  std::vector<std::size_t> freeSlots;
  std::unordered_map<std::uint64_t, std::size_t> slotsByAddress;
  WaitingQueue waiting;
  std::size_t waitingBytes = 0;
  std::uint64_t arrivals = 0;
  double begin = -kNever;  // the first Run's now
  double nextForget = 0;
  RelayCounts counts;
  std::vector<std::uint8_t> buffer = std::vector<std::uint8_t>(kLargestDatagram);
};

namespace {

// In epoll's data for the listener; clients have their slot's number plus 1.
constexpr std::uint64_t kListenerTag = 0;

}  // namespace

bool Relay::Impl::Watch(int descriptor, std::uint64_t tag) const {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = tag;
  return epoll_ctl(epoll.Get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
}

Client* Relay::Impl::FindOrMakeClient(const sockaddr_in& source, double now, std::size_t& slot) {
  const auto found = slotsByAddress.find(KeyOf(source));
  if (found != slotsByAddress.end()) {
    slot = found->second;
    return slots[slot].get();
  }
  if (counts.clients >= options.maxClients) return nullptr;
  Handle upstream = OpenSocket();
  const bool isConnected =
      upstream.IsOpen() && connect(upstream.Get(), reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0;
  slot = freeSlots.empty() ? slots.size() : freeSlots.back();
  if (!isConnected || !Watch(upstream.Get(), slot + 1)) return nullptr;

  if (freeSlots.empty()) {
    slots.emplace_back();
  } else {
    freeSlots.pop_back();
  }
  const std::uint64_t number = ++counts.clientsEver;
  slots[slot] = std::make_unique<Client>(number, source, std::move(upstream), MakeLinkSeeds(options.seed, number));
  slots[slot]->lastHeard = now;
  slotsByAddress[KeyOf(source)] = slot;
  ++counts.clients;
  return slots[slot].get();
}

// Takes datagrams of players. Returns how many; fewer than `most` when there were no more.
int Relay::Impl::TakeFromClients(int most, double now) {
  for (int taken = 0; taken < most; ++taken) {
    sockaddr_in source{};
    socklen_t size = sizeof source;
    const ssize_t length =
        recvfrom(listener.Get(), buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&source), &size);
    if (length < 0) return taken;
    std::size_t slot = 0;
    Client* client = FindOrMakeClient(source, now, slot);
    if (client == nullptr) {
      ++counts.clientsRefused;
      continue;
    }
    client->lastHeard = now;
    Enter(*client, slot, true, static_cast<std::size_t>(length), now);
  }
  return most;
}

// The same for datagrams of the server. A missing server shows as an error of the socket, which is cleared by reading.
int Relay::Impl::TakeFromServer(std::size_t slot, int most, double now) {
  Client& client = *slots[slot];
  for (int taken = 0; taken < most; ++taken) {
    const ssize_t length = recv(client.upstream.Get(), buffer.data(), buffer.size(), 0);
    if (length < 0) return taken;
    Enter(client, slot, false, static_cast<std::size_t>(length), now);
  }
  return most;
}

void Relay::Impl::Enter(Client& client, std::size_t slot, bool isUp, std::size_t length, double now) {
  RelayDirectionCounts& count = isUp ? counts.up : counts.down;
  const LinkConditions& conditions = isUp ? options.link.up : options.link.down;
  const Fate fate = (isUp ? client.up : client.down).Decide(conditions, now - begin, length);
  ++count.received;
  count.bytesIn += length;
  count.lost += fate.ending == Fate::Ending::kLost ? 1 : 0;
  count.overRate += fate.ending == Fate::Ending::kOverRate ? 1 : 0;
  count.blackedOut += fate.ending == Fate::Ending::kBlackedOut ? 1 : 0;
  count.reordered += fate.isHeldBack ? 1 : 0;
  count.duplicated += fate.copies == 2 ? 1 : 0;
  for (std::size_t copy = 0; copy < fate.copies; ++copy) {
    if (waitingBytes + length + kWaitingCost > kMaxWaitingBytes) {
      ++count.unsent;
      continue;
    }
    waitingBytes += length + kWaitingCost;
    waiting.push({begin + fate.due[copy], ++arrivals, slot, client.number, isUp,
                  std::vector<std::uint8_t>(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(length))});
  }
}

// Takes what has arrived; true when there may be more. The one socket of all players comes first and may take as much
// as all sockets to the server together, since its buffer is the one that overflows. epoll serves the others in turn,
// so none starves.
bool Relay::Impl::TakeArrivals(double now) {
  bool hasMore = TakeFromClients(kTakenPerTurn, now) == kTakenPerTurn;
  std::array<epoll_event, kTakenPerTurn> events{};
  const int ready = epoll_wait(epoll.Get(), events.data(), kTakenPerTurn, 0);
  int left = kTakenPerTurn;
  for (int i = 0; i < ready && left > 0; ++i) {
    const std::uint64_t tag = events[static_cast<std::size_t>(i)].data.u64;
    if (tag == kListenerTag) continue;
    const int most = std::min(left, kTakenPerSocket);
    const int taken = TakeFromServer(tag - 1, most, now);
    hasMore |= taken == most;
    left -= taken;
  }
  return hasMore || ready == kTakenPerTurn;
}

bool Relay::Impl::SendOut(const Client& client, const Waiting& out) const {
  for (int tries = 0; tries < 2; ++tries) {
    const ssize_t sent = out.isUp ? send(client.upstream.Get(), out.bytes.data(), out.bytes.size(), 0)
                                  : sendto(listener.Get(), out.bytes.data(), out.bytes.size(), 0,
                                           reinterpret_cast<const sockaddr*>(&client.address), sizeof client.address);
    if (sent >= 0) return true;
    if (errno != ECONNREFUSED) return false;  // that is about an earlier one
  }
  return false;
}

// Sends datagrams that are due; true when more are due.
bool Relay::Impl::SendDue(double now) {
  for (int sent = 0; !waiting.empty() && waiting.top().due <= now; ++sent) {
    if (sent == kSentPerTurn) return true;
    const Waiting out = waiting.Take();
    waitingBytes -= out.bytes.size() + kWaitingCost;
    const Client* client = slots[out.slot].get();
    if (client == nullptr || client->number != out.number) continue;  // forgotten meanwhile
    RelayDirectionCounts& count = out.isUp ? counts.up : counts.down;
    counts.lateness.Add(now - out.due);
    if (SendOut(*client, out)) {
      ++count.passed;
      count.bytesOut += out.bytes.size();
    } else {
      ++count.unsent;
    }
  }
  return false;
}

void Relay::Impl::ForgetIdle(double now) {
  if (now < nextForget) return;
  nextForget = now + std::min(kForgetEvery, options.idleTimeout);
  for (std::size_t slot = 0; slot < slots.size(); ++slot) {
    if (slots[slot] == nullptr || now - slots[slot]->lastHeard < options.idleTimeout) continue;
    slotsByAddress.erase(KeyOf(slots[slot]->address));
    slots[slot].reset();
    freeSlots.push_back(slot);
    --counts.clients;
  }
}

Relay::Relay(std::unique_ptr<Impl> impl) : m_impl(std::move(impl)) {}
Relay::~Relay() = default;

std::unique_ptr<Relay> Relay::Open(const RelayOptions& options, std::string& error) {
  assert(ValidateLinkConditions(options.link.up).empty() && ValidateLinkConditions(options.link.down).empty());
  auto impl = std::make_unique<Impl>(options);
  if (!Resolve(options, impl->server, error)) return nullptr;
  impl->epoll = Handle(epoll_create1(EPOLL_CLOEXEC));
  impl->listener = OpenSocket();
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(options.port);
  if (inet_pton(AF_INET, options.host.c_str(), &own.sin_addr) != 1) {
    error = "'" + options.host + "' is no IPv4 address to listen at";
    return nullptr;
  }
  socklen_t size = sizeof own;
  const bool isOpen = impl->epoll.IsOpen() && impl->listener.IsOpen() &&
                      bind(impl->listener.Get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0 &&
                      getsockname(impl->listener.Get(), reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
                      impl->Watch(impl->listener.Get(), kListenerTag);
  if (!isOpen) {
    const std::string port = "port " + std::to_string(options.port) + " (UDP) ";
    error = errno == EADDRINUSE ? port + "is in use" : port + "cannot be opened: " + std::strerror(errno);
    return nullptr;
  }
  impl->port = ntohs(own.sin_port);
  return std::unique_ptr<Relay>(new Relay(std::move(impl)));
}

bool Relay::Run(double now) {
  if (m_impl->begin == -kNever) m_impl->begin = now;
  const bool hasArrivals = m_impl->TakeArrivals(now);
  const bool hasDue = m_impl->SendDue(now);
  m_impl->ForgetIdle(now);
  return !hasArrivals && !hasDue;
}

double Relay::NextDue() const { return m_impl->waiting.empty() ? kNever : m_impl->waiting.top().due; }

void Relay::Wait(double seconds) const {
  if (seconds <= 0) return;
  constexpr double kLongest = 3600;
  const double whole = std::floor(std::min(seconds, kLongest));
  timespec time{};
  time.tv_sec = static_cast<time_t>(whole);
  time.tv_nsec = static_cast<long>((std::min(seconds, kLongest) - whole) * 1e9);
  pollfd arrival{m_impl->epoll.Get(), POLLIN, 0};
  ppoll(&arrival, 1, &time, nullptr);
}

std::uint16_t Relay::ReadPort() const { return m_impl->port; }
const RelayCounts& Relay::ReadCounts() const { return m_impl->counts; }

}  // namespace wobble::transport
