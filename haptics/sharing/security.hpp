// Who may find, join and hear a session: makes and checks keys for DDS Security. Independent of DDS and OpenSSL.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/core/error.hpp"

namespace palpate {

struct KeyRequest {
  /// Folder of an authority and of all keys that it signs; an existing or a new one.
  std::filesystem::path folder;
  std::string name;          ///< of the holder, and of its folder within that one
  std::uint32_t days = 365;  ///< of validity
  /// Seconds since 1970 at which they are made; empty: now.
  std::optional<std::int64_t> now_s = std::nullopt;
};

struct MadeKeys {
  std::filesystem::path folder;  ///< of the keys, to be given to their holder
  std::string authority;         ///< its name
  bool isNewAuthority = false;
  std::string until;  ///< end of validity, a date
};

/// Makes keys for one holder: a certificate that the authority has signed, its private key, and its permissions.
/// Creates the authority if there is none. All files are private to this user, and existing ones are never overwritten.
/// Throws UsageError, FileError.
MadeKeys makeKeys(const KeyRequest& request);

/// The keys of one participant, as read from a folder: the files of an enclave, with ROS 2's names.
struct SecurityProfile {
  static constexpr std::array<const char*, 6> kFiles{"identity_ca.cert.pem",    "cert.pem",       "key.pem",
                                                     "permissions_ca.cert.pem", "governance.p7s", "permissions.p7s"};
  std::array<std::string, kFiles.size()> contents;  ///< of those files
  std::string authority;                            ///< name of the authority that signed the certificate
  std::string name;                                 ///< of the holder
};

/// Reads and checks a folder of keys. Throws FileError, which names the file, if one is missing, is readable by others
/// than its owner, does not match the rest, is not signed, has expired, or requires no encryption.
SecurityProfile readSecurityProfile(const std::filesystem::path& folder);

}  // namespace palpate
