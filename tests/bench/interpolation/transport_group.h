// Presents several transports as one, so that the clients of one server can have links of different kinds.
#pragma once

#include <memory>
#include <vector>

#include "protocol/transport/transport.h"

namespace wobble::bench {

class TransportGroup final : public transport::Transport {
 public:
  // Snapshot messages sent through a member; bytes of payload.
  struct Sent {
    std::uint64_t packets = 0;
    std::uint64_t bytes = 0;
  };
  // One entry per member, in the same order; may outlive the group.
  using SentOfEach = std::vector<Sent>;

  TransportGroup(std::vector<std::unique_ptr<transport::Transport>> members, std::shared_ptr<SentOfEach> sent);

  void Poll(double now, const Sink& sink) override;
  [[nodiscard]] transport::SendResult Send(transport::ConnectionId connection, transport::Channel channel,
                                           std::span<const std::uint8_t> message) override;
  void Disconnect(transport::ConnectionId connection) override;
  void Flush() override;
  [[nodiscard]] transport::Statistics ReadStatistics() const override { return {}; }
  [[nodiscard]] double ReadRoundTrip(transport::ConnectionId connection) const override;

 private:
  // The group numbers connection c of member m as c * members + m.
  [[nodiscard]] std::size_t MemberOf(transport::ConnectionId connection) const { return connection % m_members.size(); }
  [[nodiscard]] transport::ConnectionId NumberIn(transport::ConnectionId connection) const;

  std::vector<std::unique_ptr<transport::Transport>> m_members;
  std::shared_ptr<SentOfEach> m_sent;
};

}  // namespace wobble::bench
