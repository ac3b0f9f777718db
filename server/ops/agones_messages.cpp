// 64-bit numbers are strings here, as everywhere in the JSON of Protocol Buffers; what is 0 or empty may be left out.
#include "server/ops/agones_messages.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

namespace wobble::ops {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestMessage = 200;  // bytes

FleetReport::State ReadState(const std::string& name) {
  using State = FleetReport::State;
  if (name == "RequestReady" || name == "Ready" || name == "Reserved") return State::kReady;
  if (name == "Allocated") return State::kAllocated;
  if (name == "Shutdown" || name == "Unhealthy" || name == "Error") return State::kEnded;
  return State::kEarly;  // before the first ready; "" in local mode
}

// The member, or an empty object where there is none.
const Json& FindMember(const Json& object, const char* name) {
  static const Json empty = Json::object();
  if (!object.is_object()) return empty;
  const auto member = object.find(name);
  return member == object.end() ? empty : *member;
}

// Throws Json::exception when there is no object, or its member is neither a number nor a string of one.
std::int64_t ReadNumber(const Json& object, const char* name) {
  static_cast<void>(object.get_ref<const Json::object_t&>());
  if (!object.contains(name)) return 0;
  const Json& number = object.at(name);
  if (!number.is_string()) return number.get<std::int64_t>();
  const auto& text = number.get_ref<const std::string&>();
  std::int64_t value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, result] = std::from_chars(text.data(), last, value);
  if (result != std::errc{} || end != last) return Json(text).get<std::int64_t>();  // throws
  return value;
}

FleetReport ReadReport(const Json& status) {
  FleetReport report;
  report.state = ReadState(status.value("state", ""));
  const Json& counters = FindMember(status, "counters");
  if (counters.contains(kPlayersName)) {
    const Json& counter = counters.at(kPlayersName);
    report.counter = {.count = ReadNumber(counter, "count"), .capacity = ReadNumber(counter, "capacity")};
  }
  const Json& lists = FindMember(status, "lists");
  if (lists.contains(kPlayersName)) {
    const Json& list = lists.at(kPlayersName);
    report.list = {.values = list.value("values", std::vector<std::string>()),
                   .capacity = ReadNumber(list, "capacity")};
    std::ranges::sort(report.list->values);
  }
  return report;
}

// nullopt when it is no JSON of the kind that GET /gameserver answers.
std::optional<FleetReport> ParseGameServer(const std::string& body) {
  try {
    const Json json = Json::parse(body);
    if (json.is_object() && json.contains("status") && json.at("status").is_object()) {
      return ReadReport(json.at("status"));
    }
  } catch (const Json::exception&) {  // NOLINT: the caller says so
  }
  return std::nullopt;
}

// What a body says, for a log: its message if it has one, in one short line.
std::string FindMessage(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  const Json& message = FindMember(json, "message");
  std::string text = (message.is_string() ? message.get<std::string>() : body).substr(0, kLongestMessage);
  std::ranges::replace_if(
      text, [](char byte) { return static_cast<unsigned char>(byte) < ' ' || byte == 0x7f; }, ' ');
  return text;
}

}  // namespace

SidecarRequest MakeRequest(const FleetCall& call) {
  switch (call.kind) {
    case FleetCall::Kind::kHealth:
      return {.path = "/health"};
    case FleetCall::Kind::kLook:
      return {.method = "GET", .path = "/gameserver", .body = ""};
    case FleetCall::Kind::kReady:
      return {.path = "/ready"};
    case FleetCall::Kind::kAllocate:
      return {.path = "/allocate"};
    case FleetCall::Kind::kShutdown:
      return {.path = "/shutdown"};
    case FleetCall::Kind::kSetCount:
      return {.method = "PATCH",
              .path = std::string("/v1beta1/counters/") + kPlayersName,
              .body = Json({{"count", std::to_string(call.count)}}).dump()};
    // Without `capacity`, which stays as it is: the sidecar changes the members that are there.
    case FleetCall::Kind::kSetList:
      return {.method = "PATCH",
              .path = std::string("/v1beta1/lists/") + kPlayersName,
              .body = Json({{"values", call.values}}).dump()};
  }
  return {};
}

FleetAnswer ReadAnswer(const FleetCall& call, int status, const std::string& body, std::string& trouble) {
  FleetAnswer answer{.outcome = FleetAnswer::Outcome::kRefused};
  trouble.clear();
  if (status < 200 || status >= 300) {
    trouble = "status " + std::to_string(status) + ": " + FindMessage(body);
    return answer;
  }
  if (call.kind == FleetCall::Kind::kLook) {
    const std::optional<FleetReport> report = ParseGameServer(body);
    if (!report) {
      trouble = "the answer cannot be read: " + FindMessage(body);
      return answer;
    }
    answer.report = *report;
  }
  answer.outcome = FleetAnswer::Outcome::kDone;
  return answer;
}

}  // namespace wobble::ops
