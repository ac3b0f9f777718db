// Lists all metrics in the order in which they are served. Names follow Prometheus' conventions (base units, _total for
// counters). No label names a client, so the number of series is fixed.
//
// The library's registry of counters, which threads share, is not used: the tick keeps plain counts of its own and
// hands over a copy, and the library only writes the text.
#include "server/ops/metrics.h"

#include <prometheus/text_serializer.h>

#include <sstream>
#include <utility>

namespace wobble::ops {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

class List {
 public:
  void Begin(std::string name, std::string help, MetricType type) {
    m_families.push_back({std::move(name), std::move(help), type, {}});
  }
  ClientMetric& Add(Labels labels = {}) {
    ClientMetric& metric = m_families.back().metric.emplace_back();
    metric.label = std::move(labels);
    return metric;
  }

  void AddGauge(std::string name, std::string help, double value) {
    Begin(std::move(name), std::move(help), MetricType::Gauge);
    Add().gauge.value = value;
  }
  void AddCounter(std::string name, std::string help, double value) {
    Begin(std::move(name), std::move(help), MetricType::Counter);
    Add().counter.value = value;
  }
  // Adds a histogram to the family begun last.
  template <const auto& kBounds>
  void AddBins(const server::Bins<kBounds>& bins, Labels labels = {}) {
    ClientMetric::Histogram& histogram = Add(std::move(labels)).histogram;
    for (std::size_t i = 0; i < bins.counts.size(); ++i) {
      histogram.sample_count += bins.counts[i];
      if (i < kBounds.size()) histogram.bucket.push_back({histogram.sample_count, kBounds[i]});
    }
    histogram.sample_sum = bins.sum;
  }
  void AddGauges(const char* label, std::initializer_list<std::pair<const char*, double>> values) {
    for (const auto& [value, number] : values) Add({{label, value}}).gauge.value = number;
  }
  void AddCounters(const char* label, std::initializer_list<std::pair<const char*, double>> values) {
    for (const auto& [value, number] : values) Add({{label, value}}).counter.value = number;
  }

  [[nodiscard]] const std::vector<MetricFamily>& Families() const { return m_families; }

