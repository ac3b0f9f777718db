#include "client/host/part.h"

#include <signal.h>

#include <cstdio>
#include <cstdlib>

namespace wobble::host {
namespace {

std::string FormatSeconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, seconds < 10 ? "%.2g s" : "%.0f s", seconds);
  return text;
}

std::string DescribeDeath(const Part& part, double now) {
  const std::string ended = part.wasLate ? "was not ready in time and was killed"
                                         : "ended with exit code " + std::to_string(part.exitCode.value_or(0));
  switch (part.keeper.ReadState()) {
    case Keeper::State::kWaiting:
      return ended + "; starts again in " + FormatSeconds(part.keeper.WaitLeft(now));
    case Keeper::State::kGivenUp:
      return ended + "; not started again";
    default:
      return ended;
  }
}

void TakeLines(Part& part, double now, PartNews& news) {
  for (std::string& line : part.child->TakeOutput()) {
    if (part.readyLine.empty() && line.starts_with(part.readyPrefix)) {
      part.readyLine = line;
      news.isReady = part.keeper.ReadState() == Keeper::State::kStarting;
      if (part.role != Part::Role::kBots) continue;  // theirs is a status line
    }
    line.erase(0, line.find_first_not_of(' '));
    part.line = std::move(line);
  }
  for (const std::string& line : part.child->TakeErrors()) {
    news.errors.push_back(line.starts_with(part.errorPrefix) ? line.substr(part.errorPrefix.size()) : line);
  }
  if (!news.isReady) return;
  const double down = part.keeper.DownFor(now);
  const unsigned restarts = part.keeper.Restarts();
  part.keeper.NoteReady(now);
  if (part.keeper.Restarts() > restarts) news.change = "is back after " + FormatSeconds(down);
}

}  // namespace

std::uint16_t ReadPort(const Part& part) {
  const std::size_t digits = part.readyLine.find_first_of("0123456789");
  return digits == std::string::npos
             ? std::uint16_t{0}
             : static_cast<std::uint16_t>(std::strtoul(part.readyLine.c_str() + digits, nullptr, 10));
}

std::string StartPart(Part& part, const std::vector<std::string>& command, double now) {
  part.readyLine.clear();
  part.line.clear();
  part.exitCode.reset();
  part.wasLate = false;
  part.keeper.NoteStart(now);
  part.child = std::make_unique<command::Child>();
  std::string error;
  if (part.child->Start(command, error)) return "";
  part.exitCode = 1;
  part.keeper.NoteEnd(now, 1);
  return error;
}

PartNews FollowPart(Part& part, double now) {
  PartNews news;
  if (!part.child || part.exitCode) return news;
  part.child->Update();
  TakeLines(part, now, news);
  if (part.child->IsRunning()) {
    part.wasLate |= part.keeper.IsLate(now);
    if (part.wasLate) part.child->Signal(SIGKILL);
    return news;
  }
  const Keeper::State before = part.keeper.ReadState();
  part.exitCode = part.child->ExitCode();
  part.keeper.NoteEnd(now, part.exitCode.value_or(1));
  if (before != Keeper::State::kEnding) news.change = DescribeDeath(part, now);
  return news;
}

}  // namespace wobble::host
