#include "server/admission/refusal_log.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string>

namespace wobble::admission {

using transport::Turnaway;

namespace {

constexpr double kEvery = 10;  // s

constexpr std::array<const char*, transport::kTurnawayCount> kWords{
    "server full",     "too many from an address",  "no password, invite or token",
    "wrong password",  "wrong token or ticket",     "wrong invite",
    "wrong owner key", "gateway that is not known", "too many wrong tries of an address",
    "banned"};

// Nobody but the host can mend it, and all browsers are out meanwhile.
void WarnOfGateway(const transport::Turnaways& gateways, std::uint64_t count) {
  spdlog::warn(
      "a gateway at {} was refused {}: its --gateway-key is not the one of this server, or their clocks differ",
      transport::FormatIp(gateways.last), count == 1 ? "once" : fmt::format("{} times", count));
}

}  // namespace

void RefusalLog::Follow(const transport::Statistics& statistics, double now) {
  if (now < m_next) return;
  std::string line;
  for (std::size_t i = 0; i < transport::kTurnawayCount; ++i) {
    const transport::Turnaways& each = statistics.turnaways[i];
    const std::uint64_t count = each.count - m_logged[i];
    m_logged[i] = each.count;
    if (count == 0) continue;
    m_next = now + kEvery;
    if (static_cast<Turnaway>(i) == Turnaway::kGateway) WarnOfGateway(each, count);
    line += fmt::format("{}{} ({}, last from {})", line.empty() ? "" : ", ", kWords[i], count,
                        transport::FormatIp(each.last));
  }
  if (!line.empty()) spdlog::info("not let in: {}", line);
}

}  // namespace wobble::admission
