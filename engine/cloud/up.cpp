#include "engine/cloud/up.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/up_shape.hpp"

namespace palpate {

namespace {

constexpr std::size_t kFewest = 100;  // positions: fewer do not define a shape
constexpr double kFlat = 0.005;       // of the longest side: the orientation of a flatter sheet is unknown
constexpr double kThin = 0.35;        // of the next longer side: a thinner shape may be ground
constexpr double kMaxLayers = 1.4;    // of a sheet, along its thin side
constexpr double kOneSided = 0.2;     // mean of the normals, along the thin side
constexpr double kBaseFilled = 0.3;   // relative to the outline: a base rather than a round end
constexpr double kMin = 0.16;         // minimum score of a standing shape
constexpr double kClearly = 1.15;     // factor by which another axis must beat y
constexpr double kSure = 2;           // factor to the next axis, if the orientation is likely
constexpr double kLikelyY = 1.0, kLikelyZ = 0.97, kUnlikely = 0.9;  // prior weights by how files mostly are

double likely(UpAxis up) { return up == UpAxis::y ? kLikelyY : up == UpAxis::z ? kLikelyZ : kUnlikely; }

UpAxis opposite(UpAxis up) { return static_cast<UpAxis>((static_cast<int>(up) + 3) % 6); }

std::optional<Upright> asSheet(const UprightShape& shape) {
  const DVec3 extent = shape.extent();
  int thin = 0;
  for (int k = 1; k < 3; ++k)
    if (extent[k] < extent[thin]) thin = k;
  const double next = std::min(extent[(thin + 1) % 3], extent[(thin + 2) % 3]);
  if (extent[thin] > kThin * next) return std::nullopt;
  if (extent[thin] < kFlat * next) return Upright{UpAxis::y, "a flat sheet, which is ambiguous", Sureness::guessed};
  if (shape.layers(thin) > kMaxLayers) return std::nullopt;
  if (shape.isFacade(thin)) return Upright{thin == 1 ? UpAxis::z : UpAxis::y, "a wall with straight openings"};
  const auto positive = static_cast<UpAxis>(thin);
  const bool fromBelow = shape.meanNormal(positive) < -kOneSided;
  return Upright{fromBelow ? opposite(positive) : positive,
                 fmt::format("ground, {:.0f} % as high as wide{}", 100 * extent[thin] / next,
                             std::abs(shape.meanNormal(positive)) > kOneSided ? ", seen from above" : "")};
}

/// A room seen from inside, from one position or from one side: nothing faces away from the viewer, and the floor, seen
/// from above, is wider than any other surface across the view, and lies lowest.
std::optional<Upright> asRoom(const UprightShape& shape) {
  constexpr double kView = 0.5;      // minimum mean of the normals towards the viewer
  constexpr double kHidden = 0.02;   // maximum share of the positions that face away from the viewer
  constexpr double kFloor = 0.08;    // minimum share that faces up
  constexpr double kWider = 2;       // factor to the next direction across the view
  constexpr double kLowest = 0.25;   // maximum height of a floor
  constexpr double kSideways = 0.5;  // weight of x as the up axis
  UpAxis view = UpAxis::y;
  for (const auto& [name, from] : kUpAxes)
    if (shape.meanNormal(from) > shape.meanNormal(view)) view = from;
  if (shape.meanNormal(view) < kView || shape.facing(opposite(view)) > kHidden) return std::nullopt;
  std::optional<UpAxis> floor;
  double most = 0, next = 0;
  for (const auto& [name, up] : kUpAxes) {
    if (sidesOf(up).axis == sidesOf(view).axis) continue;
    const double share = shape.facing(up) * (sidesOf(up).axis == 0 ? kSideways : 1);
    next = std::max(next, std::min(most, share));
    if (share > most) {
      floor = up;
      most = share;
    }
  }
  if (floor && most > kFloor && most > kWider * next && shape.heightOfFacing(*floor) < kLowest)
    return Upright{*floor, fmt::format("a floor, {:.0f} % of what was seen from one side", 100 * shape.facing(*floor))};
  return std::nullopt;
}

/// Number of sides that are walls, floors or ceilings seen from inside.
std::size_t wallsIn(const UprightShape& shape) {
  constexpr double kWall = 0.02;  // minimum share of the positions
  return static_cast<std::size_t>(
      std::ranges::count_if(kUpAxes, [&](const auto& named) { return shape.facingIn(named.second) > kWall; }));
}

/// A room seen from inside, all round: its walls face in, and more of the objects between them is seen from above than
/// from any other side.
std::optional<Upright> asInterior(const UprightShape& shape) {
  constexpr std::size_t kWalls = 4;
  constexpr double kFurniture = 0.02;  // minimum share of the positions
  constexpr double kMore = 1.5;        // factor to the next direction
  UpAxis up = UpAxis::y;
  double most = 0, next = 0;
  for (const auto& [name, direction] : kUpAxes) {
    const double share = shape.furniture(direction);
    next = std::max(next, std::min(most, share));
    if (share > most) {
      most = share;
      up = direction;
    }
  }
  if (wallsIn(shape) < kWalls || most < kFurniture || most < kMore * next) return std::nullopt;
  return Upright{up, "a room seen from inside, and its contents"};
}

/// A body that was cut off, as a head in a scanner is at its neck: it is open there, and ends in a rim. If cut off at
/// one side alone it stands on that, unless the other side is a base. If cut out of a volume at several sides, z is
/// along it, starting from the larger cut.
std::optional<Upright> asCutBody(const UprightShape& shape) {
  constexpr double kMore = 1.5;
  std::array<double, 6> cuts;
  std::size_t count = 0;
  UpAxis only = UpAxis::y;
  for (const auto& [name, up] : kUpAxes) {
    cuts[static_cast<std::size_t>(up)] = shape.cutBelow(up);
    if (cuts[static_cast<std::size_t>(up)] == 0) continue;
    ++count;
    only = up;
  }
  if (count == 1 && shape.standing(opposite(only)).filled < kBaseFilled) return Upright{only, "a body cut off below"};
  const double low = cuts[static_cast<std::size_t>(UpAxis::z)], high = cuts[static_cast<std::size_t>(UpAxis::minusZ)];
  if (count < 2 || (low == 0 && high == 0)) return std::nullopt;
  return Upright{high > kMore * low ? UpAxis::minusZ : UpAxis::z, fmt::format("a body cut off at {} sides", count)};
}

/// A camera view from the origin of the file's coordinates, along z: one position in each direction, within its field
/// of view. Cameras that look along z have y down, those that look against it have y up.
std::optional<Upright> asCameraView(const PointCloud& cloud, const VoxelSample& sample, const UprightShape& shape) {
  constexpr double kBehind = 0.005;                  // maximum share of the positions behind the camera
  constexpr double kNarrowest = 0.2, kWidest = 1.5;  // tangents of half the field of view
  constexpr double kSkew = 0.35;                     // between its two sides
  constexpr double kDeep = 1.3;                      // minimum ratio of farthest to nearest
  constexpr double kPlaces = 6;                      // in a cell of the picture
  if (cloud.origin != DVec3(0)) return std::nullopt;
  const double ahead = shape.middle().z > 0 ? 1 : -1;
  std::array<std::vector<double>, 2> tangents;
  std::vector<double> depths;
  for (const Vec3& place : sample.places) {
    const double depth = ahead * double{place.z};
    if (!(depth > 0)) continue;
    depths.push_back(depth);
    for (int k = 0; k < 2; ++k) tangents[static_cast<std::size_t>(k)].push_back(place[k] / depth);
  }
  const auto count = static_cast<double>(sample.places.size());
  if (static_cast<double>(depths.size()) < (1 - kBehind) * count) return std::nullopt;
  if (quantile(depths, 1 - kUpTail) < kDeep * quantile(depths, kUpTail)) return std::nullopt;
  double area = 1;
  for (const std::vector<double>& side : tangents) {
    const double low = -quantile(side, kUpTail), high = quantile(side, 1 - kUpTail);
    if (std::min(low, high) < kNarrowest || std::max(low, high) > kWidest) return std::nullopt;
    if (std::abs(high - low) > kSkew * (high + low)) return std::nullopt;
    area *= high + low;
  }
  const double width = std::sqrt(kPlaces * area / count);
  Columns columns;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const auto cell = [&](std::size_t k) { return static_cast<int>(std::floor(tangents[k][i] / width)); };
    columns[{cell(0), cell(1)}].push_back(std::log(depths[i]));
  }
  for (auto& [cell, heights] : columns) std::ranges::sort(heights);
  if (layersOf(columns, width) > kMaxLayers) return std::nullopt;
  return Upright{ahead > 0 ? UpAxis::minusY : UpAxis::y, "the view of a camera at the origin"};
}

/// A scan from the air: one height over nearly all of the ground, however high the buildings. Without normals a facade
/// looks the same; but files of airborne scans have z up, and ground lies low.
std::optional<Upright> asAirborne(const UprightShape& shape) {
  constexpr double kReach = 0.08;       // of the height, in a typical column
  constexpr double kClearlyLess = 0.5;  // relative to the reach of columns along the other axes
  constexpr double kLow = 0.5;          // median height
  constexpr double kLayers = 1.5;
  for (int axis = 2; axis >= 0; --axis) {
    const double reach = shape.reach(axis);
    if (reach > kReach || reach > kClearlyLess * std::min(shape.reach((axis + 1) % 3), shape.reach((axis + 2) % 3)))
      continue;
    if (shape.layers(axis) > kLayers) continue;
    const auto positive = static_cast<UpAxis>(axis);
    const double towards = shape.meanNormal(positive);
    if (std::abs(towards) > kOneSided ? shape.isFacade(axis) || std::abs(towards) < kUpOneView : axis != 2) continue;
    const UpAxis up = towards < -kOneSided ? opposite(positive) : positive;
    const double median = shape.medianHeight(axis);
    if ((up == positive ? median : 1 - median) < kLow)
      return Upright{up, "ground seen from the air, one height over each place"};
  }
  return std::nullopt;
}

/// What surrounds or underlies the rest: a sheet, a room, ground, or the view of a camera.
std::optional<Upright> asSurroundings(const PointCloud& cloud, const VoxelSample& sample, const UprightShape& shape) {
  if (auto sheet = asSheet(shape)) return sheet;
  if (auto room = asRoom(shape)) return room;
  if (auto interior = sample.normals.empty() ? std::nullopt : asInterior(shape)) return interior;
  if (auto view = asCameraView(cloud, sample, shape)) return view;
  return asAirborne(shape);
}

/// Whether the shape was scanned from inside: a room with its ceiling, also an empty one, or what is open above, as a
/// street between walls that face each other and show only their backs from outside.
bool isInterior(const UprightShape& shape, UpAxis up, bool hasNormals) {
  constexpr double kBacks = 0.3, kOpen = 0.7;  // shares of what is seen from a side that faces the viewer
  constexpr double kUprightWall = 0.05;        // share of the positions; slopes of a wavy sheet face up
  if (!hasNormals) return false;
  if (asInterior(shape)) return true;
  const Sides sides = sidesOf(up);
  const auto showsBacks = [&](int axis) {
    const auto side = static_cast<UpAxis>(axis);
    return std::min(shape.facing(side), shape.facing(opposite(side))) > kUprightWall &&
           shape.seenFrom(side).outside < kBacks && shape.seenFrom(opposite(side)).outside < kBacks;
  };
  constexpr std::size_t kClosed = 5;  // walls: a floor may be covered
  const bool across = showsBacks(sides.across), along = showsBacks(sides.along);
  if (across && along && wallsIn(shape) >= kClosed) return true;
  return (across || along) && shape.seenFrom(up).outside > kOpen;
}

/// Towards the viewer of a standing object, which is seen from outside and open behind; else of its wider side.
void findFront(Upright& found, const UprightShape& shape) {
  constexpr double kOpen = 0.25;   // difference of what is seen from outside, between a side and the opposite one
  constexpr double kWider = 0.95;  // of the longer horizontal extent: the model is as wide along both
  constexpr double kMoreDetail = 1.2;
  const Sides up = sidesOf(found.up);
  std::array<SeenSide, 6> seen;
  const auto of = [&](UpAxis side) -> SeenSide& { return seen[static_cast<std::size_t>(side)]; };
  std::optional<UpAxis> open;
  for (const auto& [name, side] : kUpAxes)
    if (sidesOf(side).axis != up.axis) of(side) = shape.seenFrom(side);
  for (const auto& [name, side] : kUpAxes)
    if (of(side).outside > of(opposite(side)).outside + kOpen && (!open || of(side).detail > of(*open).detail))
      open = side;
  const DVec3 extent = shape.extent();
  const double shorter = std::min(extent[up.across], extent[up.along]);
  UpAxis front = axisOf(found.front);
  if (open) {
    front = *open;
  } else if (shorter < kWider * std::max(extent[up.across], extent[up.along])) {
    const int axis = extent[up.across] == shorter ? up.across : up.along;
    if (axis != sidesOf(front).axis) front = static_cast<UpAxis>(axis);
  }
  if (!open && of(opposite(front)).detail > kMoreDetail * of(front).detail) front = opposite(front);
  found.front = directionOf(front);
  if (open || of(front).detail > kMoreDetail * of(opposite(front)).detail) found.frontSureness = Sureness::likely;
}

/// Detail below, relative to that above: standing objects and skulls are smoother above. 1 if unknown.
double smootherAbove(const UprightShape& shape, UpAxis up) {
  const double above = shape.seenFrom(up).detail, below = shape.seenFrom(opposite(up)).detail;
  return above > 0 && below > 0 ? below / above : 1;
}

/// A shape on a base: a flat one, or legs and edges under what is smoother above.
std::optional<Upright> byStand(const UprightShape& shape) {
  std::array<Stand, 6> stands;
  const auto of = [&](UpAxis up) -> Stand& { return stands[static_cast<std::size_t>(up)]; };
  UpAxis best = UpAxis::y;
  for (const auto& [name, up] : kUpAxes) {
    of(up) = shape.standing(up);
    of(up).score *= likely(up);
    if (of(up).score > 0 && of(up).filled < kBaseFilled) of(up).score *= std::min(1.0, smootherAbove(shape, up));
  }
  for (const auto& [name, up] : kUpAxes)
    if (of(up).score > of(best).score) best = up;
  if (of(best).score < kMin || shape.isSymmetric(sidesOf(best).axis)) return std::nullopt;
  if (of(best).score < kClearly * of(UpAxis::y).score) best = UpAxis::y;
  constexpr double kFloor = 0.3;  // share of all positions
  double next = 0;
  for (const auto& [name, up] : kUpAxes)
    if (up != best) next = std::max(next, of(up).score);
  const Sides sides = sidesOf(best);
  const DVec3 extent = shape.extent();
  const bool isFloor =
      extent[sides.axis] < std::min(extent[sides.across], extent[sides.along]) && of(best).share > kFloor;
  return Upright{best, isFloor ? "guessed from its floor" : "guessed from its flat base",
                 of(best).score > kSure * next ? Sureness::likely : Sureness::guessed};
}

/// A shape without a base, such as a skull.
std::optional<Upright> bySmoothness(const UprightShape& shape) {
  constexpr double kSmoother = 1.5;
  UpAxis best = UpAxis::y;
  double most = 0;
  for (const auto& [name, up] : kUpAxes) {
    const double ratio = likely(up) * smootherAbove(shape, up);
    if (ratio > most) best = up;
    most = std::max(most, ratio);
  }
  if (most < kSmoother) return std::nullopt;
  return Upright{best, "smoother above than below", Sureness::guessed};
}

}  // namespace

