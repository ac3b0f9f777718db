#include "server/admin/admin_http.h"

#include "protocol/transport/vestibule/keys.h"

namespace wobble::admin {

namespace vestibule = transport::vestibule;

namespace {

constexpr auto kAnswerPatience = std::chrono::milliseconds(2000);
constexpr std::string_view kScheme = "Bearer ";

bool IsOwner(const std::string& authorization, const vestibule::Key& ownerKey) {
  if (authorization.rfind(kScheme, 0) != 0) return false;
  const auto key = vestibule::ParseKey(std::string_view(authorization).substr(kScheme.size()));
  return key && vestibule::AreEqual(*key, ownerKey);
}

}  // namespace

std::unique_ptr<ops::HttpListener> ListenForOrders(const ops::Address& address, const vestibule::Key& ownerKey,
                                                   OrderQueue& queue, std::string& error) {
  const auto answer = [ownerKey, &queue](const ops::HttpRequest& request) -> ops::HttpResponse {
    if (!IsOwner(request.authorization, ownerKey)) return {.status = 401, .body = "the owner's key is asked for\n"};
    if (request.target != "/orders") return {.status = 404, .body = "orders are posted to /orders\n"};
    if (request.method != "POST") return {.status = 405, .body = "orders are posted\n"};
    const Answer done = queue.Ask(request.body, "the administration by HTTP", kAnswerPatience);
    std::string text = done.isDone ? "ok\n" : "no\n";
    for (const std::string& line : done.lines) text += line + "\n";
    return {.body = text};
  };
  return ops::HttpListener::Listen(address, answer, error);
}

}  // namespace wobble::admin
