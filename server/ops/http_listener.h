// A small HTTP server for machines and administrators, which slow and many clients cannot hold up.
//
// It has a thread of its own. A connection has one request and two seconds for all of it, however slowly bytes come;
// an address has kMostPerAddress connections; and when kMostConnections are open, a new one takes the place of the
// oldest whose request is not complete.
//
// cpp-httplib was used before: its timeouts are for one read, and each connection holds one of its threads, so two
// sockets that sent a kilobyte a second kept /healthz from answering for 18 s.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/ops/address.h"

namespace wobble::ops {

struct HttpRequest {
  std::string method;         // "GET", "POST", ...
  std::string target;         // path and query as they came
  std::string authorization;  // the header's value; empty: none
  std::string body;           // at most HttpListener::kMostBodyBytes
};

struct HttpResponse {
  unsigned status = 200;
  std::string body = {};
  std::string type = "text/plain; charset=utf-8";
};

class HttpListener {
 public:
  static constexpr std::size_t kMostConnections = 64;
  static constexpr std::size_t kMostPerAddress = 8;
  static constexpr std::size_t kMostHeaderBytes = 4096;
  static constexpr std::size_t kMostBodyBytes = 1024;

  // answer: called on the listener's thread, one request at a time. Null with one line in `error` when the address
  // cannot be listened on.
  using Handler = std::function<HttpResponse(const HttpRequest&)>;
  [[nodiscard]] static std::unique_ptr<HttpListener> Listen(const Address& address, Handler answer, std::string& error);
  // Closes all connections and joins the thread.
  ~HttpListener();

  // The TCP port on which it listens, whether given or picked by the system.
  [[nodiscard]] std::uint16_t ReadPort() const;

 private:
  struct Implementation;
  explicit HttpListener(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> m;
};

}  // namespace wobble::ops
