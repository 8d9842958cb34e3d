// The neighbours of a point that decides on insertion or removal, coordinate by coordinate, so that processors compute
// several at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/spatial/gathered_points.hpp"

namespace palpate {

/// A neighbour of the deciding point.
struct ResampleNeighbour {
  DVec3 offset{0};           ///< from the deciding point, model units
  DVec3 normal{0};           ///< unit
  DVec3 rest{0};             ///< position in the cloud as loaded; of a new point, between its ends'; model units
  double spacing = 0;        ///< target, model units
  bool isNew = false;        ///< not in the cloud as loaded
  bool atRest = false;       ///< still at its position as loaded; matters while a ball carves
  std::uint32_t number = 0;  ///< of the point; in the order of ids
  bool unsettled = false;    ///< moved, new, or with a pending request
};

/// The neighbours of one point after another of a group. Keeps its memory. Used by one thread.
class ResampleNeighbours {
 public:
  ResampleNeighbours() = default;
  /// These, all of them near.
  explicit ResampleNeighbours(std::span<const ResampleNeighbour> neighbours);

  /// Collects gathered points, which have to stay: seen(number) gives each, without its offset.
  template <class Seen>
  void gather(const GatheredPoints& points, Seen&& seen);
  /// Finds the neighbours of the point with the number `self`: those of the points with the indices `among` that are
  /// nearer than `radius` to its position, the first `most`. False: there are more.
  struct Self {
    DVec3 place;
    double radius;
    std::uint32_t number;
  };
  bool look(const Self& self, std::span<const std::uint32_t> among, std::size_t most);

  /// Number of neighbours.
  std::size_t size() const { return near_.size(); }
  ResampleNeighbour operator[](std::size_t k) const;
  /// Maximum target spacing of the gathered points, model units.
  double widest() const { return widest_; }

  /// By neighbour, until the next call: squared distance, and cosine between its normal and another one.
  const double* squaredDistances();
  const double* cosines(const DVec3& normal);
  /// By neighbour: its distance, and its sector in a tangent plane (shared::sectorOf()).
  struct Sectors {
    const double* distance;
    const std::uint32_t* sector;
  };
  Sectors sectors(const Frame3& frame);

 private:
  void setNormals();

  const GatheredPoints* gathered_ = nullptr;
  NearPoints near_;
  std::vector<ResampleNeighbour> points_;  // gathered ones
  double widest_ = 0;
  std::vector<double> normalX_, normalY_, normalZ_;  // of the near ones
  std::vector<double> squared_, cosine_, distance_;
  std::vector<std::uint32_t> sectors_;
};

template <class Seen>
void ResampleNeighbours::gather(const GatheredPoints& points, Seen&& seen) {
  gathered_ = &points;
  points_.clear();
  widest_ = 0;
  for (const std::uint32_t number : points.numbers()) {
    points_.push_back(seen(number));
    widest_ = std::max(widest_, points_.back().spacing);
  }
}

}  // namespace palpate
