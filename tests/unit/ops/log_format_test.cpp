#include "server/ops/log_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/details/log_msg.h>

#include <chrono>
#include <nlohmann/json.hpp>

namespace wobble::ops {
namespace {

// A line of the log at 2026-11-25 08:10:06.123 UTC.
std::string Format(LogFormat format, const std::string& message) {
  const std::chrono::system_clock::time_point time{std::chrono::milliseconds{1795594206123}};
  spdlog::memory_buf_t line;
  MakeLogFormatter(format)->format({time, {}, "", spdlog::level::warn, message}, line);
  return {line.data(), line.size()};
}

TEST(LogFormat, TextHasADate) {
  EXPECT_THAT(Format(LogFormat::kText, "player 7 'Eve' joins"),
              testing::MatchesRegex("2026-11-2[456] [0-9:]+\\.123 warning player 7 'Eve' joins\n"));
}

TEST(LogFormat, JsonIsAnObjectALine) {
  EXPECT_EQ(Format(LogFormat::kJson, "player 7 joins"),
            "{\"time\":\"2026-11-25T08:10:06.123Z\",\"level\":\"warning\",\"message\":\"player 7 joins\"}\n");
}

// Names of players and messages of sidecars may hold anything.
TEST(LogFormat, AnyMessageIsOneValidObject) {
  std::string all;
  for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
  const std::string zero("a\0b", 3);
  for (const std::string& message :
       {std::string(), std::string(R"(","level":"error)"), std::string("\\"), std::string("two\nlines\r\n"), zero, all,
        std::string("\xc3"), std::string("\xf0\x9f\x98\x80 %v {} %*"), std::string(100000, '"')}) {
    const std::string line = Format(LogFormat::kJson, message);
    ASSERT_EQ(line.find('\n'), line.size() - 1);
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json.size(), 3U);
    EXPECT_EQ(json.at("level"), "warning");
    if (message != all && message != "\xc3") {
      EXPECT_EQ(json.at("message"), message);
    }
  }
  EXPECT_EQ(nlohmann::json::parse(Format(LogFormat::kJson, "a\xc3")).at("message"), "a\xef\xbf\xbd");
}

TEST(LogFormat, WordsForIt) {
  EXPECT_EQ(ParseLogFormat("text"), LogFormat::kText);
  EXPECT_EQ(ParseLogFormat("json"), LogFormat::kJson);
  for (const char* word : {"", "JSON", "xml"}) EXPECT_EQ(ParseLogFormat(word), std::nullopt) << word;
}

}  // namespace
}  // namespace wobble::ops
