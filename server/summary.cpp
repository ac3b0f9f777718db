#include "server/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/version.h"

namespace wobble::server {

void TickTimes::Record(double duration) {
  const auto bin = static_cast<std::size_t>(std::max(0.0, duration) / kBin);
  ++m_bins[std::min(bin, m_bins.size() - 1)];
  ++m_count;
  m_max = std::max(m_max, duration);
  if (duration > m_budget) ++m_overruns;
}

double TickTimes::PercentileMs(double share) const {
  const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(m_count));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < m_bins.size(); ++bin) {
    seen += m_bins[bin];
    if (seen > wanted || (seen == m_count && m_count > 0)) {
      return std::min(static_cast<double>(bin + 1) * kBin, m_max) * 1000;
    }
  }
  return 0;
}

namespace {

// Rounds to three decimals, so that JSON shows no digits of binary fractions.
double Round(double value) { return std::round(value * 1000) / 1000; }

}  // namespace

std::string MakeSummary(const Server& server, const TickTimes& times) {
  const Counts& counts = server.ReadCounts();
  const physics::World& world = server.World();
  const double ticks = std::max(1.0, static_cast<double>(server.ShownTick()));
  nlohmann::ordered_json json;
  json["version"] = kVersion;
  json["ticks"] = server.ShownTick();
  json["tick_ms_p50"] = Round(times.PercentileMs(0.5));
  json["tick_ms_p99"] = Round(times.PercentileMs(0.99));
  json["tick_ms_max"] = Round(times.MaxMs());
  json["overruns"] = times.Overruns();
  json["dropped_ticks"] = server.Clock().DroppedTicks();
  json["slowed_ticks"] = Round(server.Clock().SlowedTicks());
  json["bodies"] = world.Bodies().size();
  json["awake_mean"] = Round(static_cast<double>(counts.awakeSum) / ticks);
  json["substeps_mean"] =
      Round(static_cast<double>(counts.substeps) / std::max(1.0, static_cast<double>(counts.awakeSum)));
  json["clients_peak"] = counts.clientsPeak;
  json["joins"] = counts.joins;
  json["disconnects"] = counts.disconnects;
  std::uint64_t refusals = counts.refusals;
  for (const transport::Turnaways& each : server.ReadTransport().turnaways) refusals += each.count;
  json["refusals"] = refusals;
  json["respawns"] = counts.respawns;
  json["bytes_out"] = server.ReadTransport().bytesOut;
  const SendCounts& sent = server.ReadSendCounts();
  const bool any = sent.vertices > 0;  // false when nobody has played
  json["bits_per_vertex"] = any ? nlohmann::ordered_json(Round(sent.BitsPerVertex())) : nullptr;
  json["snapshot_error_rms"] = any ? nlohmann::ordered_json(Round(sent.ErrorPercentRms())) : nullptr;
  json["bodies_left_out"] = sent.bodiesLeftOut;
  json["bodies_coarsened"] = sent.bodiesCoarsened;
  json["bodies_out_of_view"] = sent.bodiesOutOfView;
  json["records_too_large"] = server.CoarsenedRecords();
  json["datagrams_rejected"] = server.ReadTransport().datagramsRejected;
  std::uint64_t dropped = server.ReadTransport().messagesRejected;
  for (const std::uint64_t count : counts.dropped) dropped += count;
  json["messages_dropped"] = dropped;
  const double due = std::max(1.0, static_cast<double>(counts.inputsDue));
  json["inputs_starved_share"] = std::round(static_cast<double>(counts.inputsStarved) / due * 1e6) / 1e6;
  json["non_finite"] = counts.nonFinite;
  json["inverted"] = counts.inverted;
  json["quarantined"] = counts.quarantined;
  json["reset"] = counts.reset;
  json["torn"] = counts.torn;
  json["paused_s"] = Round(counts.pausedTime);
  if (const recording::Recorder* recorder = server.ReadRecorder()) {
    const recording::RecorderCounts recorded = recorder->Counts();
    json["recordings"] = recorded.files;
    json["recorded_bytes"] = recorded.bytes;
    json["recording_failures"] = recorded.failures;
  }
  json["state_hash"] = fmt::format("{:016x}", world.Hash());
  return json.dump(2) + "\n";
}

std::string MakeStatusLine(const Server& server, const TickTimes& times, double elapsed,
                           std::uint64_t bytesOutLastSecond) {
  return fmt::format("{:5.0f} s  tick {}{}  p99 {:.2f} ms  overruns {}  bodies {}  clients {}  {:.0f} kbit/s out",
                     elapsed, server.ShownTick(), server.IsPaused() ? " (waits for players)" : "",
                     times.PercentileMs(0.99), times.Overruns(), server.World().Bodies().size(), server.CountPlaying(),
                     static_cast<double>(bytesOutLastSecond) * 8 / 1000);
}

}  // namespace wobble::server
