#include "engine/contact/surface_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate {

namespace {

// In support radii.
constexpr double kArrived = 1e-6, kOnSurface = 1e-9, kShortestStep = 1.0 / 16, kLongestStep = 0.5;

double squaredDistanceTo(const Bounds& box, const DVec3& x) {
  const DVec3 beside = glm::max(glm::max(box.min - x, x - box.max), DVec3(0));
  return glm::dot(beside, beside);
}

IVec3 firstCell(const IVec3& cell) {
  constexpr int kMask = ~(OccupiedBlocks::kSide - 1);
  return {cell.x & kMask, cell.y & kMask, cell.z & kMask};
}

}  // namespace

std::size_t OccupiedBlocks::Hash::operator()(const IVec3& low) const {
  constexpr std::uint64_t kPrimes[]{73856093, 19349663, 83492791};  // Teschner et al. 2003
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) hash ^= static_cast<std::uint64_t>(low[k] / kSide) * kPrimes[k];
  return hash;
}

void OccupiedBlocks::add(const IVec3& cell) {
  const IVec3 low = firstCell(cell);
  const auto [found, isNew] = indices_.try_emplace(low, static_cast<std::uint32_t>(blocks_.size()));
  if (isNew) blocks_.push_back({low, 0, {}});
  Block& block = blocks_[found->second];
  ++block.points;
  const IVec3 inside = cell - low;
  block.cells[static_cast<std::size_t>(inside.z)] |= std::uint64_t{1} << (inside.y * kSide + inside.x);
}

void OccupiedBlocks::remove(const IVec3& cell) {
  const auto found = indices_.find(firstCell(cell));
  const std::uint32_t index = found->second;
  if (--blocks_[index].points > 0) return;
  indices_.erase(found);
  if (index + 1 < blocks_.size()) {
    blocks_[index] = blocks_.back();
    indices_[blocks_[index].low] = index;
  }
  blocks_.pop_back();
}

SurfaceIndex::SurfaceIndex(std::vector<Vec3> positions, std::vector<Vec3> normals, std::vector<std::uint8_t> there,
                           const SurfaceOptions& options, unsigned threads)
    : options_(options),
      positions_(std::move(positions)),
      normals_(std::move(normals)),
      there_(std::move(there)),
      grid_(makeHashGrid(Vec3(0), options.radius, positions_.size()), threads),
      cell_(1 / static_cast<double>(grid_.grid().inverseCell)) {
  grid_.build(positions_, there_);
  for (std::uint32_t i = 0; i < positions_.size(); ++i)
    if (there_[i]) count(i, true);
}

void SurfaceIndex::count(std::uint32_t number, bool enters) {
  const IVec3 cell = cellOf(grid_.grid(), positions_[number]);
  enters ? blocks_.add(cell) : blocks_.remove(cell);
}

void SurfaceIndex::follow(std::span<const PointState> states) {
  std::vector<std::uint32_t> changed;
  for (const PointState& state : states) {
    const auto number = static_cast<std::uint32_t>(state.number);
    if (number >= positions_.size()) {
      positions_.resize(number + 1, Vec3(0));
      normals_.resize(number + 1, Vec3(0));
      there_.resize(number + 1, 0);
    }
    if (there_[number]) count(number, false);
    positions_[number] = state.position;
    normals_[number] = state.normal;
    there_[number] = !state.gone;
    if (there_[number]) count(number, true);
    changed.push_back(number);
  }
  // Several edits may have changed the same point.
  std::ranges::sort(changed);
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  if (!changed.empty()) grid_.update(positions_, there_, changed);
}

SurfaceSample SurfaceIndex::surface(const DVec3& x, const DVec3& facing) const {
  return surfaceOf(options_, facing, [&](double radius, auto&& visit) {
    grid_.forEachNear(
        x, radius, [&](const SortedGrid::Placed& point) { visit(DVec3(point.position) - x, normals_[point.number]); });
  });
}

Bounds SurfaceIndex::boxOf(const IVec3& low, int side) const {
  const DVec3 room(1e-3 * cell_);
  return {.min = cell_ * DVec3(low) - room, .max = cell_ * (DVec3(low) + static_cast<double>(side)) + room};
}

// The next one `after` a point, by distance and then by number.
std::optional<SurfaceIndex::Near> SurfaceIndex::nearestPoint(const DVec3& x, double within,
                                                             const std::optional<Near>& after) const {
  Near best{.squared = within * within, .number = std::numeric_limits<std::uint32_t>::max()};
  const Near none = best;
  for (const double share : {0.5, 1.0}) {  // half a radius meets a third of the cells, and is mostly enough
    const double radius = std::min(within, share * options_.radius);
    grid_.forEachNear(x, radius, [&](const SortedGrid::Placed& point) {
      const DVec3 d = DVec3(point.position) - x;
      const Near near{glm::dot(d, d), point.number};
      if (near < best && (!after || *after < near)) best = near;
    });
    if (best != none || radius == within) break;
  }
  if (best == none && within > options_.radius) searchBlocks(x, best, after);
  return best == none ? std::nullopt : std::optional(best);
}