std::string_view nameOf(Sureness sureness) {
  constexpr std::array<std::string_view, 3> kNames{"known", "likely", "unsure"};
  return kNames[static_cast<std::size_t>(sureness)];
}

std::string_view nameOf(UpAxis up) { return kUpAxes[static_cast<std::size_t>(up)].first; }

DVec3 directionOf(UpAxis up) {
  const Sides sides = sidesOf(up);
  DVec3 direction(0);
  direction[sides.axis] = sides.sign;
  return direction;
}

DVec3 frontOf(UpAxis up) {
  switch (up) {
    case UpAxis::z:
      return {0, -1, 0};
    case UpAxis::minusZ:
      return {0, 1, 0};
    case UpAxis::minusY:
      return {0, 0, -1};
    default:
      return {0, 0, 1};
  }
}

UpAxis axisOf(const DVec3& direction) {
  UpAxis nearest = UpAxis::x;
  for (const auto& [name, axis] : kUpAxes)
    if (glm::dot(directionOf(axis), direction) > glm::dot(directionOf(nearest), direction)) nearest = axis;
  return nearest;
}

UpAxis turnedUp(UpAxis up, const DVec3& front) { return axisOf(glm::cross(front, directionOf(up))); }

std::optional<UpAxis> upOfCameras(const DVec3& meanUp) {
  constexpr double kUpright = 0.8;  // minimum length of the mean, and minimum cosine between it and the axis
  const double size = glm::length(meanUp);
  if (!(size > kUpright)) return std::nullopt;
  const UpAxis axis = axisOf(meanUp);
  return glm::dot(directionOf(axis), meanUp) > kUpright * size ? std::optional(axis) : std::nullopt;
}

