// One tick of sculpting in double precision on the CPU, with every brush, at the cost of the points that it touches.
#pragma once

#include "engine/core/point_lock.hpp"
#include "engine/edit/placed_brush.hpp"
#include "engine/edit/resampling.hpp"
#include "engine/edit/sculpted_points.hpp"
#include "engine/spatial/cell_groups.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

struct SculptOptions {
  double radius = 0;  ///< support radius, model units
  IndexFollow index = IndexFollow::incremental;
  unsigned threads = 0;  ///< 0: one per core
  /// Measures the spacings of all points as loaded. Brushes require spacings: without this those of setSpacings().
  bool measures = true;
};

/// How much one edit does: a whole edit, or only as much as fits into a tick at 1 kHz on two cores.
enum class EditSize { whole, tick };

/// The points and their index. The result of a tick depends neither on the number of threads nor on the order of the
/// points in the index.
class CpuSculpture {
 public:
  /// Copies the data it needs from `cloud`, which must have normals; builds the index, and measures spacings if wanted.
  CpuSculpture(const PointCloud& cloud, const HashGrid& grid, const SculptOptions& options);

  const SculptedPoints& points() const { return points_; }
  const SortedGrid& grid() const { return grid_; }
  std::size_t threads() const { return grid_.threads(); }
  /// Time of the first build of the index, us.
  double buildTime_us() const { return buildTime_us_; }
  /// Number of index builds after the first: for changes of a large share of the points.
  std::uint64_t rebuilds() const { return grid_.builds() - 1; }
  /// Threads that the last edit engaged: from its beginning on, and for the points that were unsettled. They follow
  /// from the amount of work alone.
  struct Engaged {
    std::size_t atFirst = 1, unsettled = 1;
  };
  const Engaged& engaged() const { return engaged_; }
  /// Number of edits and sets whose changes the index followed without a build.
  std::uint64_t followed() const { return followed_; }

