// OpenSSL with owning handles.
#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include <memory>
#include <string>
#include <string_view>

namespace palpate::openssl {

template <auto end>
struct Freed {
  template <class T>
  void operator()(T* made) const {
    end(made);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using PrivateKey = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using SignedText = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;
using Store = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;

Bio readFrom(std::string_view text);
Bio collect();
/// The text that was written to it.
std::string textOf(const Bio& bio);

// Null if the text is not valid.
Certificate certificateOf(std::string_view pem);
PrivateKey privateKeyOf(std::string_view pem);

/// The holder's common name; control characters are replaced.
std::string nameOf(const Certificate& certificate);
/// "2027-11-24"
std::string dateOf(const ASN1_TIME* time);
/// OpenSSL's last error.
std::string lastFault();

}  // namespace palpate::openssl