std::optional<SurfaceHit> SurfaceIndex::nearestPoint(const DVec3& x, double within) const {
  const std::optional<Near> near = nearestPoint(x, within, std::nullopt);
  if (!near) return std::nullopt;
  return SurfaceHit{.position = DVec3(positions_[near->number]),
                    .normal = DVec3(normals_[near->number]),
                    .distance = std::sqrt(near->squared),
                    .point = near->number};
}

// The nearest block first: what it contains leaves few of the others.
void SurfaceIndex::searchBlocks(const DVec3& x, Near& best, const std::optional<Near>& after) const {
  struct Distant {
    double squared;
    const OccupiedBlocks::Block* block;
  };
  std::vector<Distant> blocks;
  for (const OccupiedBlocks::Block& block : blocks_.all()) {
    const double squared = squaredDistanceTo(boxOf(block.low, OccupiedBlocks::kSide), x);
    if (squared <= best.squared) blocks.push_back({squared, &block});
  }
  if (blocks.empty()) return;
  std::iter_swap(blocks.begin(), std::ranges::min_element(blocks, {}, &Distant::squared));
  searchBlock(*blocks.front().block, x, best, after);
  blocks.erase(blocks.begin());
  std::erase_if(blocks, [&](const Distant& each) { return each.squared > best.squared; });
  std::ranges::sort(blocks, {}, &Distant::squared);
  for (const Distant& each : blocks)
    if (each.squared <= best.squared) searchBlock(*each.block, x, best, after);
}

// The nearest cell first. In passes, whose memory accesses overlap: each bucket is a cache miss. Buckets may contain
// points of other cells, which count as well.
void SurfaceIndex::searchBlock(const OccupiedBlocks::Block& block, const DVec3& x, Near& best,
                               const std::optional<Near>& after) const {
  struct Distant {
    double squared;
    std::uint32_t bucket;
  };
  std::array<Distant, OccupiedBlocks::kCells> cells;
  std::size_t count = 0, nearest = 0;
  block.forEachCell([&](const IVec3& cell) {
    const double squared = squaredDistanceTo(boxOf(cell, 1), x);
    if (squared > best.squared) return;
    cells[count] = {squared, bucketOf(grid_.grid(), cell)};
    if (cells[count].squared < cells[nearest].squared) nearest = count;
    ++count;
  });
  const auto visit = [&](std::uint32_t bucket) {
    for (const SortedGrid::Placed& point : grid_.bucket(bucket)) {
      const DVec3 d = DVec3(point.position) - x;
      const Near near{glm::dot(d, d), point.number};
      if (near < best && (!after || *after < near)) best = near;
    }
  };
  if (count == 0) return;
  visit(cells[nearest].bucket);
  constexpr std::size_t kPerCacheLine = 64 / sizeof(SortedGrid::Placed);
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i == nearest || cells[i].squared > best.squared) continue;
    const std::span<const SortedGrid::Placed> points = grid_.bucket(cells[i].bucket);
    for (std::size_t k = 0; k < points.size(); k += kPerCacheLine) __builtin_prefetch(&points[k]);
    cells[left++] = cells[i];
  }
  for (std::size_t i = 0; i < left; ++i)
    if (cells[i].squared <= best.squared) visit(cells[i].bucket);
}

SurfaceSample SurfaceIndex::surface(const DVec3& x, const DVec3& facing, Surroundings& around) const {
  constexpr double kReach = 1.25;  // in support radii
  if (around.reach == 0 || glm::distance(x, around.centre) + options_.radius > around.reach) {
    around.centre = x;
    around.reach = kReach * options_.radius;
    around.points.clear();
    grid_.forEachNear(x, around.reach, [&](const SortedGrid::Placed& point) {
      around.points.push_back({DVec3(point.position), normals_[point.number], point.number});
    });
  }
  return surfaceOf(options_, facing, [&](double radius, auto&& visit) {
    for (const Surroundings::Point& point : around.points) {
      const DVec3 offset = point.position - x;
      if (glm::dot(offset, offset) < radius * radius) visit(offset, point.normal);
    }
  });
}

