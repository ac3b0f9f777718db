#include "client/list/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "protocol/text.h"

namespace wobble::list {
namespace {

using Row = std::array<std::string, 5>;

constexpr std::size_t kMaxCellBytes = 100;

std::string Show(const std::string& text) {
  const std::string line = protocol::MakeLine(text, kMaxCellBytes);
  return line.empty() ? "-" : line;
}

// In characters, not bytes.
std::size_t FindWidth(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<std::uint8_t>(c) & 0xC0U) != 0x80; }));
}

Row MakeRow(const World& world) {
  Row row{Show(world.told.name), Show(world.address), Show(world.told.scene), "-", "-"};
  if (!world.ping) return row;
  row[3] = std::to_string(world.told.players) + "/" + std::to_string(world.told.maxPlayers) +
           (world.told.isPrivate ? ", closed" : "");
  char ping[32];
  std::snprintf(ping, sizeof ping, "%.*f ms", *world.ping < 0.001 ? 2 : *world.ping < 0.01 ? 1 : 0, 1000 * *world.ping);
  row[4] = ping;
  return row;
}

}  // namespace

std::string WriteTable(const std::vector<World>& worlds) {
  std::vector<Row> rows{{"NAME", "ADDRESS", "SCENE", "PLAYERS", "PING"}};
  for (const World& world : worlds) rows.push_back(MakeRow(world));
  std::array<std::size_t, 5> widths{};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], FindWidth(row[i]));
  }
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      text += row[i] + std::string(widths[i] + 2 - FindWidth(row[i]), ' ');
    text += row.back() + "\n";
  }
  return text;
}

std::string WriteJson(const std::vector<World>& worlds) {
  auto list = nlohmann::json::array();
  const auto clean = [](const std::string& text) -> nlohmann::json {
    return text.empty() ? nlohmann::json() : nlohmann::json(protocol::MakeLine(text, protocol::kMaxShownBytes));
  };
  for (const World& world : worlds) {
    nlohmann::json entry{{"name", clean(world.told.name)},
                         {"address", clean(world.address)},
                         {"scene", clean(world.told.scene)},
                         {"version", clean(world.told.version)},
                         {"key", clean(world.key)},
                         {"players", nullptr},
                         {"max_players", nullptr},
                         {"closed", nullptr},
                         {"ping_ms", nullptr}};
    if (world.ping) {
      entry["players"] = world.told.players;
      entry["max_players"] = world.told.maxPlayers;
      entry["closed"] = world.told.isPrivate;
      entry["ping_ms"] = std::round(1e5 * *world.ping) / 100;
    }
    list.push_back(std::move(entry));
  }
  return list.dump(2) + "\n";
}

}  // namespace wobble::list
