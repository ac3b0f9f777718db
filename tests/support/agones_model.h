// The record of one GameServer in a cluster, and the sidecar before it, as Agones behaves: what the sidecar is told it
// acknowledges at once and writes into the record later, in batches; a crash loses the batch; reads see the record, not
// the batch; a list that is set again takes back what is in the batch. Time is a parameter; no socket.
#pragma once

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace wobble::test {

class AgonesModel {
 public:
  using Json = nlohmann::json;
  using Strings = std::vector<std::string>;
  struct Answer {
    int status = 200;
    std::string body = "{}";
  };

  // Answers a request. Call Write with the same time before.
  Answer Take(const std::string& method, const std::string& path, const std::string& body) {
    requests.push_back(method + " " + path + (body.empty() ? "" : " " + body));
    if (const auto refusal = refusals.find(path); refusal != refusals.end()) return refusal->second;
    const std::string call = method + " " + path;
    if (call == "POST /health") return {};
    if (call == "GET /gameserver") return {.body = Describe()};
    if (call == "POST /ready") return SetState("RequestReady");
    if (call == "POST /allocate") return SetState("Allocated");
    if (call == "POST /shutdown") return SetState("Shutdown");
    if (call == "PATCH /v1beta1/counters/players") return SetCount(Json::parse(body));
    if (call == "PATCH /v1beta1/lists/players") return SetList(Json::parse(body));
    return Fail(404, "Not Found");
  }

  // Writes the batch into the record where it is due. now: s.
  void Write(double now) {
    if (now < m_nextWrite) return;
    m_nextWrite = now + 1;
    if (state == "RequestReady") state = "Ready";  // the controller's part
    const bool isFinal = state == "Shutdown" || state == "Unhealthy";
    if (m_state && !isFinal) {
      if (state == "Allocated" && *m_state == "RequestReady") ++takenBack;
      state = *m_state;
    }
    if (m_count) count = *m_count;
    if (m_list) values = Apply(*m_list);
    Forget();
  }

  // Loses the batch. A sidecar that starts then has a clock of its own.
  void Crash() {
    Forget();
    m_nextWrite = 0;
  }

  std::string state = "Scheduled";
  int count = 0;
  Strings values;
  int capacity = 64;  // of both
  bool isDeclared = true;
  bool leavesOutZeros = false;             // in its JSON
  std::map<std::string, Answer> refusals;  // by path
  Strings requests;                        // such as "POST /ready {}"
  int takenBack = 0;                       // times that a world in use was offered again

 private:
  struct ListBatch {
    std::set<std::string> removed;
    Strings added;
  };

  void Forget() {
    m_state.reset();
    m_count.reset();
    m_list.reset();
  }
  static Answer Fail(int status, const std::string& message) {
    return {status, Json{{"code", 2}, {"message", message}, {"details", Json::array()}}.dump()};
  }
  Answer SetState(const char* next) {
    m_state = next;
    return {};
  }
  Answer SetCount(const Json& request) {
    if (!isDeclared) return Fail(500, "counter not found: players");
    const int wanted = std::stoi(request.at("count").get<std::string>());
    if (wanted < 0 || wanted > capacity) return Fail(500, "out of range. Found Count: " + std::to_string(wanted));
    m_count = wanted;
    return {};
  }
  Answer SetList(const Json& request) {
    if (!isDeclared) return Fail(500, "not found. players List not found");
    const auto wanted = request.at("values").get<Strings>();
    const Strings held = m_list ? Apply(*m_list) : values;
    const auto has = [](const Strings& list, const std::string& value) { return std::ranges::count(list, value) > 0; };
    ListBatch batch;
    for (const std::string& value : held) {
      if (!has(wanted, value)) batch.removed.insert(value);
    }
    for (const std::string& value : wanted) {
      if (!has(held, value)) batch.added.push_back(value);
    }
    m_list = batch;
    return {};
  }
  [[nodiscard]] Strings Apply(const ListBatch& batch) const {
    Strings list;
    for (const std::string& value : values) {
      if (!batch.removed.contains(value)) list.push_back(value);
    }
    for (const std::string& value : batch.added) {
      if (std::ranges::count(list, value) == 0) list.push_back(value);
    }
    list.resize(std::min(list.size(), static_cast<std::size_t>(capacity)));
    return list;
  }
  [[nodiscard]] std::string Describe() const {
    Json status{{"state", state}, {"address", "127.0.0.1"}};
    if (isDeclared) {
      Json counter{{"capacity", std::to_string(capacity)}};
      Json list = counter;
      if (!leavesOutZeros || count != 0) counter["count"] = std::to_string(count);
      if (!leavesOutZeros || !values.empty()) list["values"] = values;
      status["counters"] = {{"players", counter}, {"rooms", {{"count", "1"}, {"capacity", "10"}}}};
      status["lists"] = {{"players", list}};
    }
    return Json{{"object_meta", {{"name", "local"}, {"creation_timestamp", "1"}}}, {"status", status}}.dump();
  }

  double m_nextWrite = 0;  // s
  // The batch.
  std::optional<std::string> m_state;
  std::optional<int> m_count;
  std::optional<ListBatch> m_list;
};

}  // namespace wobble::test
