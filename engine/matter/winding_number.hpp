// Winding number of a surface of oriented points around a position: 1 inside a closed surface, 0 outside, and in
// between if it has holes (Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast winding numbers for soups and
// clouds").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A point of a surface that represents an area with its outward normal.
struct OrientedArea {
  Vec3 place{0};
  Vec3 normal{0};  ///< unit
  float area = 0;
};

/// A tree of boxes; a box that is far enough away is approximated by a single dipole. Queries are safe from any thread.
class WindingNumber {
 public:
  explicit WindingNumber(std::vector<OrientedArea> points);

  /// Accurate to some hundredths, less so next to a point, around which its area is taken as a disc.
  double at(const DVec3& place) const;

 private:
  // Nodes precede their descendants; `behind` is the next node that is not a descendant.
  struct Node {
    DVec3 middle{0}, dipole{0};  // middle: centroid by area; dipole: sum of areas times normals
    double radius = 0;           // maximum distance of the points from the middle
    std::uint32_t first = 0, count = 0, behind = 0;
    bool isLeaf = false;
  };
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<OrientedArea> points_;  // in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace palpate