// Steps onto the surface whose face is `facing`; from the second step on by the slope that the last one has shown.
std::optional<SurfaceIndex::Foot> SurfaceIndex::land(DVec3 x, DVec3 facing, double precision,
                                                     Surroundings& around) const {
  constexpr int kMaxSteps = 24;
  constexpr double kFlattest = 0.5, kSteepest = 2;
  SurfaceSample there{};
  double before = 0, step = 0;
  for (int i = 0; i < kMaxSteps; ++i) {
    there = surface(x, facing, around);
    if (!there.defined) return std::nullopt;
    facing = there.normal;
    if (std::abs(there.distance) <= precision) break;
    const double slope = step == 0 ? 1 : std::clamp((before - there.distance) / step, kFlattest, kSteepest);
    before = there.distance;
    step = there.distance / slope;
    x -= step * there.normal;
  }
  return Foot{x, there};
}

// Slides over the surface to where its normal points at `x`; a slide is taken only if it comes nearer, so that it
// converges however far `x` is behind the centre of curvature. The farther `x` is, the more a slide overshoots: the
// secant through its two ends then corrects the next ones. A slide lands as exactly as its length requires.
std::optional<SurfaceIndex::Foot> SurfaceIndex::footOf(const DVec3& x, std::uint32_t point,
                                                       Surroundings& around) const {
  constexpr int kMaxSlides = 100;
  constexpr double kSmallestShare = 1e-6, kRough = 1e-3;
  const double radius = options_.radius, exact = kOnSurface * radius;
  const auto tangential = [&](const Foot& foot) {
    const DVec3 towards = x - foot.position, normal = foot.surface.normal;
    return towards - glm::dot(towards, normal) * normal;
  };
  std::optional<Foot> foot = land(DVec3(positions_[point]), DVec3(normals_[point]), kRough * kRough * radius, around);
  double share = 1;
  for (int i = 0; foot && i < kMaxSlides && share > kSmallestShare; ++i) {
    const DVec3 direction = tangential(*foot), slide = share * direction;
    const double length = glm::length(slide);
    if (length <= kArrived * radius) break;
    const double longest = kLongestStep * radius, taken = std::min(length, longest);
    const std::optional<Foot> next = land(foot->position + slide * (taken / length), foot->surface.normal,
                                          std::max(exact, kRough * taken * taken / radius), around);
    if (!next || glm::distance(x, next->position) >= glm::distance(x, foot->position)) {
      share *= 0.5;
      continue;
    }
    const double left = glm::dot(tangential(*next), direction) / glm::dot(direction, direction);
    if (left < 0 && length <= longest) share /= 1 - left;
    foot = next;
  }
  if (!foot || std::abs(foot->surface.distance) <= exact) return foot;
  return land(foot->position, foot->surface.normal, exact, around);
}

std::uint32_t SurfaceIndex::nextTo(const DVec3& x, const Surroundings& around) {
  Near best{.squared = std::numeric_limits<double>::infinity(), .number = 0};
  for (const Surroundings::Point& point : around.points) {
    const DVec3 d = point.position - x;
    best = std::min(best, Near{glm::dot(d, d), point.number});
  }
  return best.number;
}

std::optional<SurfaceHit> SurfaceIndex::nearest(const DVec3& x, double within) const {
  std::optional<Near> near;
  Surroundings around;
  for (int i = 0; i < kLongestSearch; ++i) {
    near = nearestPoint(x, within + options_.radius, near);
    if (!near) return std::nullopt;
    const std::optional<Foot> foot = footOf(x, near->number, around);
    if (!foot) continue;
    const DVec3 way = x - foot->position;
    const double distance = glm::length(way);
    if (!(distance <= within)) return std::nullopt;
    return SurfaceHit{.position = foot->position,
                      .normal = foot->surface.normal,
                      .distance = distance,
                      .behind = glm::dot(way, foot->surface.normal) < 0,
                      .point = nextTo(foot->position, around)};
  }
  return std::nullopt;
}

// The parts of a ray within a support radius of an occupied block, in order and disjoint.
std::vector<SurfaceIndex::Stretch> SurfaceIndex::stretches(const Ray& ray, double longest) const {
  std::vector<Stretch> found;
  for (const OccupiedBlocks::Block& block : blocks_.all()) {
    const Bounds box = boxOf(block.low, OccupiedBlocks::kSide);
    Stretch in{0, longest};
    for (int k = 0; k < 3 && in.begin <= in.end; ++k) {
      const double low = box.min[k] - options_.radius - ray.from[k], high = box.max[k] + options_.radius - ray.from[k];
      if (ray.along[k] == 0) {
        if (low > 0 || high < 0) in.end = -1;
        continue;
      }
      const double one = low / ray.along[k], other = high / ray.along[k];
      in = {std::max(in.begin, std::min(one, other)), std::min(in.end, std::max(one, other))};
    }
    if (in.begin <= in.end) found.push_back(in);
  }
  std::ranges::sort(found, {}, &Stretch::begin);
  std::vector<Stretch> merged;
  for (const Stretch& each : found) {
    if (merged.empty() || each.begin > merged.back().end)
      merged.push_back(each);
    else
      merged.back().end = std::max(merged.back().end, each.end);
  }
  return merged;
}

