// The faces between the points of a surface, of which the large ones are holes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/point_tree.hpp"

namespace palpate {

/// A graph of the neighbours on a surface that hardly cross, and the order of each point's neighbours around its
/// normal. Two points are neighbours if no third one of their sheet is in the ball of which they are a diameter
/// (Gabriel and Sokal 1969, "A new statistical approach to geographic variation analysis"), so that faces are mostly
/// triangles where points are even. Points whose normals are more than 107 degrees apart are on two sheets.
class SurfaceFaces {
 public:
  /// `positions`, distinct, with their tree and one unit normal for each; all must outlive it. O(N log N). The result
  /// does not depend on `threads`. Throws Stopped.
  SurfaceFaces(std::span<const Vec3> positions, std::span<const Vec3> normals, const PointTree& tree, unsigned threads);

  /// Counter-clockwise, seen against the normal. They may be of the other sheet of a tangle; empty for a lone point.
  std::span<const std::uint32_t> neighboursOf(std::uint32_t point) const {
    return std::span(neighbours_).subspan(begins_[point], begins_[point + 1] - begins_[point]);
  }
  /// Local spacing: the root of the area for each point.
  double spacingOf(std::uint32_t point) const { return static_cast<double>(spacings_[point]); }

  struct Face {
    std::vector<std::uint32_t> rim;  ///< counter-clockwise around the empty part
    DVec3 area{0};                   ///< vector of its area, along the normals
  };
  struct Holes {
    std::vector<Face> fitting;  ///< no wider than a limit
    std::size_t wider = 0;      ///< number of the others
    double narrowest = 0;       ///< width of the narrowest of these, model units
  };
  /// The faces around empty parts that are much larger than the others, by area for each point. The outer border of an
  /// open surface is none: it goes round the other way.
  ///
  /// The width of a hole is that of what is missing, and not of the rim, which is wider by one to three spacings: the
  /// long axis of the ellipse with the second moments of the face, reduced to the area of the points that are missing
  /// in it by Pick's theorem (1899, "Geometrisches zur Zahlenlehre"). A round hole is as wide as its diameter.
  Holes holes(double widest) const;

 private:
  double widthOf(const Face& face) const;
  double spacingAround(std::span<const std::uint32_t> rim) const;
  std::size_t halfEdge(std::uint32_t from, std::uint32_t to) const;
  std::size_t after(std::uint32_t from, std::uint32_t to) const;

  std::span<const Vec3> positions_, normals_;
  std::vector<float> spacings_;
  std::vector<std::size_t> begins_;        // of each point's neighbours, and the end
  std::vector<std::uint32_t> neighbours_;  // each is a half-edge
};

}  // namespace palpate
