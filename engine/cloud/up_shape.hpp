// Measures of a shape by which its up direction is found.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/cloud/up.hpp"
#include "engine/cloud/voxel_sample.hpp"

namespace palpate {

/// Share of the values cut off at each end of an axis.
inline constexpr double kUpTail = 0.005;
/// Mean of the normals towards the viewer, for a shape seen from one side only.
inline constexpr double kUpOneView = 0.55;

/// The axes of a height.
struct Sides {
  int axis;           // the axis of the height
  int across, along;  // the other axes
  double sign;
};
Sides sidesOf(UpAxis up);

/// The value below which a share of the values is.
double quantile(std::vector<double> values, double share);

/// Sorted heights of the positions in the cells of a plane.
using Columns = std::map<std::pair<int, int>, std::vector<double>>;
/// Number of layers in a mean column, separated by gaps of two column widths.
double layersOf(const Columns& columns, double width);

/// Stability of the shape in an orientation.
struct Stand {
  double score = 0;
  double base = 0;    // area of the base, relative to the outline
  double share = 0;   // share of the positions in the base
  double filled = 0;  // occupied area of the base, relative to the outline
};

/// What is seen of the shape from one side, by its normals.
struct SeenSide {
  double outside = 1;  // share of what is seen that faces the viewer: less where the shape is open
  double detail = 0;   // mean variation of the normals between adjacent columns
};

class UprightShape {
 public:
  explicit UprightShape(const VoxelSample& sample);

  DVec3 extent() const { return high_ - low_; }
  const DVec3& middle() const { return middle_; }
  double meanNormal(UpAxis up) const { return glm::dot(mean_, directionOf(up)); }

  Stand standing(UpAxis up) const;

  /// Whether the distribution of heights is the same upside down.
  bool isSymmetric(int axis) const;

  /// Number of layers along an axis that are separated by gaps.
  double layers(int axis) const { return layersOf(columns(axis), widthOfColumn(axis)); }

  /// Median over columns along an axis of the extent of their positions, relative to the whole height. 1 if no column
  /// has two positions.
  double reach(int axis) const;

  /// Median height of the positions, 0 at the lowest and 1 at the highest.
  double medianHeight(int axis) const;

  /// Share of all positions that face a direction.
  double facing(UpAxis up) const;

  /// Share of all positions at the low end of a direction that face along it, as the walls of a room do.
  double facingIn(UpAxis up) const;

  /// Share of all positions that face up between the floor and head height in a room: the furniture.
  double furniture(UpAxis up) const;

  /// Median height of the positions that face upwards, as in medianHeight(); 1 without any.
  double heightOfFacing(UpAxis up) const;

  /// If a plane across an axis cuts the shape, the share of positions in the rim of the cut: a rim surrounds the low
  /// end of a direction and faces sideways, where a base faces down. 0 without one.
  double cutBelow(UpAxis up) const;

  /// Without normals nothing is known: {1, 0}.
  SeenSide seenFrom(UpAxis side) const;

  /// Of the positions that do not face the thin side, whether most face along one of the other two axes: window reveals
  /// do, slopes of ground face anywhere.
  bool isFacade(int thin) const;

 private:
  static DVec2 flat(const DVec3& p, const Sides& sides) { return {p[sides.across], p[sides.along]}; }
  double lowEnd(const Sides& sides) const { return sides.sign > 0 ? low_[sides.axis] : -high_[sides.axis]; }

  /// The positions on which the shape would stand.
  std::vector<std::uint32_t> lowestPlaces(UpAxis up) const;

  /// Wide enough for some positions in each column.
  double widthOfColumn(int axis) const;

  Columns columns(int axis) const;

  const VoxelSample& sample_;
  std::array<std::vector<double>, 3> heights_;
  DVec3 low_{0}, high_{0}, middle_{0}, mean_{0};
};

}  // namespace palpate
