// The bots of one load test: when they join, what their script makes them do, and what is measured on the way.
//
// Reads no clock but the one it is given to time decoding with, so that tests run it on virtual time.
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
  // Begins a connection to the server; null with one line in `error` when it cannot.
  using Connect = std::function<std::unique_ptr<transport::Transport>(std::string& error)>;
  using Clock = std::function<double()>;  // seconds
  using Log = std::function<void(std::string_view line)>;

  // script is loaded and must outlive the runner.
  Runner(const LoadTestOptions& options, Script& script, Connect connect, Clock clock, Log log);

  // One round of one part of the bots, the next at each call; to be called 60 times `parts` times a second. now counts
  // from the first call's, seconds. late: seconds since this round was due.
  void RunRound(double now, double late, unsigned parts = 1);

  // Snapshots' ages, the way of inputs, decoding and lateness count from now on, not while bots came and settled in.
  void ForgetTimes();
  // Called in each round of a decoding bot that plays, with what its player sees at `now`.
  using OnShown = std::function<void(client::Client& client, std::span<const client::BodySample> shown, double now)>;
  void SetOnShown(OnShown onShown) { m_onShown = std::move(onShown); }

  // Says goodbye for all; measuring ends. RunRound goes on until HaveAllEnded.
  void Leave(double now);
  // True, without Leave, once all there were to be are gone and not all of them because the stages said so.
  [[nodiscard]] bool HaveAllEnded() const;

  // Some bots ended a second ago and none has ever played: the rest need not try.
  [[nodiscard]] bool IsHopeless(double now) const;
  [[nodiscard]] bool HasAnyFailed() const { return m_firstFailure.has_value(); }
  // Why none plays, one line; empty when nobody answered at all.
  [[nodiscard]] const std::string& Refusal() const { return m_refusal; }
  [[nodiscard]] bool HaveAllScriptsFailed() const;

  [[nodiscard]] Figures ReadFigures() const;

  // For the status line: of now, and since the last call.
  struct Progress {
    unsigned playing = 0;
    std::optional<double> kbitPerSecondPerBot;
    std::optional<double> snapshotAgeMs;  // mean
    double lateMs = 0;                    // greatest
  };
  [[nodiscard]] Progress TakeProgress();

 private:
  struct Bot {
    Bot(unsigned itsNumber, const client::Options& options, Player::OnSnapshot onSnapshot)
        : number(itsNumber), decodes(options.decode), player(options, std::move(onSnapshot)) {}

    unsigned number;
    unsigned scriptNumber = 0;  // its number there: another one once memory has been out
    bool decodes;
    bool dismissed = false;  // the stages go down: it leaves for good
    bool scriptFailed = false;
    std::optional<double> firstPlayed;
    Player player;
  };

  void FollowStages(double now);
  void StartBot(double now);
  void DismissLast(double now);
  void BeginStay(Bot& bot, double now);
  void RunBot(Bot& bot, double now);
  void UpdateBot(Bot& bot, double now);
  void RunScript(Bot& bot, double now);
  void NoteFailure(const Bot& bot, double now);
  void AddArrival(const client::SnapshotArrival& arrival);
  [[nodiscard]] bool HasEnded(const Bot& bot) const;

  LoadTestOptions m_options;
  std::vector<Stage> m_stages;
  unsigned m_starts;  // in all stages
  Script& m_script;
  Connect m_connect;
  Clock m_clock;
  Log m_log;
  OnShown m_onShown;

  std::vector<std::unique_ptr<Bot>> m_bots;
  unsigned m_round = 0;
  unsigned m_dismissed = 0;
  std::vector<client::BodySample> m_samples;  // scratch
  bool m_leaving = false;
  std::string m_refusal;
  std::optional<double> m_firstFailure;  // of a bot that did not leave by itself
  unsigned m_failuresLogged = 0;
  std::set<std::string> m_scriptErrors;  // those reported

  Histogram m_joinMs;
  Histogram m_ageMs;
  Histogram m_inputToSnapshotMs;
  Histogram m_decodeUs;
  Histogram m_lateMs;

  double m_decodeSeconds = 0;  // of the group of records that is being filled
  std::uint64_t m_decodeRecords = 0;

  double m_progressSeconds = 0;  // played by then, over all bots
  std::uint64_t m_progressBytes = 0;
  double m_progressAgeSum = 0;
  std::uint64_t m_progressArrivals = 0;
  double m_progressLate = 0;
};

}  // namespace wobble::bots
