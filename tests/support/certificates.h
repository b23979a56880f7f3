// Certificates of a test's own: an authority, and what it signs. Keys are new each time, and none
// is kept beyond the test's folder.
#pragma once

#include <memory>
#include <string>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

namespace maploc::testing {

// From `begin_s` to `end_s`, seconds from now.
struct Validity {
  long begin_s = -3600;
  long end_s = 3600;
};
inline constexpr Validity kExpired{-7200, -3600};
inline constexpr Validity kNotYet{3600, 7200};

// PEM texts.
struct Issued {
  std::string cert;
  std::string key;
};

class Authority {
 public:
  explicit Authority(const std::string& name)
      : key_(NewKey()), certificate_(New(name, key_.get(), {})) {
    Extend(certificate_.get(), NID_basic_constraints, "critical,CA:TRUE");
    Sign(certificate_.get(), certificate_.get());
  }

  // What a peer must have to believe this authority.
  std::string ca() const { return Pem(certificate_.get()); }

  // `host` is what a client calls the server: "IP:127.0.0.1" or "DNS:name".
  Issued Issue(const std::string& host, const Validity& validity = {}) const {
    const Key key = NewKey();
    const Certificate certificate = New("peer", key.get(), validity);
    Extend(certificate.get(), NID_subject_alt_name, host.c_str());
    Sign(certificate.get(), certificate_.get());
    return {Pem(certificate.get()), Pem(key.get(), nullptr)};
  }

  // As `openssl genpkey -aes-128-cbc` writes one.
  static std::string EncryptedKey() { return Pem(NewKey().get(), EVP_aes_128_cbc()); }

 private:
  template <auto Free>
  struct FreeWith {
    template <class T>
    void operator()(T* object) const {
      Free(object);
    }
  };
  using Bio = std::unique_ptr<BIO, FreeWith<BIO_free_all>>;
  using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
  using Key = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;

  static Key NewKey() { return Key(EVP_EC_gen("P-256")); }

  static Certificate New(const std::string& name, EVP_PKEY* key, const Validity& validity) {
    Certificate certificate(X509_new());
    X509_set_version(certificate.get(), X509_VERSION_3);
    static long serial = 0;
    ASN1_INTEGER_set(X509_get_serialNumber(certificate.get()), ++serial);
    X509_gmtime_adj(X509_getm_notBefore(certificate.get()), validity.begin_s);
    X509_gmtime_adj(X509_getm_notAfter(certificate.get()), validity.end_s);
    X509_NAME_add_entry_by_txt(X509_get_subject_name(certificate.get()), "CN", MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0);
    X509_set_pubkey(certificate.get(), key);
    return certificate;
  }

  static void Extend(X509* certificate, int what, const char* value) {
    X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, what, value);
    X509_add_ext(certificate, extension, -1);
    X509_EXTENSION_free(extension);
  }

  void Sign(X509* certificate, const X509* issuer) const {
    X509_set_issuer_name(certificate, X509_get_subject_name(issuer));
    X509_sign(certificate, key_.get(), EVP_sha256());
  }

  static std::string Text(BIO* bio) {
    char* bytes = nullptr;
    const long size = BIO_get_mem_data(bio, &bytes);
    return {bytes, static_cast<std::size_t>(size)};
  }
  static std::string Pem(X509* certificate) {
    const Bio bio(BIO_new(BIO_s_mem()));
    PEM_write_bio_X509(bio.get(), certificate);
    return Text(bio.get());
  }
  static std::string Pem(EVP_PKEY* key, const EVP_CIPHER* cipher) {
    const Bio bio(BIO_new(BIO_s_mem()));
    unsigned char passphrase[] = "passphrase";
    PEM_write_bio_PrivateKey(bio.get(), key, cipher, passphrase, cipher != nullptr ? 10 : 0,
                             nullptr, nullptr);
    return Text(bio.get());
  }

  Key key_;
  Certificate certificate_;
};

}  // namespace maploc::testing