 private:
  std::vector<MetricFamily> m_families;
};

double ToNumber(std::uint64_t count) { return static_cast<double>(count); }

void AddTicks(List& list, const Figures& f) {
  list.Begin("wobble_tick_duration_seconds", "Duration of a tick, all phases together.", MetricType::Histogram);
  list.AddBins(f.tickDurations);
  list.Begin("wobble_tick_phase_seconds", "Duration of a tick, by phase.", MetricType::Histogram);
  for (std::size_t i = 0; i < server::kPhaseCount; ++i) {
    list.AddBins(f.phaseDurations[i], {{"phase", Name(static_cast<server::Phase>(i))}});
  }
  list.AddCounter("wobble_tick_overruns_total", "Ticks that took longer than the time there is for one.",
                  ToNumber(f.overruns));
  list.AddCounter("wobble_ticks_dropped_total", "Ticks that world time fell behind by for good.",
                  ToNumber(f.droppedTicks));
  list.AddCounter("wobble_ticks_slowed_total", "Ticks that world time fell behind by going slower on purpose.",
                  f.slowedTicks);
  list.AddCounter("wobble_world_ticks_total", "Ticks of the world.", ToNumber(f.ticks));
  list.AddGauge("wobble_time_ratio", "World time per wall time, smoothed over a second.", f.timeRatio);
  list.AddGauge("wobble_load_ratio", "Time that ticks take over the time there is for them; above 1: too long.",
                f.loadShare);
  list.AddGauge("wobble_load_level", "Measures in force: 0 none, 1 coarser, 2 20 Hz and no joins, 3 slowed.",
                static_cast<double>(f.loadLevel));
  list.AddGauge("wobble_snapshot_rate_hertz", "Snapshots a second of the world's time.", f.snapshotHz);
  list.AddGauge("wobble_world_paused", "1 while the world is paused because nobody is connected.", f.isPaused ? 1 : 0);
  list.AddCounter("wobble_world_paused_seconds_total", "Time that the world was paused because nobody was connected.",
                  f.counts.pausedTime);
}

void AddClients(List& list, const Figures& f) {
  list.Begin("wobble_clients", "Connections, by state.", MetricType::Gauge);
  list.AddGauges("state", {{"joining", ToNumber(f.clients.joining)},
                           {"playing", ToNumber(f.clients.playing)},
                           {"watching", ToNumber(f.clients.watching)},
                           {"leaving", ToNumber(f.clients.leaving)}});
  list.AddGauge("wobble_clients_limit", "Players and watchers that are let in.", ToNumber(f.maxClients));
  list.AddCounter("wobble_client_joins_total", "Clients let in.", ToNumber(f.counts.joins));
  list.AddCounter("wobble_client_leaves_total", "Clients that left by themselves.", ToNumber(f.counts.leaves));
  list.AddCounter("wobble_client_disconnects_total", "Clients lost, silent or sent away after they had joined.",
                  ToNumber(f.counts.disconnects));
  list.Begin("wobble_client_goodbyes_total", "Goodbyes said to clients, by reason.", MetricType::Counter);
  // Without the first reason, which only a client that leaves says.
  constexpr std::array<const char*, server::kGoodbyeReasonCount - 1> kReasons{
      "server_closing",       "server_full", "wrong_version", "wrong_schema", "no_hello", "silent",
      "bad_messages",         "busy",        "too_much",      "kicked",       "banned",   "bad_token",
      "too_many_from_address"};
  for (std::size_t i = 0; i < kReasons.size(); ++i) {
    list.Add({{"reason", kReasons[i]}}).counter.value = ToNumber(f.counts.goodbyes[i + 1]);
  }
  list.Begin("wobble_client_refusals_total", "Clients not let in before their hello, by reason.", MetricType::Counter);
  constexpr std::array<const char*, transport::kTurnawayCount> kTurnaways{
      "full",         "too_many_from_address", "nothing_shown",   "wrong_password",   "wrong_token",
      "wrong_invite", "wrong_owner_key",       "unknown_gateway", "too_many_guesses", "banned"};
  for (std::size_t i = 0; i < kTurnaways.size(); ++i) {
    list.Add({{"reason", kTurnaways[i]}}).counter.value = ToNumber(f.transport.turnaways[i].count);
  }
  list.Begin("wobble_queries_total", "Answers to strangers who ask what is played, by kind.", MetricType::Counter);
  constexpr std::array<const char*, transport::kQueryAnswerCount> kQueries{"challenge", "info", "players", "rules"};
  for (std::size_t i = 0; i < kQueries.size(); ++i) {
    list.Add({{"kind", kQueries[i]}}).counter.value = ToNumber(f.transport.queries[i]);
  }
  list.Begin("wobble_talk_total", "What players told one another, by kind; refused: and did not get through.",
             MetricType::Counter);
  list.AddCounters("kind", {{"line", ToNumber(f.counts.said)},
                            {"emote", ToNumber(f.counts.emotes)},
                            {"rename", ToNumber(f.counts.renames)},
                            {"refused", ToNumber(f.counts.talkRefused)}});
  list.AddCounter("wobble_client_stalls_total", "Times that clients had to show a body without news of it in time.",
                  ToNumber(f.counts.stalls));
  list.AddCounter("wobble_client_inputs_starved_total",
                  "Ticks on which a player stood still because no input had come in time.",
                  ToNumber(f.counts.inputsStarved));
}

void AddBodies(List& list, const Figures& f) {
  const physics::StepReport& report = f.report;
  list.Begin("wobble_bodies", "Bodies, by state; quarantined: stepped again, finer, in the last tick after a fault.",
             MetricType::Gauge);
  list.AddGauges("state", {{"awake", ToNumber(report.awake - report.quarantined)},
                           {"asleep", ToNumber(f.bodies - std::min<std::size_t>(f.bodies, report.awake))},
                           {"quarantined", ToNumber(report.quarantined)}});
  list.Begin("wobble_substeps_per_body_tick", "Substeps per tick of an awake body.", MetricType::Summary);
  ClientMetric::Summary& substeps = list.Add().summary;
  substeps.sample_count = f.counts.awakeSum;
  substeps.sample_sum = ToNumber(f.counts.substeps);
  list.Begin("wobble_body_faults_total", "Bodies stepped again after a fault; reset: the second attempt failed too.",
             MetricType::Counter);
  list.AddCounters("fault", {{"quarantined", ToNumber(f.counts.quarantined)},
                             {"non_finite", ToNumber(f.counts.nonFinite)},
                             {"inverted", ToNumber(f.counts.inverted)},
                             {"reset", ToNumber(f.counts.reset)}});
  list.AddCounter("wobble_body_respawns_total", "Bodies put back after a fall.", ToNumber(f.counts.respawns));
  list.AddCounter("wobble_springs_torn_total", "Springs torn by being stretched too far; cut ones are not counted.",
                  ToNumber(f.counts.torn));
  list.Begin("wobble_world_energy_joules",
             "Energy of all bodies, each as of some tick of the last second; gas and gravity up to a constant.",
             MetricType::Gauge);
  list.AddGauges("kind", {{"kinetic", f.energy.kinetic},
                          {"gravity", f.energy.gravity},
                          {"springs", f.energy.springs},
                          {"gas", f.energy.gas}});
}

void AddSnapshots(List& list, const Figures& f) {
  list.AddCounter("wobble_snapshot_bytes_total", "Payload of snapshots sent.", ToNumber(f.sent.bytes));
  list.AddCounter("wobble_snapshot_budget_bytes_total", "Bytes of snapshots that clients' links had room for.",
                  f.sent.budgetBytes);
  list.AddCounter("wobble_snapshot_record_bytes_total", "Of these, bodies.", ToNumber(f.sent.recordBytes));
  list.AddCounter("wobble_snapshot_vertices_total", "Vertices sent.", ToNumber(f.sent.vertices));
  list.AddCounter("wobble_snapshot_packets_total", "Snapshot packets sent.", ToNumber(f.sent.packets));
  list.AddCounter("wobble_snapshot_packets_lost_total", "Of these, never acknowledged by the client.",
                  ToNumber(f.sent.packetsLost));
  list.Begin("wobble_snapshot_error_ratio", "RMS error of a body as sent, over its size.", MetricType::Histogram);
  list.AddBins(f.sent.errors);
  list.Begin("wobble_snapshot_bodies_total", "Bodies not sent at the best quality, by outcome.", MetricType::Counter);
  list.AddCounters("outcome", {{"coarsened", ToNumber(f.sent.bodiesCoarsened)},
                               {"left_out", ToNumber(f.sent.bodiesLeftOut)},
                               {"out_of_view", ToNumber(f.sent.bodiesOutOfView)},
                               {"too_large", ToNumber(f.recordsTooLarge)}});
}

void AddMessages(List& list, const Figures& f) {
  list.Begin("wobble_messages_dropped_total", "Messages of clients that were dropped, by reason.", MetricType::Counter);
  const auto& parse = f.counts.parse;
  const auto count = [&](server::DropReason reason) {
    return ToNumber(f.counts.dropped[static_cast<std::size_t>(reason)]);
  };
  const auto parsed = [&](protocol::ParseResult result) { return ToNumber(parse[static_cast<std::size_t>(result)]); };
  list.AddCounters("reason", {{"too_large", parsed(protocol::ParseResult::kTooLarge)},
                              {"malformed", parsed(protocol::ParseResult::kMalformed)},
                              {"missing_field", parsed(protocol::ParseResult::kMissingField)},
                              {"out_of_range", parsed(protocol::ParseResult::kOutOfRange)},
                              {"out_of_order", count(server::DropReason::kOutOfOrder)},
                              {"wrong_channel", count(server::DropReason::kWrongChannel)},
                              {"future_input", count(server::DropReason::kFutureInput)},
                              {"bad_acknowledgement", count(server::DropReason::kBadAcknowledgement)},
                              {"too_many", count(server::DropReason::kTooMany)},
                              {"old_scene", count(server::DropReason::kOldScene)},
                              {"not_for_us", ToNumber(f.transport.messagesRejected)}});
  list.AddCounter("wobble_datagrams_rejected_total", "Datagrams that were broken or forged.",
                  ToNumber(f.transport.datagramsRejected));
  list.Begin("wobble_transport_bytes_total", "UDP payload, the transport's headers included.", MetricType::Counter);
  list.AddCounters("direction", {{"in", ToNumber(f.transport.bytesIn)}, {"out", ToNumber(f.transport.bytesOut)}});
}

}  // namespace

std::string WriteMetrics(const Figures& figures, const std::string& version, const std::string& scene) {
  List list;
  list.Begin("wobble_build_info", "1; version and scene of this server.", MetricType::Gauge);
  list.Add({{"version", version}, {"scene", scene}}).gauge.value = 1;
  AddTicks(list, figures);
  AddClients(list, figures);
  AddBodies(list, figures);
  AddSnapshots(list, figures);
  AddMessages(list, figures);
  std::ostringstream text;
  prometheus::TextSerializer().Serialize(text, list.Families());
  return text.str();
}

}  // namespace wobble::ops
