// Checks a folder of keys before DDS gets it: faults are reported in words, and encryption is only reported if it is
// on.
#include <cerrno>
#include <fstream>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>

#include "haptics/sharing/openssl.hpp"
#include "haptics/sharing/security.hpp"

namespace palpate {

using namespace openssl;

namespace {

enum Kind : std::size_t { identityAuthority, certificate, privateKey, permissionsAuthority, governance, permissions };

/// Reads and checks the files of a folder, one after the other.
class ProfileReader {
 public:
  explicit ProfileReader(std::filesystem::path folder) : folder_(std::move(folder)) {}

  SecurityProfile read() {
    requireFolder();
    for (std::size_t kind = 0; kind < SecurityProfile::kFiles.size(); ++kind)
      profile_.contents[kind] = contentOf(Kind(kind));
    const Certificate authority = certificateIn(identityAuthority), own = certificateIn(certificate);
    requireOwnKey(own);
    requireSigned(own, authority);
    const Certificate allowing = certificateIn(permissionsAuthority);
    textSignedBy(allowing, permissions);
    requireEncryption(textSignedBy(allowing, governance));
    profile_.authority = nameOf(authority);
    profile_.name = nameOf(own);
    return std::move(profile_);
  }

 private:
  std::filesystem::path file(Kind kind) const { return folder_ / SecurityProfile::kFiles[kind]; }
  template <class... Args>
  [[noreturn]] void refuse(Kind kind, fmt::format_string<Args...> text, Args&&... args) const {
    throw FileError(file(kind), fmt::format(text, std::forward<Args>(args)...));
  }

  void requireFolder() const {
    std::error_code none;
    if (!std::filesystem::is_directory(folder_, none))
      throw FileError(folder_, "is not a folder of keys: it does not exist");
    if (std::filesystem::exists(folder_ / "authority", none))
      throw FileError(folder_,
                      "contains an authority and the keys of several holders; name the folder of one holder in it");
  }

  std::string contentOf(Kind kind) const {
    const std::filesystem::path path = file(kind);
    constexpr std::uintmax_t kLargest = 1 << 20;
    std::error_code fault;
    const std::filesystem::file_status status = std::filesystem::status(path, fault);
    if (!std::filesystem::exists(status)) refuse(kind, "is missing in this folder of keys");
    if (!std::filesystem::is_regular_file(status)) refuse(kind, "is not a file");
    using std::filesystem::perms;
    if (kind == privateKey && (status.permissions() & (perms::group_all | perms::others_all)) != perms::none)
      refuse(kind, "others than its owner can read or write this private key; prevent that (chmod 600)");
    if (std::filesystem::file_size(path, fault) > kLargest || fault) refuse(kind, "is too large");
    std::ifstream in(path, std::ios::binary);
    std::ostringstream content;
    if (!in || !(content << in.rdbuf())) refuse(kind, "cannot be read");
    return content.str();
  }

  Certificate certificateIn(Kind kind) const {
    Certificate read = certificateOf(profile_.contents[kind]);
    if (!read) refuse(kind, "is not a certificate (PEM)");
    return read;
  }

  void requireOwnKey(const Certificate& own) const {
    const PrivateKey key = privateKeyOf(profile_.contents[privateKey]);
    if (!key) refuse(privateKey, "is not a private key (PEM, without a password)");
    if (X509_check_private_key(own.get(), key.get()) != 1)
      refuse(privateKey, "is not the key of {}", file(certificate).filename().string());
  }

  void requireSigned(const Certificate& own, const Certificate& authority) const {
    const Store store(X509_STORE_new());
    const StoreContext context(X509_STORE_CTX_new());
    if (!store || !context || X509_STORE_add_cert(store.get(), authority.get()) != 1 ||
        X509_STORE_CTX_init(context.get(), store.get(), own.get(), nullptr) != 1)
      throw Error("OpenSSL cannot check certificates: {}", lastFault());
    if (X509_verify_cert(context.get()) == 1) return;
    const int error = X509_STORE_CTX_get_error(context.get());
    const bool isOwn = X509_STORE_CTX_get_error_depth(context.get()) == 0;
    const Kind kind = isOwn ? certificate : identityAuthority;
    const X509* judged = isOwn ? own.get() : authority.get();
    if (error == X509_V_ERR_CERT_HAS_EXPIRED)
      refuse(kind, "has expired on {}; ask for new keys", dateOf(X509_get0_notAfter(judged)));
    if (error == X509_V_ERR_CERT_NOT_YET_VALID)
      refuse(kind, "is valid from {} on; is the clock of this machine right?", dateOf(X509_get0_notBefore(judged)));
    refuse(certificate, "is not signed by the authority of {}: {}", file(identityAuthority).filename().string(),
           X509_verify_cert_error_string(error));
  }

  // Signed by that authority itself, as DDS Security requires.
  std::string textSignedBy(const Certificate& authority, Kind kind) const {
    BIO* content = nullptr;
    const SignedText text(SMIME_read_PKCS7(readFrom(profile_.contents[kind]).get(), &content));
    const Bio contentOwner(content);
    if (!text) refuse(kind, "is not a signed document (S/MIME)");
    STACK_OF(X509)* signers = sk_X509_new_null();
    sk_X509_push(signers, authority.get());
    const Bio out = collect();
    const int verified =
        PKCS7_verify(text.get(), signers, nullptr, content, out.get(), PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN);
    sk_X509_free(signers);
    if (verified != 1)
      refuse(kind, "is not signed by the authority of {}", file(permissionsAuthority).filename().string());
    return textOf(out);
  }

  // Programs do what the document says; palpate must not report encryption where there is none.
  void requireEncryption(const std::string& text) const {
    pugi::xml_document document;
    const auto rules = document.load_buffer(text.data(), text.size())
                           ? document.child("dds").child("domain_access_rules").children("domain_rule")
                           : pugi::xml_node().children("domain_rule");
    if (rules.begin() == rules.end()) refuse(governance, "has no rules for any domain");
    for (const pugi::xml_node& rule : rules) {
      const std::string_view lets = rule.child("allow_unauthenticated_participants").text().get();
      if (lets != "false" && lets != "FALSE" && lets != "0") refuse(governance, "admits programs without keys");
      bool isEncrypted = isEncrypting(rule.child("rtps_protection_kind"));
      if (!isEncrypted) {
        const auto topics = rule.child("topic_access_rules").children("topic_rule");
        isEncrypted = topics.begin() != topics.end();
        for (const pugi::xml_node& topic : topics)
          isEncrypted = isEncrypted && isEncrypting(topic.child("data_protection_kind"));
      }
      if (!isEncrypted) refuse(governance, "does not require encryption");
    }
  }
  static bool isEncrypting(const pugi::xml_node& kind) {
    return std::string_view(kind.text().get()).starts_with("ENCRYPT");
  }

  std::filesystem::path folder_;
  SecurityProfile profile_;
};

}  // namespace

SecurityProfile readSecurityProfile(const std::filesystem::path& folder) { return ProfileReader(folder).read(); }

}  // namespace palpate
