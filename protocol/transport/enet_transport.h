// The Transport over ENet (UDP), for real servers and clients.
//
// ENet's datagrams are sealed, and go through a vestibule that keeps strangers out (vestibule/). A server has a thread
// for it; a client does all in Poll.
//
// ENet times its retransmissions by the wall clock; everything that this class promises about time (the connect
// timeout, how long a closing connection may linger) goes by the `now` of Poll.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/limits.h"
#include "protocol/transport/transport.h"
#include "protocol/transport/vestibule/door.h"

namespace wobble::transport {

struct ListenOptions {
  std::uint16_t port = 0;           // UDP; 0: the system picks a free one
  std::size_t maxConnections = 64;  // 1..kMaxListenConnections
  std::size_t maxPerAddress = 0;    // of one IP address; 0: maxConnections. A gateway's players share an address
  double datagramRate = 400;        // that one client may send, a second
  std::string host = {};            // the address to listen at; empty: every one of the machine, IPv6 and IPv4
  // The server's long-lived secret key, by which clients know it again; nullopt: one for this run only.
  std::optional<vestibule::Key> secretKey = {};
  std::shared_ptr<vestibule::Judge> judge = {};  // asked on the vestibule's thread; null: everybody may come in
  // Where the pictures of the world come from that are told to strangers who ask; null: nothing is told.
  std::shared_ptr<vestibule::PictureSlot> pictures = {};
};

struct ConnectOptions {
  double timeout =
      protocol::kConnectTimeout;  // seconds from the first Poll; then a server that has not answered is given up
  // The key that the server must have; nullopt: any.
  std::optional<vestibule::Key> serverKey = {};
  vestibule::Credential credential = {};
  // Shown to the server with this key alone, if there is no other credential.
  std::optional<vestibule::Key> ownServer = {};
  vestibule::Credential ownCredential = {};
};

// Event::reason at a client whose server has another key than ConnectOptions::serverKey.
inline constexpr std::string_view kWrongServerReason = "the server's key is not the one that is known for this address";

inline constexpr std::size_t kMaxListenConnections = vestibule::kMaxVisitors;

class EnetTransport final : public Transport {
 public:
  // Opens a server. Null with one line in `error` when the port cannot be bound. The server's sink hears of clients
  // that the vestibule has let in; the others are told why not.
  [[nodiscard]] static std::unique_ptr<EnetTransport> Listen(const ListenOptions& options, std::string& error);

  // Opens a client and begins to connect. Resolves the name, which may block for as long as the system's resolver does;
  // null with one line in `error` when it has no address. When the server does not answer, kDisconnected follows
  // after the timeout. Until kConnected, Send returns kFailed.
  [[nodiscard]] static std::unique_ptr<EnetTransport> Connect(const std::string& host, std::uint16_t port,
                                                              std::string& error, const ConnectOptions& options = {});

  // Tells connected peers that this end closes, without waiting for them.
  ~EnetTransport() override;

  void Poll(double now, const Sink& sink) override;
  [[nodiscard]] SendResult Send(ConnectionId connection, Channel channel,
                                std::span<const std::uint8_t> message) override;
  void Disconnect(ConnectionId connection) override;
  void Flush() override;
  [[nodiscard]] Statistics ReadStatistics() const override;
  [[nodiscard]] double ReadRoundTrip(ConnectionId connection) const override;

  // The UDP port that a server listens on, also when the system picked it. 0 for a client.
  [[nodiscard]] std::uint16_t ReadPort() const;

  // A server's public key; a client's server's, once it has answered, and zeros before.
  [[nodiscard]] vestibule::Key ReadServerKey() const;
  [[nodiscard]] std::vector<std::uint8_t> ReadTicket() const override;
  // Why the server did not let a client in; kNone: it did, or has not answered.
  [[nodiscard]] vestibule::Refusal ReadRefusal() const;
  // Whether a client's server asks for a credential; known once it has answered.
  [[nodiscard]] bool ServerWantsCredential() const;
  // What the vestibule of a server has seen.
  [[nodiscard]] vestibule::DoorCounts ReadDoorCounts() const;

  // The id of a client's only connection.
  static constexpr ConnectionId kClientConnection = 1;

 private:
  struct Impl;
  explicit EnetTransport(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> m_impl;
};

}  // namespace wobble::transport