namespace {

constexpr std::string_view kSays = "comment up: ";

}  // namespace

void setUp(std::vector<std::string>& comments, UpAxis up) {
  std::erase_if(comments, [](const std::string& comment) { return comment.starts_with(kSays); });
  comments.push_back(fmt::format("{}{}", kSays, nameOf(up)));
}

std::optional<UpAxis> upSaidIn(std::span<const std::string> comments) {
  for (const std::string& comment : comments) {
    if (!comment.starts_with(kSays)) continue;
    const std::string_view said = std::string_view(comment).substr(kSays.size());
    for (const auto& [name, axis] : kUpAxes)
      if (name == said) return axis;
  }
  return std::nullopt;
}

bool keepPose(std::vector<std::string>& comments, double mm_per_unit, UpAxis up) {
  const bool hasScale = scaleSaidIn(comments) || touchScaleSaidIn(comments), hasUp = upSaidIn(comments).has_value();
  if (!hasScale) setTouchScale(comments, mm_per_unit);
  if (!hasUp) setUp(comments, up);
  return !hasScale || !hasUp;
}

Upright findUp(const PointCloud& cloud) {
  const auto said = upSaidIn(cloud.storedAs.comments);
  Upright known{said.value_or(UpAxis::y), "the file says so", Sureness::known, frontOf(said.value_or(UpAxis::y))};
  const VoxelSample sample = voxelSampleOf(cloud);
  if (sample.places.size() < kFewest)
    return said ? known : Upright{UpAxis::y, "too few points to tell", Sureness::guessed};
  const UprightShape shape(sample);
  if (said) {
    known.isInterior = isInterior(shape, *said, !sample.normals.empty());
    return known;
  }
  std::optional<Upright> found = asSurroundings(cloud, sample, shape);
  const bool isObject = !found;
  if (!found) found = asCutBody(shape);
  if (!found) found = byStand(shape);
  if (!found) found = bySmoothness(shape);
  if (!found) return {UpAxis::y, "the shape is ambiguous", Sureness::guessed};
  found->front = frontOf(found->up);
  found->isInterior = isInterior(shape, found->up, !sample.normals.empty());
  if (isObject) findFront(*found, shape);
  return *found;
}

}  // namespace palpate
