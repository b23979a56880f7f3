#include "server/app/tls_material.h"

#include <ctime>
#include <filesystem>
#include <memory>
#include <utility>

#include <openssl/asn1.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "mapstore/base/small_file.h"

namespace maploc {
namespace {

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

Status Refuse(const std::string& file, const char* reason, const std::string& why) {
  return InvalidArgument(file, why, reason);
}

Bio Reader(const std::string& pem) {
  return Bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
}

// Else OpenSSL asks whoever sits at the terminal.
int NoPassphrase(char*, int, int, void*) { return 0; }

// The first of `pem`; null: it holds none.
// Errors are cleared here and below: what OpenSSL leaves in this thread's queue it would take for a
// failure of the thread's next handshake.
Certificate FirstCertificate(const std::string& pem) {
  Certificate certificate(PEM_read_bio_X509(Reader(pem).get(), nullptr, NoPassphrase, nullptr));
  ERR_clear_error();
  return certificate;
}

Key PrivateKey(const std::string& pem) {
  Key key(PEM_read_bio_PrivateKey(Reader(pem).get(), nullptr, NoPassphrase, nullptr));
  ERR_clear_error();
  return key;
}

// The server looks at its files again and again, which no pipe endures: opening one would wait.
Result<std::string> ReadTlsFile(const std::string& path) {
  std::error_code none;
  if (std::filesystem::is_fifo(path, none)) {
    return Refuse(path, "TLS_FILE_UNREADABLE",
                  "is a pipe, which cannot be read again; give a file");
  }
  return ReadSmallFile(path, "TLS_FILE_UNREADABLE");
}

Result<std::string> ReadCertificates(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(std::string pem, ReadTlsFile(path));
  if (FirstCertificate(pem) != nullptr) return pem;
  return Refuse(path, "TLS_FILE_INVALID",
                "holds no certificate; it must be PEM and begin with BEGIN CERTIFICATE");
}

Result<std::string> ReadKey(const std::string& path) {
  MAPLOC_ASSIGN_OR_RETURN(std::string pem, ReadTlsFile(path));
  if (PrivateKey(pem) != nullptr) return pem;
  return Refuse(path, "TLS_FILE_INVALID",
                "holds no private key that can be read; it must be PEM and not encrypted (openssl "
                "pkey -in OLD -out NEW)");
}

Status CheckDates(const std::string& path, const X509& certificate) {
  if (X509_cmp_current_time(X509_get0_notAfter(&certificate)) < 0) {
    return Refuse(path, "TLS_CERTIFICATE_EXPIRED", "the certificate has expired; renew it");
  }
  if (X509_cmp_current_time(X509_get0_notBefore(&certificate)) > 0) {
    return Refuse(path, "TLS_CERTIFICATE_EXPIRED",
                  "the certificate is not valid yet; is this machine's clock right?");
  }
  return Status::Ok();
}

// One that is in force suffices: a bundle may hold its predecessor too.
Status CheckAuthorities(const std::string& path, const std::string& pem) {
  const Bio reader = Reader(pem);
  Status status;
  while (true) {
    const Certificate authority(PEM_read_bio_X509(reader.get(), nullptr, NoPassphrase, nullptr));
    if (authority == nullptr) break;
    status = CheckDates(path, *authority);
    if (status.ok()) break;
  }
  ERR_clear_error();
  return status;
}

std::int64_t EndOf(const X509& certificate) {
  std::tm utc{};
  ASN1_TIME_to_tm(X509_get0_notAfter(&certificate), &utc);
  // mktime would take it for local time.
  return timegm(&utc);
}

struct Checked {
  TlsMaterial material;
  std::vector<Status> faults;  // none: the material can be used

  void Add(const Status& status) {
    if (!status.ok()) faults.push_back(status);
  }
  std::string Take(Result<std::string> pem) {
    Add(pem.status());
    return pem.ok() ? *std::move(pem) : "";
  }
};

// REQUIRES: both were read.
Status CheckPair(const TlsFiles& files, const X509& certificate, const std::string& key_pem) {
  if (X509_check_private_key(&certificate, PrivateKey(key_pem).get()) == 1) return Status::Ok();
  ERR_clear_error();
  return Refuse(files.key, "TLS_KEY_MISMATCH",
                "is not the key of the certificate " + files.cert +
                    "; give the two files that were made together");
}

Checked Check(const TlsFiles& files) {
  Checked checked;
  TlsMaterial& material = checked.material;
  material.cert_chain_pem = checked.Take(ReadCertificates(files.cert));
  material.key_pem = checked.Take(ReadKey(files.key));
  if (!files.client_ca.empty()) {
    material.client_ca_pem = checked.Take(ReadCertificates(files.client_ca));
    checked.Add(CheckAuthorities(files.client_ca, material.client_ca_pem));
  }
  if (material.cert_chain_pem.empty()) return checked;
  const Certificate certificate = FirstCertificate(material.cert_chain_pem);
  if (!material.key_pem.empty()) checked.Add(CheckPair(files, *certificate, material.key_pem));
  checked.Add(CheckDates(files.cert, *certificate));
  material.end_unix_s = EndOf(*certificate);
  return checked;
}

}  // namespace

Result<TlsMaterial> ReadTlsMaterial(const TlsFiles& files) {
  Checked checked = Check(files);
  if (!checked.faults.empty()) return checked.faults.front();
  return std::move(checked.material);
}

std::vector<Status> FindTlsFaults(const TlsFiles& files) { return Check(files).faults; }

}  // namespace maploc
