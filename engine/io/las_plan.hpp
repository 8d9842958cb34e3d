// Assigns values of a cloud to the fields of a LAS point.
#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

/// Integer coordinates of a cloud, as stored in LAS.
struct LasGrid {
  CoordinateGrid grid;
  bool exact = true;  ///< every point is exactly on the grid, bit by bit
};

/// The grid of the original file; if points are off it and its step is not below a quarter of their spacing, refined by
/// a power of ten, so that points on it keep their values. Else the coarsest decimal grid, with steps from 1 to 1e-9,
/// that contains the points; else the finest power of two for which 32 bits suffice. The integers of all points fit
/// into 32 bits.
LasGrid lasGridFor(const PointCloud& cloud);

/// A field of points, and the attribute stored in it.
struct LasSource {
  LasField field;
  const Attribute* attribute = nullptr;

  double value(std::size_t i) const;
  /// Whether all values can be stored without loss.
  bool fits() const;
  /// Writes into rows; the first row is that of point `begin`.
  void encode(std::size_t begin, std::size_t end, std::byte* rows, std::size_t rowBytes) const;
};

/// Refers to the cloud, which must outlive the object.
class LasPlan {
 public:
  explicit LasPlan(const PointCloud& cloud);

  /// Throws FileError if a point would be longer than LAS allows.
  void check(const std::filesystem::path& file) const;
  const LasSource* sourceOf(std::string_view name) const;
  /// Writes rows of points into zeroed bytes.
  void encode(const PointCloud& cloud, std::size_t begin, std::size_t end, std::byte* rows) const;
  std::uint16_t color(const PointCloud& cloud, std::size_t i, std::size_t channel) const;

  const LasBaggage* baggage = nullptr;  ///< null: the cloud was not read from a LAS file
  LasHeader old;                        ///< header of that file
  std::uint32_t oldEarlyCount = 0;      ///< number of points in the field that all versions have
  unsigned minor = 2, format = 0;
  LasPointFormat points;
  std::size_t pointBytes = 0;
  std::vector<std::byte> descriptors;
  std::vector<LasSource> sources;
  LasGrid grid;

 private:
  void choose(const PointCloud& cloud);
  void takeOldExtra();
  void take(const Attribute& attribute);
  bool isTaken(const Attribute& attribute) const;

  std::vector<Attribute> normals_;
  std::vector<const Attribute*> attributes_;
  std::array<const Attribute*, 3> fineColors_{};
  unsigned colorStep_ = 257;
};

/// Attributes that are not written because normals are stored under their names.
std::vector<std::string> lasNamesGivingWay(const PointCloud& cloud);

}  // namespace palpate
