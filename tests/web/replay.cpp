// The native client, fed with the messages that a page's client was fed with: prints what both should have decoded.
//
//   replay FILE   of messages, each a little-endian size of four bytes and that many bytes, channel first
//
// Time stands still but for what makes the input due: what is decoded depends on the bytes alone.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "client/web/wasm/session.h"

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "replay: one file, please\n");
    return 2;
  }
  std::ifstream file(arguments[1], std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  wobble::wasm::Session session("replay", true, 0);
  session.Transport().Open();
  session.Client().Update(0);
  for (std::size_t at = 0; at + sizeof(std::uint32_t) <= bytes.size();) {
    std::uint32_t size = 0;
    std::memcpy(&size, &bytes[at], sizeof size);
    at += sizeof size;
    if (size > bytes.size() - at) break;
    const auto* message = reinterpret_cast<const std::uint8_t*>(&bytes[at]);
    session.Transport().Receive(std::span(message, size));
    session.Client().Update(0);
    at += size;
  }
  const auto& statistics = session.Client().ReadStatistics();
  std::printf("%016" PRIx64 " %" PRIu64 "\n", session.DecodedHash(), statistics.records);
  return 0;
}
