// One thread and one loop over plain bots: 500 of them are 500 sockets polled and 500 coroutines resumed, about a
// millisecond a round, and nothing has to be locked. More than one core can carry is a matter of more processes.
//
// Most bots read only heads, or the generator would spend its core on decoding and measure itself; the share that
// decodes does all that a player's client does, sampling at 60 Hz included.
//
// decode_us is the time of Update of a decoding bot in the rounds that brought records, divided by those records, over
// kDecodeGroup of them at a time: reception is in it, so it is an upper bound of what decoding a record costs.
#include "client/bots/runner.h"

#include <algorithm>
#include <utility>

namespace wobble::bots {
namespace {

// Ends, and different script errors, that are reported one by one; the rest are only counted.
constexpr unsigned kFailuresLogged = 5;
// Records over which their cost is averaged, so that a round which brought only one does not count its whole overhead
// as that one's.
constexpr std::uint64_t kDecodeGroup = 32;
// How long after the first bot ended the others may still prove it wrong, seconds.
constexpr double kHopePatience = 1.0;

}  // namespace

Runner::Runner(const LoadTestOptions& options, Script& script, Connect connect, Clock clock, Log log)
    : m_options(options),
      m_script(script),
      m_connect(std::move(connect)),
      m_clock(std::move(clock)),
      m_log(std::move(log)) {}

void Runner::RunRound(double now, double late) {
  if (!m_leaving) {
    m_lateMs.Add(late * 1000);
    const auto startAt = [this](std::size_t index) {
      return m_options.ramp * static_cast<double>(index) / m_options.count;
    };
    while (m_bots.size() < m_options.count && now >= startAt(m_bots.size())) StartBot(now);
  }
  for (std::size_t i = 0; i < m_bots.size(); ++i) RunBot(*m_bots[i], static_cast<unsigned>(i) + 1, now);
}

void Runner::StartBot(double now) {
  auto bot = std::make_unique<Bot>();
  const auto index = static_cast<unsigned>(m_bots.size());
  bot->decodes = m_options.decodeShare.Includes(index);
  std::string error;
  std::unique_ptr<transport::Transport> transport = m_script.AddBot(error) != 0 ? m_connect(error) : nullptr;
  if (transport == nullptr) {
    bot->ended = true;
    NoteFailure(index + 1, error, now);
    m_bots.push_back(std::move(bot));
    return;
  }
  bot->transport = transport.get();
  client::Options options;
  options.name = "bot " + std::to_string(index + 1);
  options.decode = bot->decodes;
  options.protocolVersion = m_options.protocolVersion;
  bot->client = std::make_unique<client::Client>(std::move(transport), options, now);
  bot->client->OnSnapshot([this](const client::SnapshotArrival& arrival) { AddArrival(arrival); });
  m_bots.push_back(std::move(bot));
}

void Runner::RunBot(Bot& bot, unsigned number, double now) {
  if (bot.ended) return;
  UpdateBot(bot, now);
  const client::State state = bot.client->ReadState();
  if (state == client::State::kEnded) return NoteEnd(bot, number, now);
  if (state != client::State::kPlaying || m_leaving) return;
  if (!bot.played) {
    bot.played = true;
    bot.playedFrom = now;
    bot.bytesFrom = bot.transport->ReadStatistics().bytesIn;
    m_joinMs.Add(bot.client->ReadStatistics().joinSeconds * 1000);
  }
  RunScript(bot, number, now);
}

void Runner::UpdateBot(Bot& bot, double now) {
  client::Client& client = *bot.client;
  if (!bot.decodes || client.ReadState() != client::State::kPlaying) {
    client.Update(now);
    return;
  }
  const std::uint64_t recordsBefore = client.ReadStatistics().records;
  const double begin = m_clock();
  client.Update(now);
  const double seconds = m_clock() - begin;
  client.Sample(now, client::Detail::kVertices, m_samples);
  const std::uint64_t records = client.ReadStatistics().records - recordsBefore;
  if (records == 0 || m_leaving) return;
  m_decodeSeconds += seconds;
  m_decodeRecords += records;
  if (m_decodeRecords < kDecodeGroup) return;
  m_decodeUs.Add(m_decodeSeconds * 1e6 / static_cast<double>(m_decodeRecords));
  m_decodeSeconds = 0;
  m_decodeRecords = 0;
}

void Runner::RunScript(Bot& bot, unsigned number, double now) {
  Script::View view;
  view.time = now - bot.playedFrom;
  if (const auto pose = bot.client->NewestPose(bot.client->Welcome().ownBody)) view.position = pose->centroid;
  client::Input input;
  std::string error;
  if (m_script.Resume(number, view, input, error) == Script::Result::kFailed && !bot.scriptFailed) {
    bot.scriptFailed = true;
    // One script, so mostly one error in all bots; what differs is said, as far as it can be of interest.
    if (m_scriptErrors.size() < kFailuresLogged && m_scriptErrors.insert(error).second) {
      m_log("bot " + std::to_string(number) + " stands still: " + error);
    }
  }
  bot.client->SetInput(input);
}

void Runner::NoteEnd(Bot& bot, unsigned number, double now) {
  bot.ended = true;
  if (!bot.client->EndedUnasked()) return;
  StopMeasuring(bot, now);
  const bool answered = bot.transport->ReadStatistics().bytesIn > 0;
  NoteFailure(number, answered ? bot.client->EndReason() : "", now);
}

// reason: empty when nobody answered.
void Runner::NoteFailure(unsigned number, const std::string& reason, double now) {
  if (!m_firstFailure) m_firstFailure = now;
  if (m_refusal.empty()) m_refusal = reason;
  // While none has played the reason is one for all, and whoever runs us says it once.
  if (m_joinMs.Count() == 0 || ++m_failuresLogged > kFailuresLogged) return;
  const char* last = m_failuresLogged == kFailuresLogged ? " (more are only counted)" : "";
  m_log("bot " + std::to_string(number) + " ended: " + (reason.empty() ? "no answer" : reason) + last);
}

void Runner::StopMeasuring(Bot& bot, double now) {
  if (!bot.played) return;
  bot.playedTo = now;
  bot.bytesTo = bot.transport->ReadStatistics().bytesIn;
}

void Runner::AddArrival(const client::SnapshotArrival& arrival) {
  if (m_leaving) return;
  m_ageMs.Add(arrival.age * 1000);
  m_progressAgeSum += arrival.age * 1000;
  ++m_progressArrivals;
  if (arrival.inputToSnapshot >= 0) m_inputToSnapshotMs.Add(arrival.inputToSnapshot * 1000);
}

void Runner::Leave(double now) {
  m_leaving = true;
  for (const auto& bot : m_bots) {
    if (bot->ended) continue;
    StopMeasuring(*bot, now);
    bot->client->Leave(now);
  }
}

bool Runner::HaveAllEnded() const {
  const bool allStarted = m_leaving || m_bots.size() == m_options.count;
  return allStarted && std::all_of(m_bots.begin(), m_bots.end(), [](const auto& bot) { return bot->ended; });
}

bool Runner::IsHopeless(double now) const {
  const bool nonePlayed = std::none_of(m_bots.begin(), m_bots.end(), [](const auto& bot) { return bot->played; });
  return nonePlayed && m_firstFailure && now >= *m_firstFailure + kHopePatience;
}

bool Runner::HaveAllScriptsFailed() const {
  return m_bots.size() == m_options.count &&
         std::all_of(m_bots.begin(), m_bots.end(), [](const auto& bot) { return bot->scriptFailed; });
}

Figures Runner::ReadFigures() const {
  Figures figures;
  double bits = 0;
  double seconds = 0;
  for (const auto& bot : m_bots) {
    ++figures.bots;
    figures.connected += bot->played ? 1 : 0;
    figures.disconnects += !bot->played || bot->client->EndedUnasked() ? 1 : 0;
    figures.scriptErrors += bot->scriptFailed ? 1 : 0;
    if (bot->client == nullptr) continue;
    figures.snapshots += bot->client->ReadStatistics().snapshots;
    figures.stalls += bot->client->ReadStatistics().stalls;
    bits += static_cast<double>(bot->bytesTo - bot->bytesFrom) * 8;
    seconds += bot->playedTo - bot->playedFrom;
  }
  figures.joinMsP99 = m_joinMs.FindPercentile(0.99);
  figures.snapshotAgeMsP50 = m_ageMs.FindPercentile(0.5);
  figures.snapshotAgeMsP99 = m_ageMs.FindPercentile(0.99);
  figures.inputToSnapshotMsP50 = m_inputToSnapshotMs.FindPercentile(0.5);
  if (seconds > 0) figures.kbitPerSecondPerBot = bits / 1000 / seconds;
  figures.decodeUsP99 = m_decodeUs.FindPercentile(0.99);
  figures.lateMsP99 = m_lateMs.FindPercentile(0.99);
  return figures;
}

Runner::Progress Runner::TakeProgress(double now) {
  Progress progress;
  std::uint64_t bytes = 0;
  for (const auto& bot : m_bots) {
    if (bot->client == nullptr) continue;
    bytes += bot->transport->ReadStatistics().bytesIn;
    progress.playing += bot->client->ReadState() == client::State::kPlaying ? 1 : 0;
  }
  const double seconds = now - m_progressFrom;
  if (progress.playing > 0 && seconds > 0) {
    progress.kbitPerSecondPerBot = static_cast<double>(bytes - m_progressBytes) * 8 / 1000 / seconds / progress.playing;
  }
  if (m_progressArrivals > 0) progress.snapshotAgeMs = m_progressAgeSum / static_cast<double>(m_progressArrivals);
  m_progressFrom = now;
  m_progressBytes = bytes;
  m_progressAgeSum = 0;
  m_progressArrivals = 0;
  return progress;
}

}  // namespace wobble::bots
