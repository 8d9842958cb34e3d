// Makes keys: an authority for certificates (identity) and one for permissions, and for each holder a certificate of
// the first and a document of the second.
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>

#include "engine/core/system_file.hpp"
#include "haptics/sharing/openssl.hpp"
#include "haptics/sharing/security.hpp"

namespace palpate {

using namespace openssl;

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDay_s = 24 * 3600;
constexpr std::int64_t kAuthorityDays = 3650;
constexpr std::uint32_t kMaxDays = 3650;
constexpr const char* kAuthority = "authority";

// All data of an authority are encrypted for the holders of its keys, on every domain, and other participants are not
// accepted. Discovery of participants is in the clear by its nature; it contains no names of sessions or topics.
constexpr const char* kGovernance = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      <domains><id_range><min>0</min><max>230</max></id_range></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>ENCRYPT</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>NONE</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)";

constexpr const char* kPermissions = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="{0}">
      <subject_name>CN={0}</subject_name>
      <validity><not_before>{1}</not_before><not_after>{2}</not_after></validity>
      <allow_rule>
        <domains><id_range><min>0</min><max>230</max></id_range></domains>
        <publish>
          <topics><topic>palpate/*</topic><topic>rt/*</topic></topics>
          <partitions><partition>*</partition></partitions>
        </publish>
        <subscribe>
          <topics><topic>palpate/*</topic><topic>rt/*</topic></topics>
          <partitions><partition>*</partition></partitions>
        </subscribe>
      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)";

// Period of validity, seconds since 1970. It starts a day early: clocks of machines differ.
struct Validity {
  std::int64_t from_s, until_s;
};

struct Signer {
  Certificate certificate;
  PrivateKey key;
};

void require(bool done, const char* what) {
  if (!done) throw Error("OpenSSL cannot make {}: {}", what, lastFault());
}

PrivateKey freshKey() {
  PrivateKey key(EVP_EC_gen("P-256"));
  require(key != nullptr, "a key");
  return key;
}

std::string pemOf(const PrivateKey& key) {
  const Bio out = collect();
  require(PEM_write_bio_PKCS8PrivateKey(out.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1,
          "a key's text");
  return textOf(out);
}

std::string pemOf(const Certificate& certificate) {
  const Bio out = collect();
  require(PEM_write_bio_X509(out.get(), certificate.get()) == 1, "a certificate's text");
  return textOf(out);
}

void extend(X509* certificate, int which, const char* value) {
  X509_EXTENSION* made = X509V3_EXT_conf_nid(nullptr, nullptr, which, value);
  const bool isAdded = made && X509_add_ext(certificate, made, -1) == 1;
  X509_EXTENSION_free(made);
  require(isAdded, "a certificate");
}

// A certificate of `key`, signed by `issuer`, or self-signed if that is null.
Certificate certify(const std::string& name, const PrivateKey& key, const Validity& good, const Signer* issuer) {
  Certificate made(X509_new());
  require(made != nullptr, "a certificate");
  X509* const certificate = made.get();
  std::uint64_t serial = 0;
  require(RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) == 1, "a number");
  X509_NAME* const subject = X509_get_subject_name(certificate);
  const auto* words = reinterpret_cast<const unsigned char*>(name.data());
  const bool isSet =
      X509_set_version(certificate, X509_VERSION_3) == 1 &&
      ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), serial >> 1) == 1 &&
      ASN1_TIME_set(X509_getm_notBefore(certificate), good.from_s) != nullptr &&
      ASN1_TIME_set(X509_getm_notAfter(certificate), good.until_s) != nullptr &&
      X509_set_pubkey(certificate, key.get()) == 1 &&
      X509_NAME_add_entry_by_NID(subject, NID_commonName, MBSTRING_ASC, words, static_cast<int>(name.size()), -1, 0) ==
          1 &&
      X509_set_issuer_name(certificate, issuer ? X509_get_subject_name(issuer->certificate.get()) : subject) == 1;
  require(isSet, "a certificate");
  extend(certificate, NID_basic_constraints, issuer ? "critical,CA:FALSE" : "critical,CA:TRUE");
  extend(certificate, NID_key_usage, issuer ? "critical,digitalSignature" : "critical,keyCertSign,digitalSignature");
  require(X509_sign(certificate, issuer ? issuer->key.get() : key.get(), EVP_sha256()) > 0, "a signature");
  return made;
}

Signer freshAuthority(const std::string& name, const Validity& good) {
  Signer made;
  made.key = freshKey();
  made.certificate = certify(name, made.key, good, nullptr);
  return made;
}

std::string signedBy(const Signer& signer, const std::string& text) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Bio in = readFrom(text), out = collect();
  const SignedText made(PKCS7_sign(signer.certificate.get(), signer.key.get(), nullptr, in.get(), kFlags));
  require(made && SMIME_write_PKCS7(out.get(), made.get(), in.get(), kFlags) == 1, "a signed document");
  return textOf(out);
}

// A folder that gets its name when it is complete.
class FreshFolder {
 public:
  explicit FreshFolder(fs::path target) : target_(std::move(target)) {
    if (fs::exists(fs::symlink_status(target_)))
      throw FileError(target_, "exists already and is not overwritten; give another name");
    made_ = target_.parent_path() / fmt::format(".{}.{}.part", target_.filename().string(), processNumber());
    std::error_code fault;
    if (!fs::create_directory(made_, fault))
      throw FileError(target_, fmt::format("cannot be created: {}", fault.message()));
    fs::permissions(made_, fs::perms::owner_all);
  }
  ~FreshFolder() {
    std::error_code ignored;
    if (!made_.empty()) fs::remove_all(made_, ignored);
  }
  FreshFolder(const FreshFolder&) = delete;
  FreshFolder& operator=(const FreshFolder&) = delete;

  void add(const char* name, const std::string& content) const {
    const fs::path file = made_ / name;
    std::ofstream out(file, std::ios::binary);
    fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);  // the folder is private meanwhile
    if (!out.write(content.data(), static_cast<std::streamsize>(content.size())).flush())
      throw FileError(target_ / name, whyNotWritten(errno));
  }
  // Throws if that name was taken meanwhile.
  void finish() {
    std::error_code fault;
    fs::rename(made_, target_, fault);
    if (fault) throw FileError(target_, fmt::format("cannot be created: {}", fault.message()));
    made_.clear();
  }

 private:
  fs::path target_, made_;
};

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(in)), {});
  if (!in || content.empty()) throw FileError(file, "cannot be read, and the authority is incomplete without it");
  return content;
}

Signer authorityIn(const fs::path& folder, const std::string& name) {
  const fs::path cert = folder / (name + "_ca.cert.pem"), key = folder / (name + "_ca.key.pem");
  Signer read{.certificate = certificateOf(contentOf(cert)), .key = privateKeyOf(contentOf(key))};
  if (!read.certificate) throw FileError(cert, "is not a certificate (PEM)");
  if (!read.key || X509_check_private_key(read.certificate.get(), read.key.get()) != 1)
    throw FileError(key, fmt::format("is not the key of {}", cert.filename().string()));
  return read;
}

// Name of the authority in certificates: the folder's name, with characters that every program reads.
std::string authorityName(const fs::path& folder) {
  constexpr std::size_t kLongest = 40;
  std::string name = fs::weakly_canonical(folder).filename().string().substr(0, kLongest);
  const auto isOdd = [](unsigned char c) { return c > 0x7e || (!std::isalnum(c) && c != '-' && c != '_' && c != '.'); };
  std::ranges::replace_if(name, isOdd, '_');
  return name.empty() ? "palpate" : name;
}

void makeAuthority(const fs::path& folder, std::int64_t now_s) {
  const Validity good{.from_s = now_s - kDay_s, .until_s = now_s + kAuthorityDays * kDay_s};
  const std::string name = authorityName(folder);
  const Signer identity = freshAuthority(name, good), permitting = freshAuthority(name + " permissions", good);
  FreshFolder made(folder / kAuthority);
  made.add("identity_ca.cert.pem", pemOf(identity.certificate));
  made.add("identity_ca.key.pem", pemOf(identity.key));
  made.add("permissions_ca.cert.pem", pemOf(permitting.certificate));
  made.add("permissions_ca.key.pem", pemOf(permitting.key));
  made.add("governance.p7s", signedBy(permitting, kGovernance));
  made.finish();
}

std::string xmlTime(std::int64_t time_s) {
  using namespace std::chrono;
  const sys_seconds time{seconds(time_s)};
  const year_month_day day{floor<days>(time)};
  const hh_mm_ss clock{time - floor<days>(time)};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", static_cast<int>(day.year()),
                     static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count());
}

void requireHolder(const std::string& name) {
  constexpr std::size_t kLongest = 64;  // maximum of a common name
  const bool isName = !name.empty() && name.size() <= kLongest && name != kAuthority && name[0] != '.' &&
                      name[0] != '-' && std::ranges::all_of(name, [](unsigned char c) {
                        return c < 0x7f && (std::isalnum(c) || c == '.' || c == '-' || c == '_');
                      });
  if (!isName)
    throw UsageError(
        "name: '{}' is not a valid holder's name: 1 to {} letters, digits, dots, dashes and underscores, and not '{}'",
        name, kLongest, kAuthority);
}

// Whether there is an authority already. Throws if the folder has other contents.
bool hasAuthority(const fs::path& folder) {
  if (folder.empty()) throw UsageError("folder: has no name");
  std::error_code fault;
  if (fs::is_directory(folder / kAuthority, fault)) return true;
  if (fs::exists(folder, fault) && !fs::is_directory(folder, fault))
    throw FileError(folder, "exists already and is not a folder");
  if (fs::exists(folder, fault) && !fs::is_empty(folder, fault))
    throw FileError(folder, "has other contents and no authority; name a new folder");
  return false;
}

}  // namespace

MadeKeys makeKeys(const KeyRequest& request) {
  using namespace std::chrono;
  requireHolder(request.name);
  if (request.days == 0 || request.days > kMaxDays)
    throw UsageError("days: {} is not between 1 and {}", request.days, kMaxDays);
  const std::int64_t now_s =
      request.now_s.value_or(duration_cast<seconds>(system_clock::now().time_since_epoch()).count());
  const fs::path authority = request.folder / kAuthority;
  const bool isNew = !hasAuthority(request.folder);
  if (isNew) {
    std::error_code fault;
    fs::create_directories(request.folder, fault);
    if (fault) throw FileError(request.folder, fmt::format("cannot be created: {}", fault.message()));
    makeAuthority(request.folder, now_s);
  }
  const Signer identity = authorityIn(authority, "identity"), permitting = authorityIn(authority, "permissions");
  const Validity good{.from_s = now_s - kDay_s, .until_s = now_s + std::int64_t{request.days} * kDay_s};
  const PrivateKey key = freshKey();
  const Certificate certificate = certify(request.name, key, good, &identity);
  MadeKeys keys{.folder = request.folder / request.name,
                .authority = nameOf(identity.certificate),
                .isNewAuthority = isNew,
                .until = dateOf(X509_get0_notAfter(certificate.get()))};
  FreshFolder made(keys.folder);
  made.add("identity_ca.cert.pem", contentOf(authority / "identity_ca.cert.pem"));
  made.add("cert.pem", pemOf(certificate));
  made.add("key.pem", pemOf(key));
  made.add("permissions_ca.cert.pem", contentOf(authority / "permissions_ca.cert.pem"));
  made.add("governance.p7s", contentOf(authority / "governance.p7s"));
  made.add("permissions.p7s",
           signedBy(permitting, fmt::format(kPermissions, request.name, xmlTime(good.from_s), xmlTime(good.until_s))));
  made.finish();
  return keys;
}

}  // namespace palpate
