// A soft body at rest: cubic cells of a lattice with their fill shares, the nodes at their corners, and its surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A position of the body at rest, relative to its cell. It moves with the nodes by their shares (trilinear).
struct EmbeddedPlace {
  std::uint32_t cell = 0;
  Vec3 share{0};  ///< from the cell's low corner, in spacings; outside 0 to 1 only for positions outside all cells
};

/// A position of the surface at rest.
struct SurfacePlace {
  Vec3 rest{0};    ///< m
  Vec3 normal{0};  ///< outward, unit
};

/// A grid of cells, z slowest, with the fill of each.
struct LatticeBox {
  DVec3 corner{0};  ///< lowest corner, m
  double spacing_m = 0;
  IVec3 cells{0};
  std::vector<float> filled;  ///< filled share of each cell, 0 to 1

  /// Empty cells of that spacing that cover a box, whose low corner is a cell's corner. Throws Error if there are too
  /// many.
  static LatticeBox about(const DVec3& low_m, const DVec3& high_m, double spacing_m);
  std::size_t numberOf(const IVec3& cell) const {
    return static_cast<std::size_t>(cell.x) +
           static_cast<std::size_t>(cells.x) * (static_cast<std::size_t>(cell.y) +
                                                static_cast<std::size_t>(cells.y) * static_cast<std::size_t>(cell.z));
  }
  bool holds(const IVec3& cell) const {
    for (int k = 0; k < 3; ++k)
      if (cell[k] < 0 || cell[k] >= cells[k]) return false;
    return true;
  }
  IVec3 cellOf(std::size_t number) const;
  IVec3 cellAt(const DVec3& place_m) const;  ///< may be outside
};

/// The nodes and cells of a body, in the order of the lattice. Immutable.
class SoftLattice {
 public:
  using Corners = std::array<std::uint32_t, 8>;

  /// Takes all cells that are not empty, and those in `kept` (numbers), which contain positions to embed. The fill of a
  /// cell is at least kMinFilled, so that its nodes have mass.
  explicit SoftLattice(LatticeBox box, std::span<const std::size_t> kept = {});

  std::size_t nodes() const { return rest_.size(); }
  std::size_t cells() const { return corners_.size(); }
  double spacing_m() const { return box_.spacing_m; }
  std::span<const Vec3> rest() const { return rest_; }           ///< rest position of each node, m
  std::span<const Corners> corners() const { return corners_; }  ///< of each cell, numbered as in shaders/shared/soft.h
  std::span<const float> filled() const { return filled_; }      ///< fill of each cell, 1
  double volume_m3() const { return volume_m3_; }                ///< volume of the body
  /// For each node its eight cells: 8 times the cell plus the node's corner number in it, low sides first; 8 times
  /// cells() if there is no cell.
  std::vector<Corners> incident() const;
  /// Share of the body's volume represented by each node.
  std::vector<double> nodeShares() const;
  /// The cell that contains a rest position, or the nearest cell of the body; the position must be near it.
  EmbeddedPlace embed(const DVec3& place_m) const;

 private:
  LatticeBox box_;
  double volume_m3_ = 0;
  std::vector<Vec3> rest_;
  std::vector<Corners> corners_;
  std::vector<float> filled_;
  std::vector<std::uint32_t> cellAt_;  // for each cell of the box its number here, or kNone
};

/// A body at rest.
struct SoftSolid {
  SoftLattice lattice;
  std::vector<SurfacePlace> surface;  ///< evenly distributed, about half a spacing apart
};

/// Number of surface positions for contact along a cell spacing.
inline constexpr int kPlacesOfSpacing = 2;

/// A box, with sides of at least half a spacing, rounded to whole spacings. m.
SoftSolid boxSolid(const DVec3& low_m, const DVec3& size_m, double spacing_m);
/// A ball with a radius of at least one spacing. m.
SoftSolid ballSolid(const DVec3& middle_m, double radius_m, double spacing_m);
/// The surfaces of those, with `perSpacing` positions along a spacing.
std::vector<SurfacePlace> boxSurface(const DVec3& low_m, const DVec3& size_m, double spacing_m, int perSpacing);
std::vector<SurfacePlace> ballSurface(const DVec3& middle_m, double radius_m, double spacing_m, int perSpacing);

}  // namespace palpate
