// Who may find, join and hear a session: keys for DDS Security, made and looked at. Nothing of DDS or OpenSSL is seen
// here.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/core/error.hpp"

namespace palpate {

struct KeyRequest {
  /// Of an authority and of all whom it gives keys: one that there is, or one that is made.
  std::filesystem::path folder;
  std::string name;          ///< of who gets the keys; their folder in that one
  std::uint32_t days = 365;  ///< for which they are good
  /// Seconds since 1970 at which they are made; of the clock where nothing is said.
  std::optional<std::int64_t> now_s = std::nullopt;
};

struct MadeKeys {
  std::filesystem::path folder;  ///< of the keys; it is what their holder is given
  std::string authority;         ///< what it is called
  bool isNewAuthority = false;
  std::string until;  ///< a date
};

/// Makes keys for one more: a certificate that the authority has signed, its private key, and what is allowed with it.
/// The authority is made where there is none. All files are of this user alone, and nothing that is there is written
/// over. Throws UsageError, FileError.
MadeKeys makeKeys(const KeyRequest& request);

/// The keys of one participant, as read from a folder: the files of an enclave, as ROS 2 names them.
struct SecurityProfile {
  static constexpr std::array<const char*, 6> kFiles{"identity_ca.cert.pem",    "cert.pem",       "key.pem",
                                                     "permissions_ca.cert.pem", "governance.p7s", "permissions.p7s"};
  std::array<std::string, kFiles.size()> contents;  ///< of those
  std::string authority;                            ///< what the one that has signed the certificate is called
  std::string name;                                 ///< of the holder
};

/// Reads and judges a folder of keys. Throws FileError, which names the file, where one is missing, is readable by
/// others than its owner, does not belong to the rest, is not signed, has expired, or asks for no encryption.
SecurityProfile readSecurityProfile(const std::filesystem::path& folder);

}  // namespace palpate
