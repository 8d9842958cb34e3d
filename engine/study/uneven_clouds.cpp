#include "engine/study/uneven_clouds.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/core/error.hpp"
#include "engine/core/unknown_name.hpp"

namespace palpate {

namespace {

constexpr std::array<std::string_view, 6> kUnevenNames{"even", "gradient", "patches", "random", "decimated", "plate"};

constexpr double kRadius = 50, kThickness = 0.8;
constexpr double kRatio = 10;  // of the densities at the two ends of the gradient
constexpr double kPatchAngle = 20 * std::numbers::pi / 180, kShareBetween = 0.08;
constexpr double kGoldenAngle = std::numbers::pi * (3 - 2.2360679774997896);

void addTo(PointCloud& cloud, const DVec3& direction) {
  cloud.positions.emplace_back(kRadius * direction);
  cloud.normals.emplace_back(direction);
}

DVec3 direction(double x, double angle) {
  const double r = std::sqrt(std::max(0.0, 1 - x * x));
  return {x, r * std::cos(angle), r * std::sin(angle)};
}

// A spiral whose turns are at `xOf(share)` along the x axis for shares from 0 to 1; keeps the points with keep(point).
template <class XOf, class Keep>
void addSpiral(PointCloud& cloud, std::size_t count, XOf&& xOf, Keep&& keep) {
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const DVec3 d = direction(xOf(share), kGoldenAngle * static_cast<double>(i));
    if (keep(d)) addTo(cloud, d);
  }
}

constexpr auto kEvenly = [](double share) { return 1 - 2 * share; };
constexpr auto kAll = [](const DVec3&) { return true; };

// Density proportional to ratio^(-s), s from 0 at x = 1 to 1 at x = -1: the inverse of its integral.
PointCloud gradient(std::size_t count) {
  PointCloud cloud;
  addSpiral(
      cloud, count, [](double share) { return 1 + 2 * std::log1p(-share * (1 - 1 / kRatio)) / std::log(kRatio); },
      kAll);
  return cloud;
}

// The centres of the patches: an icosahedron's corners, rotated so that the border of a patch passes through +z.
std::array<DVec3, 12> patchMiddles() {
  std::array<DVec3, 12> middles;
  const double tilt = kPatchAngle, height = 1 / std::sqrt(5.0), r = 2 / std::sqrt(5.0);
  for (std::size_t k = 0; k < 12; ++k) {
    const bool up = k < 6;
    const double angle = 2 * std::numbers::pi * (static_cast<double>(k % 6) + (up ? 0 : 0.5)) / 5;
    DVec3 d = k % 6 == 5 ? DVec3(0, 0, 1) : DVec3(r * std::cos(angle), r * std::sin(angle), height);
    if (!up) d.z = -d.z;
    middles[k] = {std::cos(tilt) * d.x + std::sin(tilt) * d.z, d.y, std::cos(tilt) * d.z - std::sin(tilt) * d.x};
  }
  return middles;
}

PointCloud patches(std::size_t count) {
  const auto middles = patchMiddles();
  const auto inPatch = [&](const DVec3& d) {
    return std::ranges::any_of(middles, [&](const DVec3& m) { return glm::dot(m, d) > std::cos(kPatchAngle); });
  };
  const double patchArea = 6 * (1 - std::cos(kPatchAngle));  // as a share of the sphere's area
  const auto all = static_cast<double>(count);
  PointCloud cloud;
  addSpiral(cloud, static_cast<std::size_t>((1 - kShareBetween) * all / patchArea), kEvenly, inPatch);
  addSpiral(cloud, static_cast<std::size_t>(kShareBetween * all / (1 - patchArea)), kEvenly,
            [&](const DVec3& d) { return !inPatch(d); });
  return cloud;
}

PointCloud random(std::size_t count) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i)
    addTo(cloud, direction(1 - 2 * randomUnit(1, 2 * i), 2 * std::numbers::pi * randomUnit(1, 2 * i + 1)));
  return cloud;
}

// Rows about the x axis, `gap` (radians) apart on average, of points three to seven times closer.
PointCloud rows(double gap) {
  constexpr double kAlong = 0.15, kAlongSpread = 0.2, kClustered = 0.1, kClusterWidth = 0.15;
  PointCloud cloud;
  std::uint64_t draw = 0;
  const auto next = [&] { return randomUnit(2, draw++); };
  for (double latitude = gap; latitude < std::numbers::pi; latitude += gap * (0.3 + 1.4 * next())) {
    const double turn = 2 * std::numbers::pi * next();
    double angle = 0;
    while (angle < 2 * std::numbers::pi) {
      addTo(cloud, direction(std::cos(latitude), turn + angle));
      if (next() < kClustered)
        for (int k = 0; k < 3; ++k) {
          // In separate statements: compilers differ in the order of evaluating arguments.
          const double along = kClusterWidth * gap * (next() - 0.5) / std::sin(latitude);
          const double across = kClusterWidth * gap * (next() - 0.5);
          addTo(cloud, direction(std::cos(latitude + across), turn + angle + along));
        }
      angle += gap * (kAlong + kAlongSpread * next()) / std::sin(latitude);
    }
  }
  return cloud;
}

PointCloud decimated(std::size_t count) {
  const auto gapFor = [&](double gap) {
    return gap * std::sqrt(static_cast<double>(rows(gap).size()) / static_cast<double>(count));
  };
  return rows(gapFor(gapFor(0.05)));
}

}  // namespace

std::span<const std::string_view> unevenCloudNames() { return kUnevenNames; }

PointCloud makePlate(std::size_t count, double thickness, unsigned threads) {
  PointCloud plate;
  for (const double side : {1.0, -1.0}) {
    const auto plane = makeShape("plane", 100, {0, 0, 0.5 * side * thickness});
    const PointCloud half = sampleShape(*plane, {.count = count / 2, .seed = side > 0 ? 1u : 2u, .threads = threads});
    plate.positions.insert(plate.positions.end(), half.positions.begin(), half.positions.end());
    for (const Vec3& normal : half.normals) plate.normals.push_back(static_cast<float>(side) * normal);
  }
  return plate;
}

UnevenCloud makeUnevenCloud(std::string_view name, std::size_t count) {
  const auto known = std::ranges::find(kUnevenNames, name);
  if (known == kUnevenNames.end()) throw UsageError("{}", unknownName("uneven cloud", name, kUnevenNames));
  UnevenCloud uneven{.name = *known,
                     .cloud = {},
                     .place = {0, 0, kRadius},
                     .normal = {0, 0, 1},
                     .towards = {-1, 0, 0},
                     .signedDistance = [](const DVec3& p) { return glm::length(p) - kRadius; }};
  if (name == "even") addSpiral(uneven.cloud, count, kEvenly, kAll);
  if (name == "gradient") uneven.cloud = gradient(count);
  if (name == "patches") uneven.cloud = patches(count);
  if (name == "random") uneven.cloud = random(count);
  if (name == "decimated") uneven.cloud = decimated(count);
  if (name == "plate") {
    uneven.cloud = makePlate(count, kThickness);
    uneven.place.z = 0.5 * kThickness;
    uneven.signedDistance = [](const DVec3& p) { return std::abs(p.z) - 0.5 * kThickness; };
  }
  return uneven;
}

}  // namespace palpate
