// One event per line, each a complete JSON object.
#include "server/ops/trace.h"

#include <fmt/format.h>

#include <iterator>

namespace wobble::ops {
namespace {

constexpr double kMicroseconds = 1e6;

}  // namespace

bool Trace::Open(const std::string& path) {
  m_file.open(path, std::ios::binary | std::ios::trunc);
  m_file << "[";
  return m_file.flush().good();
}

void Trace::Write(std::span<const server::PhaseTimes> ticks, std::uint32_t lastTick) {
  std::uint32_t tick = lastTick - static_cast<std::uint32_t>(ticks.size());
  fmt::memory_buffer text;
  const auto add = [&](const char* name, double begin, double duration) {
    fmt::format_to(std::back_inserter(text),
                   "{}\n{{\"name\":\"{}\",\"ph\":\"X\",\"pid\":1,\"tid\":1,\"ts\":{:.1f},\"dur\":{:.1f},\"args\":{{"
                   "\"tick\":{}}}}}",
                   m_isFirst ? "" : ",", name, begin * kMicroseconds, duration * kMicroseconds, tick);
    m_isFirst = false;
  };
  for (const server::PhaseTimes& times : ticks) {
    ++tick;
    add("tick", times.begin, times.Sum());
    double begin = times.begin;
    for (std::size_t i = 0; i < server::kPhaseCount; ++i) {
      add(Name(static_cast<server::Phase>(i)), begin, times.phases[i]);
      begin += times.phases[i];
    }
  }
  m_file.write(text.data(), static_cast<std::streamsize>(text.size()));
}

bool Trace::Close() {
  m_file << "\n]\n";
  m_file.close();
  return m_file.good();
}

}  // namespace wobble::ops
