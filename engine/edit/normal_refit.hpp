// New normals of many points at once, the same bit by bit as NormalFit of their neighbours one by one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/spatial/gathered_points.hpp"

namespace palpate {

/// Fits the normals of points among gathered ones. A neighbour weighs less the more its normal differs
/// (shared::fitShare()). The new normal takes the side of most normals around it: at a fresh edge a normal may rotate
/// by a right angle in one tick, and its previous side is then meaningless. Used by one thread.
class NormalRefit {
 public:
  /// Collects the normals of gathered points; `normals` are of all points by number.
  void gather(const GatheredPoints& points, std::span<const Vec3> normals);
  /// The new normal, unit, of a point with this normal and these neighbours, itself included. `radius`: support radius,
  /// model units; neighbours that are further away do not count.
  Vec3 refitted(const NearPoints& near, const Vec3& old, double radius);

 private:
  void makeRoom(std::size_t points);

  std::vector<float> normalX_, normalY_, normalZ_;  // of the gathered points
  std::vector<float> nearX_, nearY_, nearZ_;        // normals of the near ones
  std::vector<double> terms_;                       // kTerms rows, one for each sum, of as many as room for points
};

}  // namespace palpate
