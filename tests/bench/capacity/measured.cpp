#include "tests/bench/capacity/measured.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/bench/codec/recording.h"

namespace wobble::bench {
namespace {

constexpr double kHeaderBytes = 28;  // IPv4 and UDP per datagram; ENet's own count includes its headers
// Above this load of the bots' core, the load generator would be measured instead.
constexpr double kFullCore = 0.95;

double ToNumber(const std::optional<double>& figure) {
  return figure.value_or(std::numeric_limits<double>::quiet_NaN());
}

// Nearest-rank percentile, ms; sorts `seconds`. NaN without values.
double FindPercentileMs(std::vector<double>& seconds, double share) {
  if (seconds.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(seconds);
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(seconds.size())));
  return 1000 * seconds[std::max<std::size_t>(rank, 1) - 1];
}

double FindOverrunShare(const std::vector<double>& seconds) {
  const auto isOverrun = [](double each) { return 1000 * each > kTickBudgetMs; };
  return static_cast<double>(std::ranges::count_if(seconds, isOverrun)) / static_cast<double>(seconds.size());
}

double FindKbit(const Hosted& hosted, unsigned players) {
  const auto bytes = static_cast<double>(hosted.after.bytes - hosted.before.bytes);
  const auto packets = static_cast<double>(hosted.after.packets - hosted.before.packets);
  return 8e-3 * (bytes + kHeaderBytes * packets) / (hosted.seconds * players);
}

// A player count holds if the server stayed at normal load, the bots' core was not saturated and all players stayed to
// the end. A server that reduced its load has not held, whatever its ticks took: it did so because they took more.
bool Judge(const Measured& measured, const Party& party) {
  return measured.tickMsP99 <= kTickBudgetMs && party.hosted.level < server::LoadLevel::kBusy &&
         party.guested.playing == party.players && party.guested.figures.disconnects == 0 &&
         party.guested.work < kFullCore;
}

std::vector<double> ListTimes(const Hosted& hosted, server::Phase phase) {
  std::vector<double> times;
  for (const server::PhaseTimes& tick : hosted.ticks) times.push_back(tick.Of(phase));
  return times;
}

double FindMeanMs(const Hosted& hosted, server::Phase phase) {
  const std::vector<double> times = ListTimes(hosted, phase);
  return 1000 * std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
}

nlohmann::ordered_json MakePhases(const Hosted& hosted) {
  nlohmann::ordered_json phases;
  for (std::size_t i = 0; i < server::kPhaseCount; ++i) {
    const auto phase = static_cast<server::Phase>(i);
    const std::string key = server::Name(phase) + std::string("_ms");
    std::vector<double> times = ListTimes(hosted, phase);
    phases[key] = FindMeanMs(hosted, phase);
    phases[key + "_p99"] = FindPercentileMs(times, 0.99);
  }
  return phases;
}

nlohmann::ordered_json MakeRow(const Measured& measured, const Party& party) {
  const Hosted& hosted = party.hosted;
  const bots::Figures& figures = party.guested.figures;
  const auto ticks = static_cast<double>(hosted.after.ticks - hosted.before.ticks);
  const auto awake = static_cast<double>(std::max<std::uint64_t>(1, hosted.awake));
  const auto vertices = static_cast<double>(hosted.after.vertices - hosted.before.vertices);
  nlohmann::ordered_json row{{"players", party.players},
                             {"bodies", hosted.bodies},
                             {"seconds", hosted.seconds},
                             {"tick_ms_p50", measured.tickMsP50},
                             {"tick_ms_p99", measured.tickMsP99},
                             {"tick_ms_p999", measured.tickMsP999},
                             {"tick_ms_max", measured.tickMsMax},
                             {"overrun_share", measured.overrunShare},
                             {"wall_tick_ms_p99", measured.wallMsP99},
                             {"wall_overrun_share", measured.wallOverrunShare}};
  row.update(MakePhases(hosted));
  row.update({{"dropped_ticks", hosted.after.dropped - hosted.before.dropped},
              {"load_level", server::Name(hosted.level)},
              {"kbit_per_client", measured.kbit},
              {"displayed_error", measured.shownError},
              {"displayed_error_p99", party.shown.errorP99},
              {"missing_share", party.shown.missingShare},
              {"truth_error_of_half", party.shown.truthErrorOfHalf},
              {"codec_error",
               100 * std::sqrt((hosted.after.errorSquares - hosted.before.errorSquares) / std::max(1.0, vertices))},
              {"left_out_per_tick", static_cast<double>(hosted.after.leftOut - hosted.before.leftOut) / ticks},
              {"input_to_snapshot_ms_p50", ToNumber(figures.inputToSnapshotMsP50)},
              {"snapshot_age_ms_p50", ToNumber(figures.snapshotAgeMsP50)},
              {"snapshot_age_ms_p99", ToNumber(figures.snapshotAgeMsP99)},
              {"speed_median", hosted.speeds.empty() ? 0 : FindMedian(hosted.speeds)},
              {"touching", hosted.contacts.Touching()},
              {"touched_by_each", hosted.contacts.TouchedByEach()},
              {"in_groups_of_12", hosted.contacts.ShareInLargeIslands()},
              {"largest_group", hosted.contacts.LargestIsland()},
              {"largest_group_ever", hosted.contacts.LargestIslandEver()},
              {"substeps", static_cast<double>(hosted.substeps) / awake},
              {"all_substeps", static_cast<double>(hosted.allSubsteps) / awake},
              {"quarantined", hosted.after.quarantined - hosted.before.quarantined},
              {"bots_playing", party.guested.playing},
              {"disconnects", figures.disconnects},
              {"bots_core_share", party.guested.work},
              {"late_ms_p99", ToNumber(figures.lateMsP99)},
              {"times_valid", bots::IsValid(figures)},
              {"holds", measured.holds}});
  if (!party.recording.empty()) row["recording"] = party.recording;
  return row;
}

std::string MakeLine(const Measured& measured, const Party& party) {
  const Hosted& hosted = party.hosted;
  const auto phase = [&](server::Phase which) { return FindMeanMs(hosted, which); };
  const bots::Figures& figures = party.guested.figures;
  return FormatLine(
      "%3u players: tick %.2f, %.2f, %.2f ms (p50, p99, p99.9), wall p99 %.2f; receive %.2f, step %.2f, capture %.2f, "
      "encode %.2f, send %.2f; %.0f kbit/s, shown %.2f %%, input %.0f ms; %.0f touch, largest island %.0f; "
      "bots late by %.1f ms%s; %s: %s%s%s",
      party.players, measured.tickMsP50, measured.tickMsP99, measured.tickMsP999, measured.wallMsP99,
      phase(server::Phase::kReceive), phase(server::Phase::kStep), phase(server::Phase::kCapture),
      phase(server::Phase::kEncode), phase(server::Phase::kSend), measured.kbit, measured.shownError,
      ToNumber(figures.inputToSnapshotMsP50), hosted.contacts.Touching(), hosted.contacts.LargestIsland(),
      ToNumber(figures.lateMsP99), bots::IsValid(figures) ? "" : " (ages and inputs not valid)",
      server::Name(hosted.level), measured.holds ? "holds" : "does not hold",
      party.recording.empty() ? "" : "; worst ten seconds: ", party.recording.c_str());
}

}  // namespace

Measured Measure(const Party& party) {
  Measured measured;
  measured.players = party.players;
  std::vector<double> works;
  for (const server::PhaseTimes& tick : party.hosted.ticks) works.push_back(tick.Sum());
  std::vector<double> walls = party.hosted.walls;
  measured.tickMsP50 = FindPercentileMs(works, 0.5);
  measured.tickMsP99 = FindPercentileMs(works, 0.99);
  measured.tickMsP999 = FindPercentileMs(works, 0.999);
  measured.tickMsMax = FindPercentileMs(works, 1);
  measured.overrunShare = FindOverrunShare(works);
  measured.wallMsP99 = FindPercentileMs(walls, 0.99);
  measured.wallOverrunShare = FindOverrunShare(walls);
  measured.kbit = FindKbit(party.hosted, party.players);
  measured.shownError = party.shown.error;
  measured.holds = Judge(measured, party);
  measured.row = MakeRow(measured, party);
  measured.line = MakeLine(measured, party);
  return measured;
}

}  // namespace wobble::bench
