#include "client/host/part_commands.h"

namespace wobble::host {
namespace {

using Words = std::vector<std::string>;

void Add(const Words& more, Words& words) { words.insert(words.end(), more.begin(), more.end()); }

}  // namespace

Words MakeWorldCommand(const Plan& plan, std::size_t world, std::uint16_t port, const std::string& summary) {
  Words words{(plan.programFolder / "wobbled").string(), "--port", std::to_string(port)};
  Add(plan.worlds[world].options, words);
  Add({"--status", "1", "--summary", summary}, words);
  return words;
}

Words MakeGatewayCommand(const Plan& plan, std::uint16_t port, const Words& servers) {
  Words words{(plan.programFolder / "wobble").string(), "gateway", "--http", std::to_string(port)};
  Add({"--bind", plan.gateway->bindAddress, "--status", "1"}, words);
  Add(plan.gateway->options, words);
  for (const std::string& server : servers) Add({"--server", server}, words);
  return words;
}

Words MakeBotsCommand(const Plan& plan, std::size_t world, const std::string& address, const std::string& summary) {
  const BotsPlan& bots = plan.worlds[world].bots;
  Words words{(plan.programFolder / "wobble").string(), "bots", address};
  Add({"--script", bots.script, "--count", std::to_string(bots.count)}, words);
  Add(bots.access, words);
  Add({"--ramp", "1", "--status", "1", "--summary", summary}, words);
  return words;
}

}  // namespace wobble::host
