// The certificate and key with which a gateway speaks TLS itself.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <ctime>
#include <memory>
#include <string>

namespace wobble::gateway {

// Files in PEM: the certificate, with those that vouch for it behind it, and its key, without a passphrase.
struct TlsFiles {
  std::string certificate;
  std::string key;  // both empty: the gateway speaks plain HTTP
  [[nodiscard]] bool IsWanted() const { return !certificate.empty(); }
};

using TlsContext = std::shared_ptr<boost::asio::ssl::context>;

// TLS 1.2 and up with these files. Null with one line in `error`, which names option, file and reason. `warning`: a
// line when browsers will refuse the certificate because of its time. now: s since 1970.
[[nodiscard]] TlsContext LoadTls(const TlsFiles& files, std::time_t now, std::string& error, std::string& warning);

}  // namespace wobble::gateway
