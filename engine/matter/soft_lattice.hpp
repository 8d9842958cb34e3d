// What a soft body is made of at rest: cubic cells of a lattice, as full as the body fills them, the nodes at their
// corners, and its surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A place of the body at rest, as its cell has it. Where a node goes, the place goes by its share of it (trilinear).
struct EmbeddedPlace {
  std::uint32_t cell = 0;
  Vec3 share{0};  ///< from the cell's low corner, in spacings; beyond 0 to 1 only for places that no cell holds
};

/// A place of the surface at rest.
struct SurfacePlace {
  Vec3 rest{0};    ///< m
  Vec3 normal{0};  ///< outward, unit
};

/// Cells side by side, z slowest, with what each holds.
struct LatticeBox {
  DVec3 corner{0};  ///< the lowest, m
  double spacing_m = 0;
  IVec3 cells{0};
  std::vector<float> filled;  ///< of each cell: the share that is full, 0 to 1

  /// Cells of that spacing about a box, which begins at the corner of a cell and ends within one; all empty. Throws
  /// Error where there are too many to count.
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

/// The nodes and cells of a body, in the order of the lattice. Never changes.
class SoftLattice {
 public:
  using Corners = std::array<std::uint32_t, 8>;

  /// Of all cells that are not empty, and of those in `kept`, by their numbers: places to embed lie there. A cell that
  /// is nearly empty is taken to be as full as kMinFilled says, so that its nodes weigh something.
  explicit SoftLattice(LatticeBox box, std::span<const std::size_t> kept = {});

  std::size_t nodes() const { return rest_.size(); }
  std::size_t cells() const { return corners_.size(); }
  double spacing_m() const { return box_.spacing_m; }
  std::span<const Vec3> rest() const { return rest_; }  ///< of each node, m
  std::span<const Corners> corners() const {
    return corners_;
  }                                                          ///< of each cell, numbered as shaders/shared/soft.h does
  std::span<const float> filled() const { return filled_; }  ///< of each cell, 1
  double volume_m3() const { return volume_m3_; }            ///< of the body
  /// Of each node the eight cells about it: 8 times the cell, and which corner of it the node is, those on the low
  /// sides first; 8 times cells() where there is none.
  std::vector<Corners> incident() const;
  /// Share of the body's volume that each node stands for.
  std::vector<double> nodeShares() const;
  /// The cell that holds a place at rest, or the nearest of the body; the place must be near it.
  EmbeddedPlace embed(const DVec3& place_m) const;

 private:
  LatticeBox box_;
  double volume_m3_ = 0;
  std::vector<Vec3> rest_;
  std::vector<Corners> corners_;
  std::vector<float> filled_;
  std::vector<std::uint32_t> cellAt_;  // of each cell of the box: its number here, or kNone
};

/// A body at rest.
struct SoftSolid {
  SoftLattice lattice;
  std::vector<SurfacePlace> surface;  ///< evenly spread, about half a spacing apart
};

/// Places of a soft body's surface for its contact, along a spacing of its cells.
inline constexpr int kPlacesOfSpacing = 2;

/// A box, with sides of at least half a spacing, which are rounded to whole spacings. m.
SoftSolid boxSolid(const DVec3& low_m, const DVec3& size_m, double spacing_m);
/// A ball of at least one spacing's radius. m.
SoftSolid ballSolid(const DVec3& middle_m, double radius_m, double spacing_m);
/// The surfaces of those, as many places along a spacing as `perSpacing` says.
std::vector<SurfacePlace> boxSurface(const DVec3& low_m, const DVec3& size_m, double spacing_m, int perSpacing);
std::vector<SurfacePlace> ballSurface(const DVec3& middle_m, double radius_m, double spacing_m, int perSpacing);

}  // namespace palpate
