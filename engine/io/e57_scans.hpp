// The description of scans in an E57 file: XML, read by the library pugixml if the program was built with it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/log.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// The bytes of an E57 file (ASTM E2807), stored in pages with a checksum each.
class E57Pages {
 public:
  /// Reads the whole file and verifies every checksum. Throws FileError with the byte and the page of the damage.
  E57Pages(const std::filesystem::path& file, Log* log);

  const std::filesystem::path& file() const { return file_; }
  std::string_view xml() const { return xml_; }

  /// `count` bytes from a byte of the file on, without checksums. Throws FileError if the file is too short; `saidAt`
  /// is the byte of the file that contains the request.
  std::span<const std::byte> from(std::uint64_t fileByte, std::uint64_t count, std::uint64_t saidAt) const;
  /// All bytes from a byte of the file on.
  std::span<const std::byte> from(std::uint64_t fileByte, std::uint64_t saidAt) const;
  /// Position in the file of one of those bytes.
  std::uint64_t fileByteOf(const std::byte* at) const;

 private:
  void checkPages(std::span<const std::byte> whole);
  void readHeader(std::size_t fileBytes);

  std::filesystem::path file_;
  BareVector<std::byte> bytes_;
  std::string_view xml_;
};

/// One value of each point, and its encoding.
struct E57Field {
  enum class Kind { integer, scaled, single, real, text };

  std::string name;
  Kind kind = Kind::integer;
  std::int64_t least = 0, most = 0;  ///< of integers, as stored
  double scale = 1, offset = 0;      ///< for scaled integers

  /// Size of one value; 0 if all are equal or the size varies.
  unsigned bits() const;
};

/// A scan in its own coordinates, and its pose: rotation by a quaternion (w, x, y, z; unit length), then translation.
struct E57Scan {
  std::string name;
  std::uint64_t pointsAt = 0;  ///< byte of the file
  std::uint64_t points = 0;
  std::vector<E57Field> fields;
  std::array<double, 4> rotation{1, 0, 0, 0};
  double rotationLength = 1;  ///< of the quaternion in the file
  DVec3 translation{0};
  /// Minimum and maximum of red, green and blue, if declared.
  std::optional<std::array<std::array<double, 2>, 3>> colorLimits;
};

struct E57Contents {
  std::vector<E57Scan> scans;
  std::size_t images = 0;
};

/// Whether the program was built with pugixml; otherwise readE57Contents() throws.
bool canReadE57();

/// Throws FileError for invalid XML or invalid contents.
E57Contents readE57Contents(const E57Pages& pages);

}  // namespace palpate
