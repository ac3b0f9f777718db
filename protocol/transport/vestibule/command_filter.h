// Lets pass of a client's datagrams to ENet what honest clients send, and nothing else.
//
// ENet 1.3.17 trusts whoever is connected: one fragment reserves the whole message that it announces, 57 kB of them 250
// MB; empty messages behind a gap are queued without an end. Our clients send whole messages, on known channels, with
// numbers that follow each other. A datagram that shows anything else is dropped whole, and its sender is put out.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace wobble::transport::vestibule {

// Commands of ENet in one datagram: a client's has a few acknowledgements and an input.
inline constexpr std::size_t kMaxCommands = 32;
// Reliable messages of a client that may be under way: three seconds of as many commands as the server takes.
inline constexpr std::size_t kReliableWindow = 256;

class CommandFilter {
 public:
  enum class Verdict : std::uint8_t { kPass, kDrop, kOffence };
  // plain: one datagram of ENet, with its checksum. kDrop: a late or repeated datagram that ENet has no use for.
  // kOffence: what no honest client sends.
  [[nodiscard]] Verdict Judge(std::span<const std::uint8_t> plain);

  // The connection id of the CONNECT that has passed; nullopt before.
  [[nodiscard]] std::optional<std::uint32_t> ConnectionNumber() const { return m_connection; }

 private:
  // The numbers of a channel's reliable messages.
  struct Numbers {
    std::uint16_t next = 1;              // the lowest that has not come
    std::bitset<kReliableWindow> ahead;  // [i]: next + i has come
    // False when the number is beyond the window.
    [[nodiscard]] bool Note(std::uint16_t number);
  };
  [[nodiscard]] Verdict JudgeConnect(std::span<const std::uint8_t> command);

  std::optional<std::uint32_t> m_connection;
  Numbers m_control;
};

}  // namespace wobble::transport::vestibule
