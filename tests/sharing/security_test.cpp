// Keys as they are made and as they are judged: their holders, and the errors for an invalid folder, which name the
// cause.
#include "haptics/sharing/security.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <functional>

#include "haptics/sharing/openssl.hpp"
#include "tests/content_of.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate::security_test {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kYear_s = 365 * 24 * 3600;
constexpr std::int64_t kLongAgo_s = 1'600'000'000;  // in 2020

void checkSays(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) CHECK_MESSAGE(says(text, part), part);
}

void write(const fs::path& file, const std::string& content) { std::ofstream(file, std::ios::binary) << content; }

/// The document signed by an authority.
std::string signedBy(const fs::path& authority, const std::string& text) {
  using namespace openssl;
  const Certificate certificate = certificateOf(contentOf(authority / "permissions_ca.cert.pem"));
  const PrivateKey key = privateKeyOf(contentOf(authority / "permissions_ca.key.pem"));
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Bio in = readFrom(text), out = collect();
  const SignedText made(PKCS7_sign(certificate.get(), key.get(), nullptr, in.get(), kFlags));
  REQUIRE(SMIME_write_PKCS7(out.get(), made.get(), in.get(), kFlags) == 1);
  return textOf(out);
}

}  // namespace

TEST_CASE("keys are private to their owner and valid, whatever their folder is called") {
  const ScratchFolder scratch;
  for (const char* name : {"lab", "the lab's \"best\" <&> folder", "Gebäude 7"}) {
    CAPTURE(name);
    const fs::path lab = scratch / name;
    const MadeKeys server = makeKeys({.folder = lab, .name = "server"}),
                   second = makeKeys({.folder = lab, .name = "surgeon"});
    CHECK(server.isNewAuthority);
    CHECK_FALSE(second.isNewAuthority);
    CHECK(server.authority == second.authority);
    std::size_t files = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(lab)) {
      CAPTURE(entry.path().string());
      const auto mine = entry.is_directory() ? fs::perms::owner_all : fs::perms::owner_read | fs::perms::owner_write;
      CHECK(entry.status().permissions() == mine);
      CHECK(entry.path().filename().string()[0] != '.');
      files += entry.is_regular_file();
    }
    CHECK(files == 5 + 2 * SecurityProfile::kFiles.size());
    const SecurityProfile one = readSecurityProfile(server.folder), other = readSecurityProfile(second.folder);
    CHECK(one.name == "server");
    CHECK(other.name == "surgeon");
    CHECK(one.authority == server.authority);
    CHECK(one.contents[0] == other.contents[0]);
    CHECK(one.contents[2] != other.contents[2]);
    CHECK(contentOf(lab / "authority" / "identity_ca.key.pem").find("PRIVATE KEY") != std::string::npos);
    // No holder receives the keys of the authority.
    for (const std::string& content : one.contents)
      CHECK(content != contentOf(lab / "authority" / "identity_ca.key.pem"));
  }
}

TEST_CASE("making keys overwrites nothing") {
  const ScratchFolder scratch;
  const fs::path lab = scratch / "lab";
  makeKeys({.folder = lab, .name = "server"});
  const std::string key = contentOf(lab / "server" / "key.pem"),
                    authority = contentOf(lab / "authority" / "identity_ca.key.pem");
  checkSays(errorOf([&] { makeKeys({.folder = lab, .name = "server"}); }), {"lab/server", "exists already"});
  CHECK(contentOf(lab / "server" / "key.pem") == key);
  CHECK(contentOf(lab / "authority" / "identity_ca.key.pem") == authority);
  fs::create_symlink("nowhere", lab / "link");
  checkSays(errorOf([&] { makeKeys({.folder = lab, .name = "link"}); }), {"lab/link", "exists already"});
  fs::create_directory(scratch / "photos");
  write(scratch / "photos" / "cat.jpg", "a cat");
  checkSays(errorOf([&] { makeKeys({.folder = scratch / "photos", .name = "a"}); }), {"photos", "no authority"});
  checkSays(errorOf([&] { makeKeys({.folder = scratch / "photos" / "cat.jpg", .name = "a"}); }),
            {"cat.jpg", "not a folder"});
  CHECK(contentOf(scratch / "photos" / "cat.jpg") == "a cat");
  fs::remove(lab / "authority" / "identity_ca.key.pem");
  checkSays(errorOf([&] { makeKeys({.folder = lab, .name = "b"}); }), {"identity_ca.key.pem", "cannot be read"});
  CHECK_FALSE(fs::exists(lab / "b"));
  for (const char* name : {"", "authority", "..", "a/b", "-x", ".x", "a b", "a\nb"}) {
    CAPTURE(name);
    checkSays(errorOf([&] { makeKeys({.folder = scratch / "new", .name = name}); }), {"name:"});
  }
  CHECK_FALSE(fs::exists(scratch / "new"));
  checkSays(errorOf([&] { makeKeys({.folder = scratch / "new", .name = "a", .days = 0}); }), {"days:"});
}

