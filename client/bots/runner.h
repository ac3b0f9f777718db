// Plays the bots of one load test: has them join, sends the input that their script gives, and measures.
//
// Reads no clock except the one given for timing the decoding, so tests run it on virtual time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/bots/histogram.h"
#include "client/bots/options.h"
#include "client/bots/player.h"
#include "client/bots/script.h"
#include "client/bots/summary.h"
#include "client/client.h"

namespace wobble::bots {

class Runner {
 public:
  // Begins a connection to the server. On failure null, with one line in `error`.
  // Begins a connection. ticket: what the bot was given in the one before (Transport::ReadTicket); empty: nothing.
  using Connect =
      std::function<std::unique_ptr<transport::Transport>(std::span<const std::uint8_t> ticket, std::string& error)>;
  using Clock = std::function<double()>;  // seconds
  using Log = std::function<void(std::string_view line)>;

  // script must be loaded and must outlive the runner.
  Runner(const LoadTestOptions& options, Script& script, Connect connect, Clock clock, Log log);

  // Runs one round for one of `parts` parts of the bots, the next part at each call. Call it 60 * `parts` times a
  // second. now: seconds, with the first call's as origin. late: seconds since this round was due.
  void RunRound(double now, double late, unsigned parts = 1);

  // Restarts the measurement of snapshot age, input to snapshot, decoding and lateness, so that the time in which the
  // bots joined does not count.
  void ForgetTimes();
  // Called in each round of a decoding bot that plays, with the bodies that its player sees at `now`.
  using OnShown = std::function<void(client::Client& client, std::span<const client::BodySample> shown, double now)>;
  void SetOnShown(OnShown onShown) { m_onShown = std::move(onShown); }

  // Sets what all bots begin with and where blueprints are kept; see client::Options. Call it before the first round.
  void SetKept(const client::Options& options) {
    m_kept = options.kept;
    m_keep = options.keep;
  }

  // Says goodbye for all bots and ends measuring. RunRound must go on until HaveAllEnded.
  void Leave(double now);
  // True once all bots have ended. Before Leave, bots that a stage dismissed do not make it true by themselves.
  [[nodiscard]] bool HaveAllEnded() const;

  // True when the first bot failed more than a second ago and no bot has ever played: the others will not succeed.
  [[nodiscard]] bool IsHopeless(double now) const;
  [[nodiscard]] bool HasAnyFailed() const { return m_firstFailure.has_value(); }
  // Says in one line why no bot plays; empty when the server never answered.
  [[nodiscard]] const std::string& Refusal() const { return m_refusal; }
  [[nodiscard]] bool HaveAllScriptsFailed() const;
  // After Leave: why none of the bots that had played was in the world any more, although one had been cut off;
  // nullopt: one was, or all had left by themselves.
  [[nodiscard]] const std::optional<std::string>& Loss() const { return m_loss; }

  [[nodiscard]] Figures ReadFigures() const;

  // Returns the status line's figures: present ones, and means since the last call.
  struct Progress {
    unsigned playing = 0;
    std::optional<double> kbitPerSecondPerBot;
    std::optional<double> snapshotAgeMs;  // mean
    double lateMs = 0;                    // greatest since the last call
  };
  [[nodiscard]] Progress TakeProgress();

 private:
  struct Bot {
    Bot(unsigned itsNumber, const client::Options& options, const client::RejoinOptions& rejoin,
        Player::OnSnapshot onSnapshot)
        : number(itsNumber), decodes(options.decode), player(options, rejoin, std::move(onSnapshot)) {}

    unsigned number;
    unsigned scriptNumber = 0;  // its number in m_script; differs from `number` once memory has been out
    bool decodes;
    bool dismissed = false;  // a falling stage ended it; it does not rejoin
    bool scriptFailed = false;
    std::optional<double> firstPlayed;
    Player player;
  };

  void FollowStages(double now);
  void StartBot(double now);
  void DismissLast(double now);
  void BeginStay(Bot& bot, double now);
  void RejoinIfDue(Bot& bot, double now);
  void RunBot(Bot& bot, double now);
  void UpdateBot(Bot& bot, double now);
  void RunScript(Bot& bot, double now);
  static void Obey(const Script::Wish& wish, client::Client& client);
  void NoteFailure(const Bot& bot, double now);
  void NoteChange(Bot& bot, Player::State before, double now);
  void LogLoss(const Bot& bot, const char* what);
  [[nodiscard]] std::optional<std::string> FindLoss() const;
  void AddArrival(const client::SnapshotArrival& arrival);
  [[nodiscard]] bool HasEnded(const Bot& bot) const;

  LoadTestOptions m_options;
  std::vector<Stage> m_stages;
  unsigned m_starts;  // bots started over all stages
  Script& m_script;
  Connect m_connect;
  Clock m_clock;
  Log m_log;
  OnShown m_onShown;
  std::shared_ptr<const client::KeptBlueprints> m_kept;
  std::function<void(std::uint64_t, std::span<const std::uint8_t>)> m_keep;
  std::set<std::uint64_t> m_keptHashes;  // by bots of this run

  std::vector<std::unique_ptr<Bot>> m_bots;
  unsigned m_round = 0;
  unsigned m_dismissed = 0;
  std::vector<client::BodySample> m_samples;  // scratch
  bool m_leaving = false;
  std::string m_refusal;
  std::optional<std::string> m_loss;
  std::optional<double> m_firstFailure;  // time at which the first bot was lost
  unsigned m_lossesLogged = 0;
  std::set<std::string> m_scriptErrors;  // errors reported so far

  Histogram m_joinMs;
  Histogram m_rejoinMs;
  Histogram m_ageMs;
  Histogram m_inputToSnapshotMs;
  Histogram m_decodeUs;
  Histogram m_lateMs;

  double m_decodeSeconds = 0;  // of the unfinished group of records
  std::uint64_t m_decodeRecords = 0;

  double m_progressSeconds = 0;  // seconds played at the last TakeProgress, over all bots
  std::uint64_t m_progressBytes = 0;
  double m_progressAgeSum = 0;
  std::uint64_t m_progressArrivals = 0;
  double m_progressLate = 0;
};

}  // namespace wobble::bots
