// How often a surface of oriented points winds about a place: 1 inside of a closed one, 0 outside, and in between where
// it has holes (Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast winding numbers for soups and clouds").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A point of a surface, which stands for an area with its outward normal.
struct OrientedArea {
  Vec3 place{0};
  Vec3 normal{0};  ///< unit
  float area = 0;
};

/// A tree of boxes, of which one that is far enough away counts as a single dipole. Queries are safe from any thread.
class WindingNumber {
 public:
  explicit WindingNumber(std::vector<OrientedArea> points);

  /// Within some hundredths, and less next to a point, about which an area is taken to be a disc.
  double at(const DVec3& place) const;

 private:
  // Nodes stand before what is in them; `behind` is the next one that is not.
  struct Node {
    DVec3 middle{0}, dipole{0};  // by area; the sum of areas times normals
    double radius = 0;           // of the points about the middle
    std::uint32_t first = 0, count = 0, behind = 0;
    bool isLeaf = false;
  };
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<OrientedArea> points_;  // in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace palpate
