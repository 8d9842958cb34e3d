// What an E57 file says of its scans: in XML, read by the library pugixml where the program was built with it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/io/e57_pages.hpp"

namespace palpate {

/// One number of each point, and how it is stored.
struct E57Field {
  enum class Kind { integer, scaled, single, real, text };

  std::string name;
  Kind kind = Kind::integer;
  std::int64_t least = 0, most = 0;  ///< of whole numbers, as they are stored
  double scale = 1, offset = 0;      ///< of scaled ones

  /// Of one value; 0 where all are the same, or of no fixed number.
  unsigned bits() const;
};

/// A scan, in its own coordinates, and where they are: rotated by a quaternion (w, x, y, z; of unit length), then
/// moved.
struct E57Scan {
  std::string name;
  std::uint64_t pointsAt = 0;  ///< byte of the file
  std::uint64_t points = 0;
  std::vector<E57Field> fields;
  std::array<double, 4> rotation{1, 0, 0, 0};
  DVec3 translation{0};
  /// Least and largest red, green and blue, where they are said.
  std::optional<std::array<std::array<double, 2>, 3>> colorLimits;
};

struct E57Contents {
  std::vector<E57Scan> scans;
  std::size_t images = 0;
};

/// Whether it was; otherwise readE57Contents() throws that it was not.
bool canReadE57();

/// Throws FileError for what is no XML, or says what cannot be.
E57Contents readE57Contents(const E57Pages& pages);

}  // namespace palpate