// Samples the face to which the nearest point belongs, so that both faces of a thin plate are found.
std::optional<SurfaceIndex::Sample> SurfaceIndex::sampleAt(const Ray& ray, double distance) const {
  const DVec3 x = ray.at(distance);
  const std::optional<Near> near = nearestPoint(x, options_.radius, {});
  if (!near) return std::nullopt;
  Sample sample{.distance = distance, .surface = {}, .facing = DVec3(normals_[near->number])};
  sample.surface = surface(x, sample.facing);
  return sample.surface.defined ? std::optional(sample) : std::nullopt;
}

std::optional<SurfaceHit> SurfaceIndex::castRay(const DVec3& from, const DVec3& along, double longest) const {
  const Ray ray{from, along};
  for (const Stretch& stretch : stretches(ray, longest))
    if (const auto hit = march(ray, stretch)) return hit;
  return std::nullopt;
}

std::optional<SurfaceHit> SurfaceIndex::march(const Ray& ray, const Stretch& stretch) const {
  constexpr double kTrusted = 0.8;  // share of a signed distance that is stepped over
  std::optional<Sample> before;
  for (double distance = stretch.begin;;) {
    const std::optional<Sample> now = sampleAt(ray, distance);
    if (before)
      if (const auto hit = crossing(ray, *before, now, distance)) return hit;
    if (distance >= stretch.end) return std::nullopt;
    const double free = now ? kTrusted * std::abs(now->surface.distance) : kLongestStep * options_.radius;
    distance = std::min(stretch.end,
                        distance + std::clamp(free, kShortestStep * options_.radius, kLongestStep * options_.radius));
    before = now;
  }
}

// Where the sign changes between two samples, both seen as the same face.
std::optional<SurfaceHit> SurfaceIndex::crossing(const Ray& ray, const Sample& before, const std::optional<Sample>& now,
                                                 double distance) const {
  const auto isInFront = [](const SurfaceSample& sample) { return sample.distance > 0; };
  const Stretch between{before.distance, distance};
  const SurfaceSample later = surface(ray.at(distance), before.facing);
  if (later.defined && isInFront(later) != isInFront(before.surface)) return refined(ray, between, before.facing);
  if (!now) return std::nullopt;
  const SurfaceSample earlier = surface(ray.at(before.distance), now->facing);
  if (earlier.defined && isInFront(earlier) != isInFront(now->surface)) return refined(ray, between, now->facing);
  return std::nullopt;
}

std::optional<SurfaceHit> SurfaceIndex::refined(const Ray& ray, Stretch between, const DVec3& facing) const {
  constexpr int kMaxHalvings = 40, kMaxSteps = 8;
  constexpr double kFlattest = 0.02;  // a ray at less than about a degree keeps what the halving gives
  SurfaceSample sample = surface(ray.at(between.begin), facing);
  const bool behind = !(sample.distance > 0);
  for (int i = 0; i < kMaxHalvings && between.end - between.begin > kArrived * options_.radius; ++i) {
    const double middle = 0.5 * (between.begin + between.end);
    sample = surface(ray.at(middle), facing);
    if (!sample.defined) return std::nullopt;
    ((sample.distance > 0) == behind ? between.end : between.begin) = middle;
  }
  double distance = between.end;
  sample = surface(ray.at(distance), facing);
  for (int i = 0; i < kMaxSteps && sample.defined; ++i) {
    const SurfaceSample felt = surface(ray.at(distance), sample.normal);  // as a hand feels it
    const double slope = glm::dot(felt.normal, ray.along);
    if (!felt.defined || std::abs(slope) < kFlattest) break;
    const double step = -felt.distance / slope;
    if (std::abs(step) > kShortestStep * options_.radius) break;
    sample = felt;
    distance = std::max(0.0, distance + step);
    if (std::abs(step) <= kOnSurface * options_.radius) break;
  }
  if (!sample.defined) return std::nullopt;
  const std::optional<Near> near = nearestPoint(ray.at(distance), options_.radius, {});
  if (!near) return std::nullopt;
  return SurfaceHit{.position = ray.at(distance),
                    .normal = sample.normal,
                    .distance = distance,
                    .behind = behind,
                    .point = near->number};
}

}  // namespace palpate
