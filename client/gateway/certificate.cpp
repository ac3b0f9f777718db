// OpenSSL reads the files, rather than Asio's context, which says only that something is wrong with them.
#include "client/gateway/certificate.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

namespace wobble::gateway {
namespace {

namespace ssl = boost::asio::ssl;

constexpr std::size_t kMaxPemBytes = 1024 * 1024;

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using X509Pointer = std::unique_ptr<X509, decltype(&X509_free)>;
using KeyPointer = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

std::optional<std::string> ReadPem(const char* option, const std::string& path, std::string& error) {
  const auto refuse = [&](const std::string& reason) {
    error = std::string(option) + ": '" + path + "' " + reason;
    return std::nullopt;
  };
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) return refuse("is not there");
  if (!std::filesystem::is_regular_file(path, failure)) return refuse("is no file");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return refuse(std::string("cannot be read: ") + std::strerror(errno));
  std::string text(kMaxPemBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxPemBytes) return refuse("has more than 1 MiB");
  return text;
}

Bio OpenText(const std::string& text) {
  return {BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free};
}

// Without it OpenSSL asks at the terminal.
int RefusePassphrase(char*, int, int, void*) { return 0; }

std::string DescribeTime(const ASN1_TIME* time) {
  std::tm parts{};
  char text[32] = "?";
  if (ASN1_TIME_to_tm(time, &parts) == 1) std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

std::string JudgeTime(const X509& certificate, const std::string& path, std::time_t now) {
  const ASN1_TIME* begin = X509_get0_notBefore(&certificate);
  const ASN1_TIME* end = X509_get0_notAfter(&certificate);
  const std::string subject = "the certificate '" + path + "' ";
  if (X509_cmp_time(end, &now) < 0) return subject + "expired at " + DescribeTime(end) + ": browsers refuse it";
  if (X509_cmp_time(begin, &now) > 0) return subject + "holds from " + DescribeTime(begin) + ": browsers refuse it";
  return "";
}

std::string ReadOpensslReason() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  return reason == nullptr ? "OpenSSL does not say why" : reason;
}

}  // namespace

TlsContext LoadTls(const TlsFiles& files, std::time_t now, std::string& error, std::string& warning) {
  const auto chain = ReadPem("--tls-cert", files.certificate, error);
  if (!chain) return nullptr;
  const auto secret = ReadPem("--tls-key", files.key, error);
  if (!secret) return nullptr;
  ERR_clear_error();
  const X509Pointer certificate(PEM_read_bio_X509(OpenText(*chain).get(), nullptr, RefusePassphrase, nullptr),
                                X509_free);
  if (certificate == nullptr) {
    error = "--tls-cert: '" + files.certificate + "' holds no certificate in PEM";
    return nullptr;
  }
  const KeyPointer key(PEM_read_bio_PrivateKey(OpenText(*secret).get(), nullptr, RefusePassphrase, nullptr),
                       EVP_PKEY_free);
  if (key == nullptr) {
    error = "--tls-key: '" + files.key + "' holds no key in PEM without a passphrase";
    return nullptr;
  }
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    error = "--tls-key: '" + files.key + "' is not the key of the certificate '" + files.certificate + "'";
    return nullptr;
  }
  const auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  SSL_CTX* native = context->native_handle();
  boost::system::error_code failure;
  context->use_certificate_chain(boost::asio::buffer(*chain), failure);
  const bool isTaken = !failure && SSL_CTX_use_PrivateKey(native, key.get()) == 1;
  if (!isTaken || SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION) != 1) {
    error = "--tls-cert: '" + files.certificate +
            "' cannot be used: " + (failure ? failure.message() : ReadOpensslReason());
    return nullptr;
  }
  SSL_CTX_set_options(native, SSL_OP_NO_RENEGOTIATION);  // it costs the server more than who asks for it
  SSL_CTX_set_mode(native, SSL_MODE_RELEASE_BUFFERS);    // 34 kB of each connection that is silent
  warning = JudgeTime(*certificate, files.certificate, now);
  return context;
}

}  // namespace wobble::gateway