TEST_CASE("a faulty key folder is reported with the faulty file") {
  const ScratchFolder scratch;
  const fs::path lab = scratch / "lab", other = scratch / "other", tried = scratch / "tried";
  makeKeys({.folder = lab, .name = "a"});
  makeKeys({.folder = lab, .name = "b"});
  makeKeys({.folder = other, .name = "a"});
  const auto fault = [&](const std::function<void()>& spoil) {
    fs::remove_all(tried);
    fs::copy(lab / "a", tried);
    spoil();
    return errorOf([&] { readSecurityProfile(tried); });
  };
  const auto replaced = [&](const char* file, const fs::path& by) {
    return fault([&] { fs::copy_file(by / file, tried / file, fs::copy_options::overwrite_existing); });
  };
  CHECK(fault([] {}).empty());
  for (const char* file : SecurityProfile::kFiles) {
    CAPTURE(file);
    checkSays(fault([&] { fs::remove(tried / file); }), {file, "is missing"});
    checkSays(fault([&] { write(tried / file, "no key, no certificate, no document"); }), {file});
    checkSays(fault([&] { write(tried / file, std::string(2 << 20, 'x')); }), {file, "too large"});
    checkSays(fault([&] { write(tried / file, ""); }), {file});
    checkSays(fault([&] {
                fs::remove(tried / file);
                fs::create_directory(tried / file);
              }),
              {file, "is not a file"});
  }
  for (const fs::perms open : {fs::perms::group_read, fs::perms::others_read, fs::perms::group_write})
    checkSays(fault([&] { fs::permissions(tried / "key.pem", open, fs::perm_options::add); }),
              {"key.pem", "chmod 600"});
  checkSays(replaced("key.pem", lab / "b"), {"key.pem", "is not the key of cert.pem"});
  checkSays(replaced("identity_ca.cert.pem", other / "a"), {"cert.pem", "is not signed by the authority"});
  for (const char* file : {"governance.p7s", "permissions.p7s"})
    checkSays(replaced(file, other / "a"), {file, "is not signed by the authority"});
  checkSays(fault([&] {
              std::string text = contentOf(tried / "governance.p7s");
              text.replace(text.find("<rtps_protection_kind>ENCRYPT<"), 30, "<rtps_protection_kind>NONE   <");
              write(tried / "governance.p7s", text);
            }),
            {"governance.p7s", "is not signed"});
  checkSays(errorOf([&] { readSecurityProfile(lab); }), {"lab", "name the folder of one holder"});
  checkSays(errorOf([&] { readSecurityProfile(scratch / "nowhere"); }), {"nowhere", "it does not exist"});
}

TEST_CASE("expired keys, and keys not yet valid, are refused with the date") {
  const ScratchFolder scratch;
  const std::int64_t now_s =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  const fs::path lab = scratch / "lab";
  const MadeKeys past = makeKeys({.folder = lab, .name = "past", .days = 30, .now_s = now_s - kYear_s});
  checkSays(errorOf([&] { readSecurityProfile(past.folder); }), {"past/cert.pem", "has expired on " + past.until});
  const MadeKeys future = makeKeys({.folder = lab, .name = "future", .now_s = now_s + kYear_s});
  checkSays(errorOf([&] { readSecurityProfile(future.folder); }),
            {"future/cert.pem", "is the clock of this machine right?"});
  const MadeKeys old =
      makeKeys({.folder = scratch / "old", .name = "a", .days = 3650, .now_s = kLongAgo_s - 10 * kYear_s});
  checkSays(errorOf([&] { readSecurityProfile(old.folder); }), {"has expired on"});
}

TEST_CASE("signed rules that do not encrypt, or that admit strangers, are refused") {
  const ScratchFolder scratch;
  const fs::path lab = scratch / "lab";
  makeKeys({.folder = lab, .name = "a"});
  const auto judged = [&](const char* encrypts, const char* data, const char* strangers) {
    write(lab / "a" / "governance.p7s",
          signedBy(lab / "authority",
                   std::string("<dds><domain_access_rules><domain_rule><allow_unauthenticated_participants>") +
                       strangers + "</allow_unauthenticated_participants><rtps_protection_kind>" + encrypts +
                       "</rtps_protection_kind><topic_access_rules><topic_rule><data_protection_kind>" + data +
                       "</data_protection_kind></topic_rule></topic_access_rules></domain_rule>"
                       "</domain_access_rules></dds>"));
    return errorOf([&] { readSecurityProfile(lab / "a"); });
  };
  CHECK(judged("ENCRYPT", "NONE", "false").empty());
  CHECK(judged("SIGN", "ENCRYPT", "false").empty());  // as ROS 2 makes them
  for (const char* kind : {"SIGN", "NONE"})
    checkSays(judged(kind, kind, "false"), {"governance.p7s", "does not require encryption"});
  checkSays(judged("ENCRYPT", "ENCRYPT", "true"), {"governance.p7s", "admits programs without keys"});
  write(lab / "a" / "governance.p7s", signedBy(lab / "authority", "<dds></dds>"));
  checkSays(errorOf([&] { readSecurityProfile(lab / "a"); }), {"governance.p7s", "no rules"});
}

TEST_CASE("a refusal by DDS names the key folder; one domain uses one set of keys") {
  const ScratchFolder scratch;
  const fs::path lab = scratch / "lab";
  makeKeys({.folder = lab, .name = "a"});
  makeKeys({.folder = lab, .name = "b"});
  NetworkConfig network = ownNetwork();
  network.security = (lab / "a").string();
  CHECK(opennessOf(network).find("encrypted, for holders of keys of 'lab' on this machine") == 0);
  {
    const PointCloud cloud;
    const CloudServer server(cloud, {.network = network, .name = "kept", .model = "nothing"});
    checkSays(errorOf([] { discoverSessions(ownNetwork(), 0.1); }), {"with other keys"});
    network.security = (lab / "b").string();
    checkSays(errorOf([&] { discoverSessions(network, 0.1); }), {"with other keys"});
  }
  // Another holder's permissions do not apply.
  fs::copy_file(lab / "a" / "permissions.p7s", lab / "b" / "permissions.p7s", fs::copy_options::overwrite_existing);
  checkSays(errorOf([&] { discoverSessions(network, 0.1); }), {"lab/b", "these keys cannot be used"});
  network.security = (lab / "c").string();
  checkSays(errorOf([&] { discoverSessions(network, 0.1); }), {"lab/c", "it does not exist"});
}

}  // namespace palpate::security_test
