#include "haptics/sharing/openssl.hpp"

#include <fmt/format.h>
#include <openssl/err.h>

#include <ctime>

namespace palpate::openssl {

Bio readFrom(std::string_view text) { return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }
Bio collect() { return Bio(BIO_new(BIO_s_mem())); }

std::string textOf(const Bio& bio) {
  char* begin = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &begin);
  return size > 0 ? std::string(begin, static_cast<std::size_t>(size)) : std::string();
}

Certificate certificateOf(std::string_view pem) {
  return Certificate(PEM_read_bio_X509(readFrom(pem).get(), nullptr, nullptr, nullptr));
}

PrivateKey privateKeyOf(std::string_view pem) {
  // Never prompts for a password.
  const auto none = [](char*, int, int, void*) { return -1; };
  return PrivateKey(PEM_read_bio_PrivateKey(readFrom(pem).get(), nullptr, none, nullptr));
}

std::string nameOf(const Certificate& certificate) {
  char name[200] = {};
  X509_NAME_get_text_by_NID(X509_get_subject_name(certificate.get()), NID_commonName, name, sizeof name);
  std::string shown = name;
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return shown;
}

std::string dateOf(const ASN1_TIME* time) {
  std::tm date{};
  if (ASN1_TIME_to_tm(time, &date) != 1) return "an unknown date";
  return fmt::format("{:04}-{:02}-{:02}", date.tm_year + 1900, date.tm_mon + 1, date.tm_mday);
}

std::string lastFault() {
  char words[200];
  ERR_error_string_n(ERR_get_error(), words, sizeof words);
  ERR_clear_error();
  return words;
}

}  // namespace palpate::openssl
