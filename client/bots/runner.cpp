// One thread and one loop over plain bots, so no locks are needed. A bot that receives 380 kbit/s costs some 20 us a
// round, most of it for receiving (system calls, ENet's checksum) and little for its script, so 500 bots take more than
// half of a core. For more than one core can carry, run more processes.
//
// Most bots read only the heads of snapshots; otherwise the generator would spend its core on decoding and measure
// itself. The share of bots that decodes does all that a player's client does, including sampling at 60 Hz.
//
// decode_us is the time of Update of a decoding bot in rounds that brought records, divided by the number of those
// records, over at least kDecodeGroup records at a time. Reception is included, so it is an upper bound of the cost of
// decoding a record.
#include "client/bots/runner.h"

#include <algorithm>
#include <utility>

namespace wobble::bots {
namespace {

// So many losses and distinct script errors are reported one by one; further ones are only counted.
constexpr unsigned kFailuresLogged = 5;
// Cost is averaged over so many records, so that a round with a single record does not charge its whole overhead to
// that record.
constexpr std::uint64_t kDecodeGroup = 32;
// Another bot may still reach play for so many seconds after the first failure.
constexpr double kHopePatience = 1.0;

}  // namespace

Runner::Runner(const LoadTestOptions& options, Script& script, Connect connect, Clock clock, Log log)
    : m_options(options),
      m_stages(ListStages(options)),
      m_starts(CountStarts(m_stages)),
      m_script(script),
      m_connect(std::move(connect)),
      m_clock(std::move(clock)),
      m_log(std::move(log)) {}

void Runner::RunRound(double now, double late, unsigned parts) {
  if (!m_leaving) {
    m_lateMs.Add(late * 1000);
    m_progressLate = std::max(m_progressLate, late);
    FollowStages(now);
  }
  for (std::size_t i = m_round++ % parts; i < m_bots.size(); i += parts) RunBot(*m_bots[i], now);
}

// Lost bots stay in the count: replacing them would hide a server that cannot hold its players.
void Runner::FollowStages(double now) {
  const unsigned wanted = CountBotsAt(m_stages, now);
  while (m_bots.size() - m_dismissed < wanted) StartBot(now);
  while (m_bots.size() - m_dismissed > wanted) DismissLast(now);
}

void Runner::StartBot(double now) {
  const auto index = static_cast<unsigned>(m_bots.size());
  client::Options options;
  options.name = "bot " + std::to_string(index + 1);
  options.isBot = true;
  options.predict = false;  // what is shown is compared with where the server had it
  options.decode = m_options.decodeShare.Includes(index);
  options.protocolVersion = m_options.protocolVersion;
  options.kept = m_kept;
  if (m_keep) {
    options.keep = [this](std::uint64_t hash, std::span<const std::uint8_t> bytes) {
      if (m_keptHashes.insert(hash).second) m_keep(hash, bytes);
    };
  }
  client::RejoinOptions rejoin = m_options.rejoin;
  rejoin.seed = m_options.seed + index;
  m_bots.push_back(std::make_unique<Bot>(index + 1, options, rejoin,
                                         [this](const client::SnapshotArrival& arrival) { AddArrival(arrival); }));
  Bot& bot = *m_bots.back();
  std::string error;
  bot.scriptNumber = m_script.AddBot(error);
  if (bot.scriptNumber != 0) return BeginStay(bot, now);
  bot.player.Lose(error);
  NoteFailure(bot, now);
}

void Runner::DismissLast(double now) {
  const auto last = std::find_if(m_bots.rbegin(), m_bots.rend(), [](const auto& bot) { return !bot->dismissed; });
  (*last)->dismissed = true;
  (*last)->player.Leave(now);
  ++m_dismissed;
}

void Runner::BeginStay(Bot& bot, double now) {
  std::string error;
  if (auto transport = m_connect({}, error)) return bot.player.Join(std::move(transport), now);
  bot.player.Lose(error);
  NoteFailure(bot, now);
}

void Runner::RunBot(Bot& bot, double now) {
  if (bot.player.ReadState() == Player::State::kLost) return;
  const auto before = bot.player.ReadState();
  UpdateBot(bot, now);
  if (bot.player.ReadState() == Player::State::kRejoining) RejoinIfDue(bot, now);
  if (bot.player.ReadState() == Player::State::kLost) return NoteFailure(bot, now);
  if (m_leaving || bot.dismissed) return;
  NoteChange(bot, before, now);
  if (bot.firstPlayed) RunScript(bot, now);
}

void Runner::RejoinIfDue(Bot& bot, double now) {
  if (!bot.player.TakeRejoinDue(now)) return;
  std::string error;
  if (auto transport = m_connect(bot.player.Ticket(), error)) return bot.player.Rejoin(std::move(transport), now);
  bot.player.FailToRejoin(error, now);
}

// The time of a return is that of the player, from being cut off to playing again.
void Runner::NoteChange(Bot& bot, Player::State before, double now) {
  const auto state = bot.player.ReadState();
  if (state == before) return;
  if (state == Player::State::kRejoining) LogLoss(bot, "was cut off and joins again: ");
  if (state != Player::State::kPlaying) return;
  if (!bot.firstPlayed) bot.firstPlayed = now;
  if (before == Player::State::kRejoining) {
    m_rejoinMs.Add((now - bot.player.CutAt()) * 1000);
  } else {
    m_joinMs.Add(bot.player.Client()->ReadStatistics().joinSeconds * 1000);
  }
}

void Runner::UpdateBot(Bot& bot, double now) {
  if (!bot.decodes || bot.player.ReadState() != Player::State::kPlaying) return bot.player.Update(now);
  const std::uint64_t recordsBefore = bot.player.Client()->ReadStatistics().records;
  const double begin = m_clock();
  bot.player.Update(now);
  const double seconds = m_clock() - begin;
  client::Client* client = bot.player.Client();
  if (client == nullptr) return;
  client->Sample(now, client::Detail::kVertices, m_samples);
  if (m_onShown) m_onShown(*client, m_samples, now);
  const std::uint64_t records = client->ReadStatistics().records - recordsBefore;
  if (records == 0 || m_leaving) return;
  m_decodeSeconds += seconds;
  m_decodeRecords += records;
  if (m_decodeRecords < kDecodeGroup) return;
  m_decodeUs.Add(m_decodeSeconds * 1e6 / static_cast<double>(m_decodeRecords));
  m_decodeSeconds = 0;
  m_decodeRecords = 0;
}

void Runner::RunScript(Bot& bot, double now) {
  Player& player = bot.player;
  const auto state = player.ReadState();
  Script::View view;
  view.time = now - *bot.firstPlayed;
  view.isAway = state == Player::State::kAway;
  view.names = &player.Names();
  view.events = &player.Events();
  if (state == Player::State::kPlaying) {
    view.isPlaying = true;
    view.body = player.Client()->Welcome().ownBody;
    view.self = player.Client()->FindSighting(view.body);
    view.listBodies = [&player](std::vector<client::Sighting>& bodies) { player.Client()->ListSightings(bodies); };
    view.client = player.Client()->Welcome().clientId;
    view.game = player.Client()->Welcome().game;
    view.scoreboard = &player.Client()->ReadScoreboard();
    view.bodies = &player.Bodies();
    view.findBody = [&player](std::uint32_t body) { return player.Client()->FindSighting(body); };
    view.findVertex = [&player](std::uint32_t body, const protocol::Vector3& place) {
      return player.Client()->FindVertex(body, place);
    };
  }
  Script::Wish wish;
  std::string error;
  if (m_script.Resume(bot.scriptNumber, view, wish, error) == Script::Result::kFailed && !bot.scriptFailed) {
    bot.scriptFailed = true;
    // All bots run one script and mostly raise the same error; each distinct error is reported once, up to the limit.
    if (m_scriptErrors.size() < kFailuresLogged && m_scriptErrors.insert(error).second) {
      const char* last = m_scriptErrors.size() == kFailuresLogged ? " (other errors are only counted)" : "";
      m_log("bot " + std::to_string(bot.number) + " stands still: " + error + last);
    }
  }
  if (!wish.play) return player.Leave(now);
  if (state == Player::State::kAway) return BeginStay(bot, now);
  if (player.Client() != nullptr) Obey(wish, *player.Client());
}

void Runner::Obey(const Script::Wish& wish, client::Client& client) {
  client.SetInput(wish.input);
  client.SetHand(wish.hand);
  for (const Script::Deed& deed : wish.deeds) {
    if (const auto* push = std::get_if<Script::Push>(&deed)) client.Push(push->body, push->vertex, push->direction);
    if (const auto* cut = std::get_if<Script::Cut>(&deed)) client.Cut(cut->body, cut->eye, cut->from, cut->to);
    if (const auto* build = std::get_if<protocol::BuildFields>(&deed)) client.Build(*build);
  }
}

void Runner::NoteFailure(const Bot& bot, double now) {
  const std::string& reason = bot.player.LossReason();  // empty when the server never answered
  if (!m_firstFailure) m_firstFailure = now;
  if (m_refusal.empty()) m_refusal = reason;
  // Until a bot has played, the reason is the same for all, and the caller reports it once.
  if (m_joinMs.Count() > 0) LogLoss(bot, "ended: ");
}

void Runner::LogLoss(const Bot& bot, const char* what) {
  if (++m_lossesLogged > kFailuresLogged) return;
  const std::string& reason = bot.player.LossReason();
  const char* last = m_lossesLogged == kFailuresLogged ? " (more are only counted)" : "";
  m_log("bot " + std::to_string(bot.number) + " " + what + (reason.empty() ? "no answer" : reason) + last);
}

void Runner::AddArrival(const client::SnapshotArrival& arrival) {
  if (m_leaving) return;
  m_ageMs.Add(arrival.age * 1000);
  m_progressAgeSum += arrival.age * 1000;
  ++m_progressArrivals;
  if (arrival.inputToSnapshot >= 0) m_inputToSnapshotMs.Add(arrival.inputToSnapshot * 1000);
}

void Runner::ForgetTimes() {
  for (Histogram* times : {&m_ageMs, &m_inputToSnapshotMs, &m_decodeUs, &m_lateMs}) *times = {};
}

void Runner::Leave(double now) {
  if (m_joinMs.Count() > 0 && !m_leaving) m_loss = FindLoss();
  m_leaving = true;
  for (const auto& bot : m_bots) bot->player.Leave(now);
}

std::optional<std::string> Runner::FindLoss() const {
  std::optional<std::string> loss;
  for (const auto& bot : m_bots) {
    const auto state = bot->player.ReadState();
    if (state == Player::State::kPlaying || state == Player::State::kJoining) return {};
    const bool isLost = state == Player::State::kLost || state == Player::State::kRejoining;
    if (isLost && !bot->dismissed && !bot->player.WasSentAway() && !loss) loss = bot->player.LossReason();
  }
  return loss;
}

// A bot that its script made leave may return, so it has not ended.
bool Runner::HasEnded(const Bot& bot) const {
  const auto state = bot.player.ReadState();
  return state == Player::State::kLost || (state == Player::State::kAway && (m_leaving || bot.dismissed));
}

// Bots that are all dismissed by the stages wait for the next stage; bots that are all lost do not.
bool Runner::HaveAllEnded() const {
  const bool isOver = m_leaving || (m_bots.size() == m_starts && m_firstFailure);
  return isOver && std::all_of(m_bots.begin(), m_bots.end(), [this](const auto& bot) { return HasEnded(*bot); });
}

bool Runner::IsHopeless(double now) const {
  return m_joinMs.Count() == 0 && m_firstFailure && now >= *m_firstFailure + kHopePatience;
}

bool Runner::HaveAllScriptsFailed() const {
  return m_bots.size() == m_starts &&
         std::all_of(m_bots.begin(), m_bots.end(), [](const auto& bot) { return bot->scriptFailed; });
}

Figures Runner::ReadFigures() const {
  Figures figures;
  double bits = 0;
  double seconds = 0;
  for (const auto& bot : m_bots) {
    const Player::Totals totals = bot->player.ReadTotals();
    const bool isSentAway = bot->player.WasSentAway();
    // A bot that has come back counts as lost all the same.
    const bool isLost = (bot->player.ReadState() == Player::State::kLost && !isSentAway) || totals.cuts > 0;
    ++figures.bots;
    figures.connected += totals.joins > 0 ? 1 : 0;
    figures.joins += totals.joins;
    figures.rejoins += totals.rejoins;
    figures.disconnects += isLost || (totals.joins == 0 && !bot->dismissed) ? 1 : 0;
    figures.sentAway += isSentAway ? 1 : 0;
    figures.scriptErrors += bot->scriptFailed ? 1 : 0;
    figures.snapshots += totals.snapshots;
    figures.stalls += totals.stalls;
    bits += static_cast<double>(totals.playedBytes) * 8;
    seconds += totals.playedSeconds;
  }
  figures.joinMsP99 = m_joinMs.FindPercentile(0.99);
  figures.rejoinMsP99 = m_rejoinMs.FindPercentile(0.99);
  figures.snapshotAgeMsP50 = m_ageMs.FindPercentile(0.5);
  figures.snapshotAgeMsP99 = m_ageMs.FindPercentile(0.99);
  figures.inputToSnapshotMsP50 = m_inputToSnapshotMs.FindPercentile(0.5);
  if (seconds > 0) figures.kbitPerSecondPerBot = bits / 1000 / seconds;
  figures.decodeUsP99 = m_decodeUs.FindPercentile(0.99);
  figures.lateMsP99 = m_lateMs.FindPercentile(0.99);
  return figures;
}

Runner::Progress Runner::TakeProgress() {
  Progress progress;
  std::uint64_t bytes = 0;
  double seconds = 0;
  for (const auto& bot : m_bots) {
    const Player::Totals totals = bot->player.ReadTotals();
    bytes += totals.playedBytes;
    seconds += totals.playedSeconds;
    progress.playing += bot->player.ReadState() == Player::State::kPlaying ? 1 : 0;
  }
  if (seconds > m_progressSeconds) {
    const double bits = static_cast<double>(bytes - m_progressBytes) * 8;
    progress.kbitPerSecondPerBot = bits / 1000 / (seconds - m_progressSeconds);
  }
  if (m_progressArrivals > 0) progress.snapshotAgeMs = m_progressAgeSum / static_cast<double>(m_progressArrivals);
  m_progressSeconds = seconds;
  m_progressBytes = bytes;
  m_progressAgeSum = 0;
  m_progressArrivals = 0;
  progress.lateMs = m_progressLate * 1000;
  m_progressLate = 0;
  return progress;
}

}  // namespace wobble::bots
