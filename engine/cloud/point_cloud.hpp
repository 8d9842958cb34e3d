// A point cloud by attributes. Every array is empty or has one entry per point; the order of points is the file's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// One scalar per point that we carry from input to output without knowing what it means.
struct Attribute {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::vector<std::byte> data;  ///< size() values in native byte order
};

/// Coordinates that a file stores as whole numbers k: offset + k * step, in double precision.
struct CoordinateGrid {
  DVec3 step{1}, offset{0};

  DVec3 at(const DVec3& k) const { return k * step + offset; }
  /// The whole numbers of the place next to `p`.
  DVec3 nearest(const DVec3& p) const;
  bool operator==(const CoordinateGrid&) const = default;
};

/// What only the format that a cloud came from can keep: its reader leaves it for its writer.
struct FormatBaggage {
  virtual ~FormatBaggage() = default;
  std::string format;    ///< its name
  std::string sentence;  ///< what any other format loses of it, in words; empty: nothing
};

/// How a cloud was stored, so that it is written back the same way.
struct StoredAs {
  ScalarType position = ScalarType::f32;  ///< f32 or f64; f64 is used in any case when the origin is not zero
  ScalarType normal = ScalarType::f32;    ///< f32 or f64
  ScalarType color = ScalarType::u8;      ///< u8: 0 to 255, u16: 0 to 65535, f32 and f64: 0 to 1
  bool alpha = false;                     ///< colours have a fourth channel; otherwise alpha is 255
  std::vector<std::string> comments;      ///< header lines that begin with `comment` or `obj_info`, with that word
  /// Where the file's coordinates are whole numbers. A point whose position is still the float32 of a place of the grid
  /// is at that place, bit by bit, where float32 tells the places apart.
  std::optional<CoordinateGrid> grid = {};
  std::shared_ptr<const FormatBaggage> baggage = {};  ///< null: none
};

struct PointCloud {
  /// File coordinates = origin + position. Not zero only when the file stores more than single precision (or a shape
  /// lies far from zero), so that clouds far from zero keep their detail in float32.
  DVec3 origin{0};
  std::vector<Vec3> positions;                      ///< model units, relative to origin; always finite
  std::vector<Vec3> normals;                        ///< unit length
  std::vector<std::array<std::uint8_t, 4>> colors;  ///< RGBA, 0 to 255
  std::vector<Attribute> extra;
  /// File coordinates in full, where float32 cannot hold them. A point whose position is still float(exact - origin)
  /// has not moved and is written back from here, bit by bit.
  BareVector<DVec3> exactPositions;
  StoredAs storedAs;

  std::size_t size() const { return positions.size(); }
  bool empty() const { return positions.empty(); }
  bool hasNormals() const { return !normals.empty(); }
  bool hasColors() const { return !colors.empty(); }

  /// Point `i` in the file's coordinates, as well as it is known.
  DVec3 fileCoordinates(std::size_t i) const;
};

/// An axis-aligned box.
struct Bounds {
  DVec3 min{0}, max{0};
  double longestSide() const;
  DVec3 center() const { return 0.5 * (min + max); }
  bool contains(const DVec3& p) const;
  bool operator==(const Bounds&) const = default;
};

/// The box around the positions, relative to the cloud's origin, model units. All zero for an empty cloud.
Bounds boundsOf(const PointCloud& cloud);

/// Of a whole cloud, for who has a part of it.
struct PointExtent {
  Bounds bounds;  ///< relative to its origin
  std::uint64_t points = 0;
  bool operator==(const PointExtent&) const = default;
};

/// The origin for points that lie inside `box`: zero where float32 then resolves a millionth of the longest side (no
/// coordinate beyond 16 longest sides), otherwise about the middle, rounded to a power of two below the longest side so
/// that subtracting it loses nothing.
DVec3 originFor(const Bounds& box);

}  // namespace palpate
