// Where each number of a cloud goes in a point of LAS.
#pragma once

#include "engine/io/las_grid.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

/// A field of points, and the attribute that goes there.
struct LasSource {
  LasField field;
  const Attribute* attribute = nullptr;

  double value(std::size_t i) const;
  /// All values can be stored and come back as they are.
  bool fits() const;
  /// Into rows, the first of which is of point `begin`.
  void encode(std::size_t begin, std::size_t end, std::byte* rows, std::size_t rowBytes) const;
};

/// Refers to the cloud, which must outlive it.
class LasPlan {
 public:
  explicit LasPlan(const PointCloud& cloud);

  /// Throws FileError where a point would be longer than LAS can say.
  void check(const std::filesystem::path& file) const;
  const LasSource* sourceOf(std::string_view name) const;
  /// Rows of points, into bytes that are zero.
  void encode(const PointCloud& cloud, std::size_t begin, std::size_t end, std::byte* rows) const;
  std::uint16_t color(const PointCloud& cloud, std::size_t i, std::size_t channel) const;

  const LasBaggage* baggage = nullptr;  ///< null: the cloud comes from no LAS file
  LasHeader old;                        ///< of that file
  std::uint32_t oldEarlyCount = 0;      ///< the number of points in the field that all versions have
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

/// Attributes that are not written because normals or colours are, under their names.
std::vector<std::string> lasNamesGivingWay(const PointCloud& cloud);

}  // namespace palpate
