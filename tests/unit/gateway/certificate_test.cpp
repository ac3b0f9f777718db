#include "client/gateway/certificate.h"

#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace wobble::gateway {
namespace {

constexpr std::time_t kDay = 24 * 60 * 60;
constexpr std::time_t kBegin = 1'700'000'000;  // of the certificates, which hold for ten days

class CertificateTest : public testing::Test {
 protected:
  CertificateTest()
      : m_folder(std::filesystem::path(testing::TempDir()) / ("certificate_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(m_folder);
  }
  ~CertificateTest() override { std::filesystem::remove_all(m_folder); }

  [[nodiscard]] std::string PathOf(const std::string& name) const { return (m_folder / name).string(); }
  void Write(const std::string& name, const std::string& text) const { std::ofstream(PathOf(name)) << text; }

  // NAME.cert, signed by itself, NAME.key and NAME.locked, the key with a passphrase.
  void MakePair(const std::string& name) const {
    EVP_PKEY* key = EVP_EC_gen("P-256");
    X509* certificate = X509_new();
    std::time_t begin = kBegin;  // OpenSSL takes no constant
    X509_time_adj(X509_getm_notBefore(certificate), 0, &begin);
    X509_time_adj(X509_getm_notAfter(certificate), 10 * kDay, &begin);
    X509_set_pubkey(certificate, key);
    X509_sign(certificate, key, EVP_sha256());
    Save(name + ".cert", [&](BIO* bio) { return PEM_write_bio_X509(bio, certificate); });
    Save(name + ".key",
         [&](BIO* bio) { return PEM_write_bio_PrivateKey(bio, key, nullptr, nullptr, 0, nullptr, nullptr); });
    std::string word = "tulip";
    Save(name + ".locked", [&](BIO* bio) {
      return PEM_write_bio_PrivateKey(bio, key, EVP_aes_128_cbc(), nullptr, 0, nullptr, word.data());
    });
    X509_free(certificate);
    EVP_PKEY_free(key);
  }

  // Empty when the files are taken.
  std::string FindError(const std::string& certificate, const std::string& key) {
    std::string error;
    m_warning.clear();
    const TlsContext context = LoadTls({PathOf(certificate), PathOf(key)}, m_now, error, m_warning);
    EXPECT_EQ(context == nullptr, !error.empty());
    return error;
  }

  std::time_t m_now = kBegin + kDay;
  std::string m_warning;

 private:
  template <typename Writer>
  void Save(const std::string& name, Writer write) const {
    BIO* bio = BIO_new_file(PathOf(name).c_str(), "w");
    ASSERT_EQ(write(bio), 1);
    BIO_free(bio);
  }

  std::filesystem::path m_folder;
};

TEST_F(CertificateTest, APairIsTaken) {
  MakePair("own");
  EXPECT_EQ(FindError("own.cert", "own.key"), "");
  EXPECT_EQ(m_warning, "");
}

TEST_F(CertificateTest, EachMistakeNamesOptionFileAndReason) {
  MakePair("own");
  MakePair("other");
  Write("text", "hello\n");
  Write("large", std::string(1024 * 1024 + 1, 'x'));
  const auto quote = [&](const std::string& name) { return "'" + PathOf(name) + "'"; };
  EXPECT_EQ(FindError("none", "own.key"), "--tls-cert: " + quote("none") + " is not there");
  EXPECT_EQ(FindError("own.cert", "none"), "--tls-key: " + quote("none") + " is not there");
  EXPECT_EQ(FindError("", "own.key"), "--tls-cert: " + quote("") + " is no file");
  EXPECT_EQ(FindError("large", "own.key"), "--tls-cert: " + quote("large") + " has more than 1 MiB");
  EXPECT_EQ(FindError("text", "own.key"), "--tls-cert: " + quote("text") + " holds no certificate in PEM");
  EXPECT_EQ(FindError("own.key", "own.cert"), "--tls-cert: " + quote("own.key") + " holds no certificate in PEM");
  EXPECT_EQ(FindError("own.cert", "text"), "--tls-key: " + quote("text") + " holds no key in PEM without a passphrase");
  EXPECT_EQ(FindError("own.cert", "own.locked"),
            "--tls-key: " + quote("own.locked") + " holds no key in PEM without a passphrase");
  EXPECT_EQ(FindError("own.cert", "other.key"),
            "--tls-key: " + quote("other.key") + " is not the key of the certificate " + quote("own.cert"));
}

TEST_F(CertificateTest, OneThatDoesNotHoldNowIsTakenWithAWarning) {
  MakePair("own");
  m_now = kBegin + 11 * kDay;
  EXPECT_EQ(FindError("own.cert", "own.key"), "");
  EXPECT_EQ(m_warning,
            "the certificate '" + PathOf("own.cert") + "' expired at 2023-11-24 22:13 UTC: browsers refuse it");
  m_now = kBegin - kDay;
  EXPECT_EQ(FindError("own.cert", "own.key"), "");
  EXPECT_EQ(m_warning,
            "the certificate '" + PathOf("own.cert") + "' holds from 2023-11-14 22:13 UTC: browsers refuse it");
}

}  // namespace
}  // namespace wobble::gateway
