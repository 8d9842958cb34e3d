// What a CpuSculpture's unsettled points see ahead, their requests, and the points that these insert and remove.
#include <algorithm>
#include <utility>

#include "engine/core/widest_lanes.hpp"
#include "engine/edit/cpu_sculpture.hpp"

namespace palpate {

namespace {

// Offsets and normals of the closest neighbours of a point.
struct Closest {
  std::vector<double> x, y, z;
  std::vector<float> normalX, normalY, normalZ;
  std::size_t size = 0;

  void makeRoom(std::size_t count) {
    size = 0;
    if (x.size() >= count) return;
    for (std::vector<double>* each : {&x, &y, &z}) each->resize(2 * count);
    for (std::vector<float>* each : {&normalX, &normalY, &normalZ}) each->resize(2 * count);
  }
  void add(const DVec3& offset, const Vec3& normal) {
    x[size] = offset.x, y[size] = offset.y, z[size] = offset.z;
    normalX[size] = normal.x, normalY[size] = normal.y, normalZ[size] = normal.z;
    ++size;
  }
};

// A bit for each sector in which one of them is within `widestGap` and on the same sheet, and whether any is
// nearer than `mayCrowd`.
struct Surrounded {
  std::uint32_t sectors = 0, mayCrowd = 0;
};
PALPATE_WIDEST_LANES
Surrounded surroundedBy(const Closest& closest, const Frame3& frame, double widestGap, double mayCrowd) {
  const double *atX = closest.x.data(), *atY = closest.y.data(), *atZ = closest.z.data();
  const float *normalX = closest.normalX.data(), *normalY = closest.normalY.data(), *normalZ = closest.normalZ.data();
  const double ux = frame.u.x, uy = frame.u.y, uz = frame.u.z, vx = frame.v.x, vy = frame.v.y, vz = frame.v.z;
  const double nx = frame.n.x, ny = frame.n.y, nz = frame.n.z;
  std::uint32_t sectors = 0, crowds = 0;
  for (std::size_t k = 0; k < closest.size; ++k) {
    const double x = atX[k], y = atY[k], z = atZ[k];
    const double distance = std::sqrt(x * x + y * y + z * z);
    const double cosine = double{normalX[k]} * nx + double{normalY[k]} * ny + double{normalZ[k]} * nz;
    const bool fills = (distance <= widestGap) & (cosine > static_cast<double>(shared::kSameSheet));
    const std::uint32_t sector =
        shared::sectorOf(static_cast<float>(x * ux + y * uy + z * uz), static_cast<float>(x * vx + y * vy + z * vz));
    sectors |= std::uint32_t{fills} << sector;
    crowds |= std::uint32_t{distance < mayCrowd};
  }
  return {sectors, crowds};
}

// Number of neighbours that a point examines before it decides on insertion or removal. More are within its
// neighbourhood radius only where many points coincide: they are merged with the examined ones, and no new point is
// requested.
constexpr std::size_t kMaxNeighbours = 2048;

}  // namespace

PlacedBrush::Seen CpuSculpture::seenBy(const PlacedBrush& brush, std::uint32_t point) const {
  return {DVec3(points_.positions[point]), DVec3(points_.normals[point]), points_.strokes[point] == brush.stroke(),
          isLocked(point)};
}

ResampleNeighbour CpuSculpture::seen(std::uint32_t number) const {
  return {.normal = DVec3(points_.normals[number]),
          .rest = DVec3(points_.rests[number]),
          .stroke = points_.strokes[number],
          .found = DVec3(points_.founds[number].position),
          .foundNormal = DVec3(points_.founds[number].normal),
          .spacing = points_.spacing(number),
          .isNew = number >= points_.fromFile,
          .atRest = carves_ && isAtRest(number),
          .number = number,
          .unsettled = points_.unsettled[number] != 0};
}

double CpuSculpture::neighbourhoodOf(std::uint32_t point) const {
  return double{
      shared::neighbourhoodRadius(static_cast<float>(points_.spacing(point)), static_cast<float>(options_.radius))};
}

// Radius within which the neighbours of a point are searched, at least that of its neighbourhood, also after rounding.
double CpuSculpture::searchRadius(std::uint32_t point) const {
  const auto support = double{static_cast<float>(options_.radius)};
  const double own = neighbourhoodOf(point);
  return own < support ? own : std::max(options_.radius, support);
}

// Radius of the neighbours that determine a point's normal, and the surface to which it is smoothed.
double CpuSculpture::fitRadius(std::uint32_t point) const { return std::min(options_.radius, searchRadius(point)); }

ResampleRequest CpuSculpture::requestOf(std::uint32_t point, std::span<const std::uint32_t> near,
                                        ResampleNeighbours& neighbours) const {
  const DVec3 place(points_.positions[point]);
  const bool complete = neighbours.look({place, neighbourhoodOf(point), point}, near, kMaxNeighbours);
  const SculptedPoints::Found as = cuts_ ? points_.found(point, cuts_->stroke()) : SculptedPoints::Found{};
  return resampleRequest(seen(point), {.neighbours = neighbours,
                                       .reach = reachOf(point),
                                       .widest = widestSpacing_,
                                       .fills = fills_ && complete,
                                       .carves = carves_,
                                       .moved = isMoved(point),
                                       .found = DVec3(as.position) - place,
                                       .foundNormal = DVec3(as.normal),
                                       .room = cuts_ ? double{as.room} : std::numeric_limits<double>::infinity(),
                                       .claims = &claims_,
                                       .place = place});
}

void CpuSculpture::MemberLists::clear() {
  indices_.clear();
  ends_.clear();
}

void CpuSculpture::MemberLists::add(std::span<const std::uint32_t> indices) {
  indices_.insert(indices_.end(), indices.begin(), indices.end());
  ends_.push_back(static_cast<std::uint32_t>(indices_.size()));
}

// No neighbour that is further away matters to requestsNothing(): neither crowds it, nor does it fill a gap.
double CpuSculpture::closestOf(std::uint32_t point) const {
  if (!resamples_) return 0;
  constexpr double kMargin = 1e-9;  // for rounding
  const double spacing = points_.spacing(point);
  return (1 + kMargin) * std::max(static_cast<double>(shared::kWidestGap) * spacing,
                                  static_cast<double>(shared::kCrowded) * std::max(spacing, widestSpacing_));
}

// Whether any point around a group may be in the way of those that the brush moves, or hold them up.
bool CpuSculpture::isAnyInTheWay(const Surroundings& around) const {
  return moves_ && !std::ranges::all_of(around.points.numbers(), [&](std::uint32_t number) {
           return (blocked_.empty() || isBlocked_[number] == Blocked::no) && moves_->isInNoWay(seenBy(*moves_, number));
         });
}

// Whether nothing is in the way of a moved point, if that holds for all around.
bool CpuSculpture::isInNoWay(const PlacedBrush& brush, std::uint32_t point) const {
  const PlacedBrush::Found as = found(brush, point);
  return brush.isInNoWay({as.position, as.normal, true});
}

// How far a point may go on. `near`: indices of its neighbours; without any, nothing is in its way.
double CpuSculpture::roomOf(std::uint32_t point, const Surroundings& around,
                            std::span<const std::uint32_t> near) const {
  const DVec3 place(points_.positions[point]);
  const PlacedBrush::Found as = found(*moves_, point);
  const PlacedBrush::Path path = moves_->path(place, as, points_.spacing(point));
  double free = static_cast<double>(shared::kFreeAhead) * neighbourhoodOf(point);
  for (const std::uint32_t i : near)
    if (const std::uint32_t number = around.points.numbers()[i]; number != point) {
      const PlacedBrush::Seen seen = seenBy(*moves_, number);
      free = moves_->freeUntil(path, seen, free);
      if (isBlocked_[number] != Blocked::no)
        free = moves_->freeBeside(path, seen.position, found(*moves_, number), free);
    }
  return free;
}

// Whether the closest neighbours show that resampleRequest() of a point would have no effect, where no ball carves:
// true for most points.
bool CpuSculpture::requestsNothing(std::uint32_t point, const Surroundings& around,
                                   std::span<const std::uint32_t> closest) const {
  constexpr std::uint32_t kAllSectors = (1u << shared::kGapSectors) - 1;
  const DVec3 place(points_.positions[point]);
  const Frame3 frame = frameAround(DVec3(points_.normals[point]));
  const double spacing = points_.spacing(point);
  const double widestGap = static_cast<double>(shared::kWidestGap) * spacing;
  const double mayCrowd = static_cast<double>(shared::kCrowded) * std::max(spacing, widestSpacing_);
  thread_local Closest others;
  others.makeRoom(closest.size());
  for (const std::uint32_t i : closest)
    if (const std::uint32_t number = around.points.numbers()[i]; number != point)
      others.add(around.points.position(i) - place, points_.normals[number]);
  const Surrounded by = surroundedBy(others, frame, widestGap, mayCrowd);
  if (fills_ && by.sectors != kAllSectors) return false;
  return by.mayCrowd == 0 || std::ranges::none_of(closest, [&](std::uint32_t i) {
           const std::uint32_t number = around.points.numbers()[i];
           return number != point &&
                  glm::length(around.points.position(i) - place) <
                      static_cast<double>(shared::kCrowded) * std::max(spacing, points_.spacing(number));
         });
}

void CpuSculpture::request(const Part& part) {
  auto around = part.surroundings.begin();
  for (const CellGroups::Group& group : part.groups.groups()) request(part, group, *around++);
}

// Of the members of a group.
void CpuSculpture::request(const Part& part, const CellGroups::Group& group, const Surroundings& around) {
  thread_local ResampleNeighbours neighbours;
  thread_local NearPoints near;
  const bool noneInTheWay = !isAnyInTheWay(around);
  bool gathered = false;
  for (std::size_t member = 0; member < group.count; ++member) {
    const std::size_t i = part.first + part.groups.members(group)[member];
    const std::uint32_t point = unsettled_[i];
    Request& request = requests_[i];
    const bool looks = moves_ && points_.strokes[point] == moves_->stroke();
    const bool isFree = noneInTheWay && (!looks || isInNoWay(*moves_, point));
    const bool isClear = !carves_ && around.near[member] <= kMaxNeighbours;
    const bool asksNothing = !resamples_ || (isClear && requestsNothing(point, around, around.closest[member]));
    near.truncate(0);
    if (!asksNothing || !isFree) around.points.near(DVec3(points_.positions[point]), searchRadius(point), near);
    request = {};
    if (!asksNothing) {
      if (!std::exchange(gathered, true))
        neighbours.gather(around.points, points_.normals, [this](std::uint32_t each) { return seen(each); });
      static_cast<ResampleRequest&>(request) = requestOf(point, near.indices(), neighbours);
    }
    // One that is held stays, and its normal follows the points that move away from it.
    request.unsettled = request.unsettled || (isLocked(point) && (moves_ || cuts_));
    if (isFree) near.truncate(0);
    if (looks) request.room = roomOf(point, around, near.indices());
    if (!request.inserts) continue;
    request.place = Vec3(DVec3(points_.positions[point]) + request.offset);
    request.reach = static_cast<float>(reachOf(point) - glm::length(request.offset));
  }
}

void CpuSculpture::examine() {
  requests_.resize(unsettled_.size());
  for (const std::uint32_t point : unsettled_)
    if (isBlocked_[point] == Blocked::before) isBlocked_[point] = Blocked::no;
  const std::span<Part> parts = shareUnsettled();
  grid_.team().forEach(parts.size(), [&](std::size_t k) { request(parts[k]); });
  inserting_.clear();
  for (std::size_t i = 0; i < unsettled_.size(); ++i) {
    const std::uint32_t point = unsettled_[i];
    points_.unsettled[point] = requests_[i].unsettled;
    const std::optional<PlacedBrush>& brush = cuts_ ? cuts_ : moves_;
    if (requests_[i].room && brush && points_.strokes[point] == brush->stroke())
      points_.founds[point].room = static_cast<float>(*requests_[i].room);
    settled_ = settled_ && !requests_[i].unsettled;
    if (requests_[i].goes) remove(point);
    if (requests_[i].inserts) inserting_.push_back(static_cast<std::uint32_t>(i));
  }
  std::ranges::sort(inserting_, {}, [&](std::uint32_t i) { return unsettled_[i]; });
  insertClaimed();
  followInIndex();
}

void CpuSculpture::insertClaimed() {
  const auto forEachRequest = [&](auto&& visit) {
    for (const std::uint32_t i : inserting_) visit(unsettled_[i], requests_[i]);
  };
  forEachRequest([&](std::uint32_t point, const Request& request) { claims_.claim(request.place, point); });
  forEachRequest([&](std::uint32_t point, const Request& request) { claims_.confirm(request.place, point); });
  forEachRequest([&](std::uint32_t point, const Request& request) {
    if (!claims_.stands(request.place, point)) return;
    claims_.grant(request.place);
    const bool otherIsLocked = isLocked(request.other), isHeld = otherIsLocked || isLocked(point);
    const bool takesAfterOther = isHeld ? otherIsLocked : request.takesAfterOther;
    const std::uint32_t parent = takesAfterOther ? request.other : point;
    const std::uint32_t added = points_.insertBetween(point, request.other, parent, request.place);
    makeRoom();
    if (isHeld) hold(added);
    points_.reaches[added - points_.fromFile] = request.reach;
    waiting_.push_back(added);
    strayed_.push_back(added);
    tellOf(added);
  });
}

}  // namespace palpate
