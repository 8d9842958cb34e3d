// One tick of sculpting in double precision on the CPU, with every brush, over an index that is built anew each time.
#pragma once

#include "engine/edit/placed_brush.hpp"
#include "engine/edit/resampling.hpp"
#include "engine/edit/sculpted_points.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

struct SculptOptions {
  double radius = 0;  ///< support radius, model units
  /// A brush that keeps the density may: insert where the surface is stretched, merge where it is crowded.
  bool keepsDensity = true;
  unsigned threads = 0;  ///< 0: one per core
};

/// The points and their index. The result of a tick depends neither on the number of threads nor on the order of the
/// points in the index.
class CpuSculpture {
 public:
  /// Copies what it needs of `cloud`, which must have normals; builds the index and, to keep the density, measures it.
  CpuSculpture(const PointCloud& cloud, const HashGrid& grid, const SculptOptions& options);

  const SculptedPoints& points() const { return points_; }
  const SortedGrid& grid() const { return grid_; }
  std::size_t threads() const { return grid_.threads(); }
  /// Time of the first build of the index, us.
  double buildTime_us() const { return buildTime_us_; }
  /// Builds of the index after the first.
  std::uint64_t rebuilds() const { return builds_ - 1; }

  /// One tick: the brush, where it acts; then the points that are not settled get the normals of their surroundings,
  /// and come and go. Of more than 1024 and a sixteenth of all a part does so, and the others in the next ticks.
  void edit(const PlacedBrush& brush);
  /// How the last edit found the surface under its brush.
  const SurfaceMeasure& measure() const { return measure_; }
  /// What the last edit did something to, each point once.
  std::span<const std::uint32_t> changed() const { return changed_; }
  /// False: an edit would change something though no brush acts.
  bool settled() const { return settled_ && swallowed_.empty(); }
  /// More points are not settled than the last edit took.
  bool someWait() const { return someWait_ || !swallowed_.empty(); }
  /// How a stroke that goes on found a point.
  void setFound(std::uint32_t point, const SculptedPoints::Found& found) { points_.founds[point] = found; }
  /// Sets points exactly; after that all are settled.
  void set(std::span<const PointChange> changes);

 private:
  using Neighbours = std::vector<ResampleNeighbour>;
  void measureSpacings();
  double spacingAt(std::uint32_t point, std::span<const std::uint8_t> counts) const;
  double reachOf(std::uint32_t point) const;
  float mostReach() const;
  bool isAtRest(std::uint32_t point) const;
  bool isMoved(std::uint32_t point) const;
  void build() {
    grid_.build(points_.positions, points_.there);
    ++builds_;
  }
  bool resamples(const PlacedBrush& brush) const { return options_.keepsDensity && brush.keepsDensity(); }
  void applyBrush(const PlacedBrush& brush);
  PlacedBrush::Found found(const PlacedBrush& brush, std::uint32_t point) const;
  DVec3 smoothed(const PlacedBrush& brush, std::uint32_t point) const;
  void measure(const PlacedBrush& brush);
  void findUnsettled();
  void refit();
  Vec3 refitted(std::uint32_t point) const;
  std::optional<DVec3> pushedFrom(std::uint32_t point) const;
  ResampleRequest requestOf(std::uint32_t point, Neighbours& neighbours) const;
  void resample();
  void insertClaimed();
  void tellOf(std::uint32_t point);
  void takeSwallowed();

  SculptOptions options_;
  SculptedPoints points_;
  SortedGrid grid_;
  InsertionClaims claims_;
  double buildTime_us_ = 0;
  std::uint64_t builds_ = 0;
  bool settled_ = true, carves_ = false;
  bool someWait_ = false;              // more are unsettled than an edit takes
  std::uint32_t nextUnsettled_ = 0;    // the number from which the next edit takes them
  std::optional<PlacedBrush> pushes_;  // of this tick
  std::optional<PlacedBrush> cuts_;
  SurfaceMeasure measure_;
  // Of one tick.
  struct Request : ResampleRequest {
    Vec3 place{0};  // of the new point
    float reach = 0;
  };
  std::vector<std::uint32_t> reached_, unsettled_, changed_;  // numbers of points
  std::vector<std::uint32_t> swallowed_;                      // by the ball that carved: gone with the next edit
  std::vector<PlacedBrush::Point> places_;                    // of those reached
  std::vector<Vec3> normals_;                                 // new ones of those unsettled
  std::vector<Request> requests_;                             // of those unsettled
  std::vector<std::uint8_t> isChanged_;                       // by point: it stands in changed_
};

}  // namespace palpate
