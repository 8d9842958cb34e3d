// The fields of a cloud: the numbers of each point that an expression names.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"

namespace palpate {

/// A whole number that holds all values of 64 bits, signed or not, and their sums, exactly.
__extension__ using Whole = __int128;

/// Fields that are computed from positions and normals. They have no units of the file but mm, so that thresholds mean
/// the same in every cloud.
enum class MadeField : std::uint8_t {
  height,       ///< along up, file coordinates
  density,      ///< other points within the radius, for each mm2 of its disc
  roughness,    ///< root of the mean squared distance of the points within the radius from their plane, mm
  curvature,    ///< mean curvature of the algebraic sphere that contact fits, 1/mm; positive: convex
  verticality,  ///< 0: the plane of the points within the radius is level, 1: it is upright
};

struct FieldOptions {
  double mm_per_unit = 1;
  double radius = 0;                               ///< of the neighbourhoods, model units; 0: four spacings
  std::optional<UpAxis> up;                        ///< empty: findUp()
  unsigned threads = 0;                            ///< 0: one per core
  std::function<void(double)> progress = nullptr;  ///< of prepared(): called with the share that is done, on any thread
};

/// One value for each point; NaN where the neighbourhood has too few points. Throws Stopped.
std::vector<double> madeField(const PointCloud& cloud, MadeField field, const FieldOptions& options);

/// A view of a cloud, which must outlive it and stay as it is. Fields that are not in the cloud are computed at their
/// first use, by one thread at a time; reading is safe from any thread.
class CloudFields {
 public:
  explicit CloudFields(const PointCloud& cloud, const FieldOptions& options = {});

  struct Field {
    enum class Source : std::uint8_t { coordinate, normal, color, attribute, made };
    std::string name;
    Source source;
    std::size_t index;      ///< axis, channel, attribute, or MadeField
    bool isWhole = false;   ///< 64-bit whole numbers, which doubles do not hold
    bool isSingle = false;  ///< float32 in the file
  };
  /// x, y and z, those of normals and colours if there are any, the attributes, then those that can be computed.
  std::span<const Field> all() const { return fields_; }
  std::vector<std::string> names() const;
  /// The index of a field in all(); empty if there is none. An attribute hides a computed field of the same name.
  std::optional<std::size_t> find(std::string_view name) const;

  /// Computes a field if it is not in the cloud, before it is read.
  void compute(std::size_t field);
  /// The values of the points from `begin` on. Coordinates are those of the file, as its decimals.
  void read(std::size_t field, std::size_t begin, std::span<double> to) const;
  /// The same of a field of whole numbers.
  void read(std::size_t field, std::size_t begin, std::span<Whole> to) const;

  const PointCloud& cloud() const { return cloud_; }
  std::size_t size() const { return cloud_.size(); }
  unsigned threads() const { return options_.threads; }

 private:
  const PointCloud& cloud_;
  FieldOptions options_;
  TextCoordinates coordinates_;
  std::vector<Field> fields_;
  std::map<std::size_t, std::vector<double>> made_;  // by index of the field
};

}  // namespace palpate
