// What a native client makes of the messages that a page received: `replay [--from RECORDS] [KEPT ...] < FILE` prints,
// for each of them that held records, its place, from 0, how many records there have been and the hash of all that was
// decoded from them, or from those behind the first RECORDS.
//
// FILE is messages as the page's WebSocket had them, each behind its length as 32 bits, little-endian. Each KEPT is a
// file with a whole blueprint, which the client then has from an earlier connection. Nothing is
// answered, since nobody is there to hear it, and time goes on by a millisecond a message: what is decoded does not
// depend on when it came, and that is a part of what is compared.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "client/client.h"
#include "client/wasm/decoded_hash.h"
#include "client/wasm/web_socket_transport.h"

namespace {

using wobble::client::Client;
using wobble::wasm::WebSocketTransport;

constexpr double kBetween = 0.001;                    // s from a message to the next
constexpr std::uint32_t kLongestMessage = 1U << 24U;  // bytes, more is no message

// False at the end of the file, or where it is broken.
bool ReadMessage(std::istream& from, std::vector<std::uint8_t>& message) {
  std::array<unsigned char, 4> head{};
  if (!from.read(reinterpret_cast<char*>(head.data()), head.size())) return false;
  const std::uint32_t size = head[0] | head[1] << 8U | head[2] << 16U | std::uint32_t{head[3]} << 24U;
  if (size > kLongestMessage) return false;
  message.resize(size);
  return static_cast<bool>(from.read(reinterpret_cast<char*>(message.data()), size));
}

wobble::client::KeptBlueprint ReadKept(const char* name) {
  std::ifstream file(name, std::ios::binary);
  wobble::client::KeptBlueprint kept;
  kept.bytes.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  kept.hash = wobble::protocol::HashBytes(kept.bytes);
  return kept;
}

void Replay(std::istream& from, std::uint64_t hashFrom, std::span<char* const> keptFiles) {
  auto kept = std::make_shared<wobble::client::KeptBlueprints>();
  for (const char* name : keptFiles) kept->push_back(ReadKept(name));

  auto owned = std::make_unique<WebSocketTransport>();
  WebSocketTransport& transport = *owned;
  double now = 0;
  Client client(std::move(owned), {.kept = std::move(kept), .completionWork = std::numeric_limits<std::size_t>::max()},
                now);
  wobble::wasm::DecodedHash hash;
  client.OnDecoded([&](const wobble::client::DecodedPatch& patch) { hash.Add(patch); });
  transport.Open();

  std::vector<std::uint8_t> message;
  std::uint64_t records = 0;
  for (std::uint64_t place = 0; ReadMessage(from, message); ++place) {
    transport.Receive(message);
    client.Update(now += kBetween);
    while (!transport.FindOutgoing().empty()) transport.TakeOutgoing();
    if (client.ReadStatistics().records == records) continue;
    records = client.ReadStatistics().records;
    if (records == hashFrom) hash = {};
    std::printf("%llu %llu %016llx\n", static_cast<unsigned long long>(place), static_cast<unsigned long long>(records),
                static_cast<unsigned long long>(hash.Value()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::span<char* const> words = std::span<char* const>(argv, static_cast<std::size_t>(argc)).subspan(1);
  std::uint64_t hashFrom = 0;
  if (words.size() >= 2 && std::string_view(words[0]) == "--from") {
    hashFrom = std::strtoull(words[1], nullptr, 10);
    words = words.subspan(2);
  }
  Replay(std::cin, hashFrom, words);
}