  /// One tick: applies the brush, if it acts; then the unsettled points get the normals of their surroundings, look
  /// ahead, and are resampled if the brush resamples: if they are more than `size` allows, those that have moved
  /// furthest since they last were; the others follow in the next edits. A whole edit allows 1024 points or a sixteenth
  /// of all, whichever is more.
  void edit(const PlacedBrush& brush, EditSize size = EditSize::whole);
  /// The last edit's measure of the surface under its brush.
  const SurfaceMeasure& measure() const { return measure_; }
  /// Work of the last edit: as much for each of its points, and for each of their neighbours. One of kTickWork units
  /// takes less than half a millisecond on two cores.
  double work() const { return work_; }
  /// Points changed by the last edit, each once.
  std::span<const std::uint32_t> changed() const { return changed_; }
  /// False: an edit would change points even though no brush acts.
  bool settled() const { return settled_ && swallowed_.empty(); }
  /// More points are unsettled than the last edit processed.
  bool someWait() const { return someWait_ || !swallowed_.empty(); }
  /// The points that the last edit left waiting.
  const Backlog& backlog() const { return backlog_; }
  /// Sets the spacings of all points, model units: those that are 0 are measured.
  void setSpacings(std::vector<float> known);
  /// What a stroke keeps of a point that it has moved, from one edit to the next.
  struct Kept {
    SculptedPoints::Found found;
    float strain = 0, displacement = 0;
    bool unsettled = false, blocked = false;
  };
  Kept kept(std::uint32_t point) const;
  /// For the next edit, which continues the stroke.
  void keep(std::uint32_t point, const Kept& kept);
  /// Sets points exactly; afterwards all are settled.
  void set(std::span<const PointChange> changes);
  /// The same in a stroke: other points that are unsettled remain so.
  void receive(std::span<const PointChange> changes);
  /// As EditStream::lock(), while all points are settled.
  void lock(const PointLock& lock);
  /// As EditStream::replace(); afterwards all are settled.
  void replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without);

 private:
  // Work that fits into a tick, and points that it is enough for.
  static constexpr double kTickWork = 60'000;
  static constexpr std::size_t kFewestAtOnce = 32;
  static constexpr double kMaxWorkOfPoint = kTickWork / kFewestAtOnce;
  // With so many points in a bucket, or so much work for a point, a cloud is crowded: points coincide.
  static constexpr std::uint32_t kCrowd = 2048;

  double reachOf(std::uint32_t point) const;
  float firstStep() const { return shared::kFirstStep * static_cast<float>(options_.radius); }
  float mostReach() const;
  bool isAtRest(std::uint32_t point) const;
  bool isMoved(std::uint32_t point) const;
  void remove(std::uint32_t point);
  void followInIndex();
  void applyBrush(const PlacedBrush& brush);
  PlacedBrush::Found found(const PlacedBrush& brush, std::uint32_t point) const;
  PlacedBrush::Found found(const PlacedBrush& brush, std::uint32_t point, const Vec3& place) const;
  struct Slice;
  PlacedBrush::Point brushed(const PlacedBrush& brush, std::uint32_t point, const PlacedBrush::Found& as,
                             Slice& slice) const;
  void brush(const PlacedBrush& brush, std::size_t number, Slice& slice);
  void measure(const PlacedBrush& brush, Slice& slice) const;
  void brushEach(const PlacedBrush& brush, Slice& slice);
  void apply(const PlacedBrush& brush, std::uint32_t point, const PlacedBrush::Point& to, Slice& slice);
  std::size_t mostAtOnce(EditSize size) const;
  double mostWorkOf(std::uint32_t point) const;
  std::size_t affordable(std::span<const std::uint32_t> points, EditSize size) const;
  void findUnsettled(EditSize size);
  struct Part;
  struct Surroundings;
  void refit();
  void refit(Part& part);
  Vec3 onCarriedSide(const Vec3& fitted, std::uint32_t point, const Surroundings& around) const;
  void setNormals(Part& part);
  double roomOf(std::uint32_t point, const Surroundings& around, std::span<const std::uint32_t> near) const;
  PlacedBrush::Seen seenBy(const PlacedBrush& brush, std::uint32_t point) const;
  ResampleNeighbour seen(std::uint32_t number) const;
  double neighbourhoodOf(std::uint32_t point) const;
  double searchRadius(std::uint32_t point) const;
  double fitRadius(std::uint32_t point) const;
  ResampleRequest requestOf(std::uint32_t point, std::span<const std::uint32_t> near,
                            ResampleNeighbours& neighbours) const;
  bool isInNoWay(const PlacedBrush& brush, std::uint32_t point) const;
  bool isAnyInTheWay(const Surroundings& around) const;
  double closestOf(std::uint32_t point) const;
  bool requestsNothing(std::uint32_t point, const Surroundings& around, std::span<const std::uint32_t> closest) const;
  void request(const Part& part);
  void request(const Part& part, const CellGroups::Group& group, const Surroundings& around);
  void examine();
  void insertClaimed();
  void makeRoom();
  void tellOf(std::uint32_t point);
  void takeSwallowed();
  bool isLocked(std::uint32_t point) const {
    return point / 64 < locked_.size() && (locked_[point / 64] >> point % 64 & 1) != 0;
  }

  void hold(std::uint32_t point);            // locks a new point
  double lockOf(std::uint32_t point) const;  // weight of its lock, 0 to 1

  SculptOptions options_;
  SculptedPoints points_;
  SortedGrid grid_;
  InsertionClaims claims_;
  double buildTime_us_ = 0;
  double widestSpacing_ = 0;  // of all targets, model units
  std::uint64_t followed_ = 0;
  bool settled_ = true, carves_ = false, fills_ = true;
  bool resamples_ = false;  // points are inserted and merged in this edit
  bool crowded_ = false;    // thousands of points are in one cell
  bool someWait_ = false;   // more points are unsettled than an edit processes
  Backlog backlog_;
  double work_ = 0, refitWork_ = 0, workOfPoint_;  // of the last edit, of its normals, and their mean
  Engaged engaged_;
  std::optional<PlacedBrush> moves_, cuts_;  // the brush of this tick, if its points look ahead, or if it carves
  SurfaceMeasure measure_;
  std::vector<std::uint32_t> waiting_;  // numbers of all points that may be unsettled, each once
  // By point: displacement since it was last resampled, model units; and the same with the priority that it has gained.
  std::vector<float> displacements_, strains_;
  std::vector<std::uint32_t> strayed_;  // numbers of points that the index has still to follow
  // Working data of one tick.
  struct Request : ResampleRequest {
    Vec3 place{0};  // of the new point
    float reach = 0;
  };
  // Indices of points by member of a group.
  class MemberLists {
   public:
    void clear();
    void add(std::span<const std::uint32_t> indices);
    std::size_t size() const { return indices_.size(); }
    std::span<const std::uint32_t> operator[](std::size_t member) const {
      const std::uint32_t begin = member == 0 ? 0 : ends_[member - 1];
      return std::span(indices_).subspan(begin, ends_[member] - begin);
    }

   private:
    std::vector<std::uint32_t> indices_, ends_;
  };
  // The points around a group; how many are near each of its members, and which of these are the closest: closestOf().
  struct Surroundings {
    GatheredPoints points;
    std::vector<std::uint32_t> near;
    MemberLists closest;
  };
  // Consecutive unsettled points, for one thread: which of them are together changes no result.
  struct Part {
    std::size_t first = 0, count = 0;
    CellGroups groups;
    std::vector<Surroundings> surroundings;  // by group
    std::vector<std::uint32_t> changed;      // numbers of points whose normals have changed, to append to changed_
    double work = 0;
  };
  std::span<Part> shareUnsettled();
  std::vector<Part> parts_;
  // The points under the brush in a slice of its ball, for one thread.
  struct alignas(128) Slice {
    std::vector<SortedGrid::Placed> measured;
    SurfaceMeasure measure;
    // Numbers of points. `waiting`: those that were settled; `swallowed`, `changed`, `strayed`: to append to the lists
    // of all slices.
    std::vector<std::uint32_t> reached, changed, strayed, waiting, swallowed, blocked;
    std::uint32_t blockedMoves = 0;
    std::size_t smoothed = 0;  // neighbours visited
  };
  std::vector<Slice> slices_;
  std::vector<std::uint32_t> unsettled_, changed_;  // numbers of points
  std::vector<std::uint32_t> swallowed_;            // by the carving ball: removed with the next edit
  std::vector<Vec3> normals_;                       // new normals of the unsettled points
  std::vector<Request> requests_;                   // of the unsettled points
  std::vector<std::uint32_t> inserting_;            // indices of those that insert a point, by its number
  std::vector<std::uint8_t> isChanged_;             // by point: whether it is in changed_
  // Whether a point under the brush has no room to move: in this edit, or in an earlier one of the stroke, after which
  // it has not looked ahead.
  enum class Blocked : std::uint8_t { no, before, now };
  std::vector<Blocked> isBlocked_;      // by point
  std::vector<std::uint32_t> blocked_;  // all for which it is not `no`; each once
  std::uint32_t blockedBy_ = 0;         // the stroke
  std::vector<std::uint64_t> locked_;   // a bit for each point, up to the last one
  std::vector<std::uint8_t> lockWeights_;
};

}  // namespace palpate
