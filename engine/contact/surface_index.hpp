#pragma once

#include <array>
#include <bit>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/contact/surface.hpp"
#include "engine/core/point_state.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

/// A position on the surface, relative to the cloud's origin, model units.
struct SurfaceHit {
  DVec3 position{0};
  DVec3 normal{0};          ///< unit, outward
  double distance = 0;      ///< from the position that was asked for, or along the ray
  bool behind = false;      ///< asked for from behind the surface
  std::uint32_t point = 0;  ///< number of the point nearest to it
};

/// The blocks of cells that contain points: the coarse level of a search over empty space.
class OccupiedBlocks {
 public:
  static constexpr int kSide = 8;  ///< cells
  static constexpr std::size_t kCells = std::size_t{kSide} * kSide * kSide;
  /// A bit stays set after the last point has left its cell, until the block is empty.
  struct Block {
    IVec3 low;  ///< its first cell
    std::uint32_t points;
    std::array<std::uint64_t, kSide> cells;  ///< by z, a bit for each cell that contains points
    /// Calls visit(cell) for every cell that may contain points.
    template <class Visit>
    void forEachCell(Visit&& visit) const {
      for (int z = 0; z < kSide; ++z)
        for (std::uint64_t left = cells[static_cast<std::size_t>(z)]; left != 0; left &= left - 1) {
          const int bit = std::countr_zero(left);
          visit(low + IVec3(bit % kSide, bit / kSide, z));
        }
    }
  };

  void add(const IVec3& cell);
  void remove(const IVec3& cell);
  std::span<const Block> all() const { return blocks_; }

 private:
  struct Hash {
    std::size_t operator()(const IVec3& low) const;
  };
  std::vector<Block> blocks_;  // in any order
  std::unordered_map<IVec3, std::uint32_t, Hash> indices_;
};

/// Nearest positions and ray casts on the surface that hands feel (surfaceOf()), in double precision on the CPU.
/// Follows edits. Queries may run on any number of threads at once, but not while points change.
class SurfaceIndex {
 public:
  /// `there`: zero for each point to leave out. All arrays have one entry per point. `threads`: that build; 0: one per
  /// core.
  SurfaceIndex(std::vector<Vec3> positions, std::vector<Vec3> normals, std::vector<std::uint8_t> there,
               const SurfaceOptions& options, unsigned threads);

  /// Takes in new states of points, in order.
  void follow(std::span<const PointState> states);
  void setKind(SurfaceKind kind) { options_.kind = kind; }

  /// The position of the surface nearest to `x`, at most `within` away: the foot of the perpendicular, found from the
  /// nearest point whose neighbours define a surface. Beyond the rim of an open sheet it lies on the sheet's border.
  /// Empty if there is none, or if the kLongestSearch nearest points define no surface.
  std::optional<SurfaceHit> nearest(const DVec3& x, double within) const;
  /// The nearest point, at most `within` away; empty if there is none.
  std::optional<SurfaceHit> nearestPoint(const DVec3& x, double within) const;
  /// The first position of the surface on the ray, from either side. `along` is a unit vector. A ray that is less than
  /// a sixteenth of the support radius deep in the surface may pass it.
  std::optional<SurfaceHit> castRay(const DVec3& from, const DVec3& along, double longest) const;

  static constexpr int kLongestSearch = 64;

 private:
  struct Near {
    double squared;
    std::uint32_t number;
    auto operator<=>(const Near&) const = default;
  };
  struct Foot {
    DVec3 position;
    SurfaceSample surface;
  };
  // The points around a position, for the surfaces of a search.
  struct Surroundings {
    struct Point {
      DVec3 position;
      Vec3 normal;
      std::uint32_t number;
    };
    DVec3 centre{0};
    double reach = 0;
    std::vector<Point> points;
  };
  struct Ray {
    DVec3 from, along;
    DVec3 at(double distance) const { return from + distance * along; }
  };
  struct Sample {
    double distance;  // along the ray
    SurfaceSample surface;
    DVec3 facing;
  };
  struct Stretch {
    double begin, end;
  };

  void count(std::uint32_t number, bool enters);
  SurfaceSample surface(const DVec3& x, const DVec3& facing) const;
  std::optional<Near> nearestPoint(const DVec3& x, double within, const std::optional<Near>& after) const;
  void searchBlocks(const DVec3& x, Near& best, const std::optional<Near>& after) const;
  void searchBlock(const OccupiedBlocks::Block& block, const DVec3& x, Near& best,
                   const std::optional<Near>& after) const;
  SurfaceSample surface(const DVec3& x, const DVec3& facing, Surroundings& around) const;
  std::optional<Foot> land(DVec3 x, DVec3 facing, double precision, Surroundings& around) const;
  std::optional<Foot> footOf(const DVec3& x, std::uint32_t point, Surroundings& around) const;
  static std::uint32_t nextTo(const DVec3& x, const Surroundings& around);
  std::vector<Stretch> stretches(const Ray& ray, double longest) const;
  std::optional<Sample> sampleAt(const Ray& ray, double distance) const;
  std::optional<SurfaceHit> march(const Ray& ray, const Stretch& stretch) const;
  std::optional<SurfaceHit> crossing(const Ray& ray, const Sample& before, const std::optional<Sample>& now,
                                     double distance) const;
  std::optional<SurfaceHit> refined(const Ray& ray, Stretch between, const DVec3& facing) const;
  // The box of cells from `low` on, `side` cells a side, with some room for rounding.
  Bounds boxOf(const IVec3& low, int side) const;

  SurfaceOptions options_;
  std::vector<Vec3> positions_, normals_;
  std::vector<std::uint8_t> there_;
  SortedGrid grid_;
  double cell_;
  OccupiedBlocks blocks_;
};

}  // namespace palpate
