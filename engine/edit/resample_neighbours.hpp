// The neighbours of a point that decides on insertion or removal, coordinate by coordinate, so that processors compute
// several at a time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/spatial/gathered_points.hpp"
#include "shaders/shared/resample.h"

namespace palpate {

/// A neighbour of the deciding point.
struct ResampleNeighbour {
  DVec3 offset{0};                 ///< from the deciding point, model units
  DVec3 normal{0};                 ///< unit, in single precision
  DVec3 rest{0};                   ///< position in the cloud as loaded; of a new point, between its ends'; model units
  std::uint32_t stroke = 0;        ///< number of the stroke that moved it last; 0: none
  DVec3 found{0}, foundNormal{0};  ///< position, model units, and normal as that stroke found it
  double spacing = 0;              ///< target, model units
  bool isNew = false;              ///< not in the cloud as loaded
  bool atRest = false;             ///< still at its position as loaded; matters while a ball carves
  std::uint32_t number = 0;        ///< of the point; in the order of ids
  bool unsettled = false;          ///< moved, new, or with a pending request
};

/// The neighbours of one point after another of a group. Keeps its memory. Used by one thread.
class ResampleNeighbours {
 public:
  /// Gives a point by its number, without its offset.
  using Seen = std::function<ResampleNeighbour(std::uint32_t number)>;

  ResampleNeighbours() = default;
  /// These, all of them near.
  explicit ResampleNeighbours(std::span<const ResampleNeighbour> neighbours);

  /// Looks at gathered points, which have to stay, as `seen` does. `normals` are of all points by number. Most points
  /// are far from any decision: `seen` is called for those that are not.
  void gather(const GatheredPoints& points, std::span<const Vec3> normals, Seen seen);
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

  /// What decides for most points that nothing is to be done.
  struct Survey {
    double nearest = 0;  ///< least squared distance of a neighbour; infinity without one
    std::array<double, shared::kGapSectors>
        gaps{};  ///< distance of the nearest of the same sheet by sector, or infinity
  };
  /// Surveys the neighbours of a point with this tangent plane; then, by neighbour: its squared distance.
  Survey survey(const Frame3& frame);
  const double* squaredDistances() const { return squared_.data(); }
  /// The neighbour at the distance gaps[sector] of the last survey; of several the one with the smallest number.
  std::size_t atGap(std::size_t sector, double distance) const;

 private:
  void makeRoom(std::size_t points);
  const ResampleNeighbour& point(std::uint32_t index) const;

  const GatheredPoints* gathered_ = nullptr;
  Seen seen_;
  NearPoints near_;
  // The gathered points: normals, and the points as far as they were needed.
  std::vector<float> normalX_, normalY_, normalZ_;
  mutable std::vector<ResampleNeighbour> points_;
  mutable std::vector<std::uint8_t> isSeen_;
  // The near ones.
  std::vector<float> nearX_, nearY_, nearZ_;  // normals
  std::vector<double> squared_, gap_;         // gap_: squared distance in the same sheet, or infinity
  std::vector<std::uint32_t> sectors_;
};

}  // namespace palpate
