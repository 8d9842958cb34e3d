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

/// One scalar per point that is copied from input to output without interpretation.
struct Attribute {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::vector<std::byte> data;  ///< size() values in native byte order
};

/// Coordinates that a file stores as integers k: offset + k * step, in double precision.
struct CoordinateGrid {
  DVec3 step{1}, offset{0};

  DVec3 at(const DVec3& k) const { return k * step + offset; }
  /// The integers of the grid position next to `p`.
  DVec3 nearest(const DVec3& p) const;
  bool operator==(const CoordinateGrid&) const = default;
};

/// Data that only the original format can store: its reader passes it to its writer.
struct FormatBaggage {
  virtual ~FormatBaggage() = default;
  std::string format;    ///< its name
  std::string sentence;  ///< what any other format loses, in words; empty: nothing
};

/// How a cloud was stored, so that it is written back the same way.
struct StoredAs {
  ScalarType position = ScalarType::f32;  ///< f32 or f64; f64 is used in any case when the origin is not zero
  ScalarType normal = ScalarType::f32;    ///< f32 or f64
  ScalarType color = ScalarType::u8;      ///< u8: 0 to 255, u16: 0 to 65535, f32 and f64: 0 to 1
  bool alpha = false;                     ///< colours have a fourth channel; otherwise alpha is 255
  std::vector<std::string> comments;      ///< header lines that begin with `comment` or `obj_info`, including that word
  /// If the file's coordinates are integers. A point whose position is still the float32 of a grid position is at that
  /// grid position, bit by bit, if float32 distinguishes the grid positions.
  std::optional<CoordinateGrid> grid = {};
  std::shared_ptr<const FormatBaggage> baggage = {};  ///< null if there is none
};

struct PointCloud {
  /// File coordinates = origin + position. Nonzero only if the file stores more than single precision (or a shape lies
  /// far from zero), so that clouds far from zero keep their detail in float32.
  DVec3 origin{0};
  std::vector<Vec3> positions;                      ///< model units, relative to origin; always finite
  std::vector<Vec3> normals;                        ///< unit length
  std::vector<std::array<std::uint8_t, 4>> colors;  ///< RGBA, 0 to 255
  std::vector<Attribute> extra;
  /// File coordinates in full, if float32 cannot hold them. A point whose position is still float(exact - origin) has
  /// not moved and is written back from here, bit by bit.
  BareVector<DVec3> exactPositions;
  StoredAs storedAs;

  std::size_t size() const { return positions.size(); }
  bool empty() const { return positions.empty(); }
  bool hasNormals() const { return !normals.empty(); }
  bool hasColors() const { return !colors.empty(); }

  /// Point `i` in the file's coordinates, as precisely as known.
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

/// Extent of a whole cloud, for code that has only a part of it.
struct PointExtent {
  Bounds bounds;  ///< relative to its origin
  std::uint64_t points = 0;
  bool operator==(const PointExtent&) const = default;
};

/// The origin for points inside `box`: zero if float32 then resolves a millionth of the longest side (no coordinate
/// beyond 16 longest sides), otherwise about the middle, rounded to a power of two below the longest side so that
/// subtracting it is exact.
DVec3 originFor(const Bounds& box);

}  // namespace palpate
