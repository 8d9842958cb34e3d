// New normals of many points at once, the same bit by bit as NormalFit of their neighbours one by one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/eigen3_many.hpp"
#include "engine/core/vec.hpp"
#include "engine/edit/normal_fit.hpp"
#include "engine/spatial/gathered_points.hpp"

namespace palpate {

/// Fits the normals of points among gathered ones. A neighbour weighs less the more its normal differs
/// (shared::fitShare()). The new normal takes the side of most normals around it: at a fresh edge a normal may rotate
/// by a right angle in one tick, and its previous side is then meaningless. Used by one thread.
class NormalRefit {
 public:
  /// Collects the normals of gathered points; `normals` are of all points by number.
  void gather(const GatheredPoints& points, std::span<const Vec3> normals);
  /// Adds a point with this index, normal and neighbours, itself included. `radius`: support radius, model units;
  /// neighbours that are further away do not count.
  void add(std::uint32_t index, const NearPoints& near, const Vec3& old, double radius);
  /// Sets the new normals, unit, of all points added since the last call, also after other gathers, by index.
  void solve(std::span<Vec3> normals);

  /// One for each sum: weight, offsets, their six products, normals, and 1 for a neighbour with a share.
  static constexpr std::size_t kTerms = 14;

 private:
  void makeRoom(std::size_t points);

  struct Added {
    std::uint32_t index;
    DVec3 old, side;  // side: sum of the weighted normals around
  };
  std::vector<Added> added_;
  ManyEigen3 spreads_;                              // of these
  std::vector<float> normalX_, normalY_, normalZ_;  // of the gathered points
  std::vector<float> nearX_, nearY_, nearZ_;        // normals of the near ones
};

}  // namespace palpate
