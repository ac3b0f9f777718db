#include "client/admin/ask.h"

#include <httplib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace wobble::admin {
namespace {

constexpr int kPatience = 5;  // s, for the connection and for the answer
constexpr std::size_t kMaxReplyBytes = 1024 * 1024;

// "ok" or "no" in the first line, the answer in the others.
Reply ReadReply(const std::string& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string::npos) return {.isDone = false, .text = "the server has not answered\n"};
  return {.isDone = text.substr(0, end) == "ok", .text = text.substr(end + 1)};
}

}  // namespace

Reply AskSocket(const std::string& path, const std::string& order) {
  const auto fail = [&](const std::string& why) { return Reply{.isDone = false, .text = path + ": " + why + "\n"}; };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return fail("is too long for the path of a socket");
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int connection = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{.tv_sec = kPatience, .tv_usec = 0};
  setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  setsockopt(connection, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  const std::string line = order + "\n";
  const bool isSent = connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                      send(connection, line.data(), line.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(line.size());
  const int reason = errno;
  std::string text;
  char bytes[4096];
  for (ssize_t count = 1; isSent && count > 0 && text.size() < kMaxReplyBytes;) {
    count = recv(connection, bytes, sizeof bytes, 0);
    if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
  }
  close(connection);
  if (isSent) return ReadReply(text);
  const bool isAbsent = reason == ENOENT || reason == ECONNREFUSED;
  return fail(std::strerror(reason) + std::string(isAbsent ? "; a server makes it with --admin-socket " + path : ""));
}

Reply AskHttp(const std::string& host, int port, const std::string& key, const std::string& order) {
  httplib::Client client(host, port);
  client.set_connection_timeout(kPatience);
  client.set_read_timeout(kPatience);
  const httplib::Result result =
      client.Post("/orders", {{"Authorization", "Bearer " + key}}, order, "text/plain; charset=utf-8");
  if (!result) return {.isDone = false, .text = "no answer from " + host + ":" + std::to_string(port) + "\n"};
  if (result->status == 401) return {.isDone = false, .text = "the server has another owner's key\n"};
  if (result->status != 200) return {.isDone = false, .text = "HTTP status " + std::to_string(result->status) + "\n"};
  return ReadReply(result->body);
}

}  // namespace wobble::admin
