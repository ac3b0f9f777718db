// Several networks as one: a server whose clients have links of different kinds.
#pragma once

#include <memory>
#include <vector>

#include "protocol/transport/transport.h"

namespace wobble::bench {

class TransportGroup final : public transport::Transport {
 public:
  // What has been sent on the snapshot channel of a member, payloads.
  struct Sent {
    std::uint64_t packets = 0;
    std::uint64_t bytes = 0;
  };
  // In step with the members; may outlive the group.
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
  // A connection's number tells its member.
  [[nodiscard]] std::size_t MemberOf(transport::ConnectionId connection) const { return connection % m_members.size(); }
  [[nodiscard]] transport::ConnectionId NumberIn(transport::ConnectionId connection) const;

  std::vector<std::unique_ptr<transport::Transport>> m_members;
  std::shared_ptr<SentOfEach> m_sent;
};

}  // namespace wobble::bench
