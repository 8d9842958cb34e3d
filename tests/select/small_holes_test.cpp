// Holes are closed with points of the true surface, and nothing else changes.
#include "engine/select/small_holes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/core/point_set.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"

namespace palpate::small_holes_test {

namespace {

/// A surface with a spacing of about 1, and the truth of it.
struct Truth {
  std::string name;
  PointCloud cloud;
  std::function<SurfacePoint(const DVec3&)> closest;
  DVec3 middle;  // of a hole
};

Truth ofShape(const char* name, double size, std::size_t count, const DVec3& middle) {
  const std::shared_ptr<AnalyticShape> shape = makeShape(name, size);
  return {name, sampleShape(*shape, {.count = count}), [=](const DVec3& p) { return shape->closest(p); }, middle};
}

// Open at both ends, along z.
Truth cylinder(double radius, double length) {
  constexpr double kGolden = 0.6180339887498949;
  Truth truth{"cylinder", {}, {}, DVec3(radius, 0, 0)};
  const auto count = static_cast<std::size_t>(2 * std::numbers::pi * radius * length);
  for (std::size_t i = 0; i < count; ++i) {
    const double around = 2 * std::numbers::pi * std::fmod(static_cast<double>(i) * kGolden, 1.0);
    const DVec3 normal(std::cos(around), std::sin(around), 0);
    const double along = (static_cast<double>(i) + 0.5) / static_cast<double>(count) - 0.5;
    truth.cloud.positions.emplace_back(radius * normal + DVec3(0, 0, length * along));
    truth.cloud.normals.emplace_back(normal);
  }
  truth.closest = [=](const DVec3& p) {
    const DVec3 normal = glm::normalize(DVec3(p.x, p.y, 0));
    return SurfacePoint{radius * normal + DVec3(0, 0, p.z), normal};
  };
  return truth;
}

std::vector<Truth> truths() {
  constexpr double kSide = 60;
  const auto sphere = static_cast<std::size_t>(std::numbers::pi * kSide * kSide);
  std::vector<Truth> all;
  all.push_back(ofShape("plane", kSide, static_cast<std::size_t>(kSide * kSide), DVec3(3, -4, 0)));
  all.push_back(ofShape("sphere", kSide, sphere, kSide / 2 * glm::normalize(DVec3(1, 2, 3))));
  all.push_back(cylinder(20, kSide));
  return all;
}

PointSet inBall(const PointCloud& cloud, const DVec3& middle, double radius) {
  PointSet set;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (glm::distance(DVec3(cloud.positions[i]), middle) < radius) set.set(i);
  return set;
}
PointCloud without(const PointCloud& cloud, const PointSet& gone) {
  return chosenPoints(cloud, othersThan(gone, cloud.size()));
}
void addNoise(PointCloud& cloud, double deviation) {
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.positions[i] += static_cast<float>(deviation * randomNormal3(7, i).x) * cloud.normals[i];
}

double angle_deg(const Vec3& a, const DVec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(DVec3(a), b), -1.0, 1.0)));
}

struct Judged {
  double far = 0, tilt_deg = 0, outside = 0;  // largest
  double close = 1e9, apart = 0;              // least and largest distance of a new point to the next one
  double left = 0;                            // largest distance of a missing point from the next one
};
Judged judge(const Truth& truth, const PointCloud& holed, const PointSet& missing, const HoleFilling& filling,
             double radius) {
  Judged judged;
  PointCloud closed = holed;
  addPoints(closed, filling.points);
  const PointTree tree(closed.positions);
  std::array<std::uint32_t, 2> near{};
  std::array<double, 2> squared{};
  for (const NewPoint& point : filling.points) {
    const DVec3 p(point.position);
    const SurfacePoint there = truth.closest(p);
    judged.far = std::max(judged.far, glm::distance(p, there.position));
    judged.tilt_deg = std::max(judged.tilt_deg, angle_deg(point.normal, there.normal));
    judged.outside = std::max(judged.outside, glm::distance(p, truth.middle) - radius);
    tree.nearest(point.position, near, squared);
    judged.close = std::min(judged.close, std::sqrt(squared[1]));
    judged.apart = std::max(judged.apart, std::sqrt(squared[1]));
  }
  missing.forEach([&](std::uint64_t i) {
    tree.nearest(truth.cloud.positions[i], near, squared);
    judged.left = std::max(judged.left, std::sqrt(squared[0]));
  });
  return judged;
}

}  // namespace

TEST_CASE("a hole in a plane, a sphere and a cylinder is closed with even points of their surface") {
  for (const Truth& truth : truths())
    for (const double wide : {3.0, 6.0, 10.0})
      for (const double noise : {0.0, 0.15}) {
        CAPTURE(truth.name);
        CAPTURE(wide);
        CAPTURE(noise);
        const double radius = wide / 2;
        const PointSet missing = inBall(truth.cloud, truth.middle, radius);
        PointCloud holed = without(truth.cloud, missing);
        addNoise(holed, noise);
        // Of few points a hole has a width by chance.
        const double chance = wide < 6 ? 1.5 : 0;
        const HoleFilling filling = fillHoles(holed, wide + chance);
        CHECK(filling.closed == 1);
        CHECK(filling.left == 0);
        if (truth.name != "cylinder") CHECK(filling.wider == 0);
        CHECK(filling.points.size() == within(static_cast<double>(missing.count()), 1.6 + 0.06 * wide * wide));
        const Judged judged = judge(truth, holed, missing, filling, radius);
        MESSAGE(truth.name, " ", wide, " ", noise, ": ", filling.points.size(), " for ", missing.count(), ", off ",
                judged.far, ", tilt ", judged.tilt_deg, ", outside ", judged.outside, ", apart ", judged.close, " to ",
                judged.apart, ", left ", judged.left);
        CHECK(judged.far <= 0.02 + 1.5 * noise);
        CHECK(judged.tilt_deg <= 0.5 + 75 * noise);
        CHECK(judged.outside <= 0.6);
        CHECK(judged.close >= 0.55);
        CHECK(judged.apart <= 1.3);
        CHECK(judged.left <= 1.1);
        // It is wider than that, so that it stays.
        const HoleFilling open = fillHoles(holed, 0.8 * wide - chance);
        CHECK(open.points.empty());
        CHECK(open.wider >= 1);  // a tube is open at its ends, too
        CHECK(open.narrowest <= wide + chance);
        CHECK(fillHoles(holed, open.narrowest).closed == 1);
      }
}

TEST_CASE("nothing is added where there is no hole") {
  for (Truth& truth : truths())
    for (const double noise : {0.0, 0.15, 0.3}) {
      CAPTURE(truth.name);
      CAPTURE(noise);
      PointCloud cloud = truth.cloud;
      addNoise(cloud, noise);
      const HoleFilling filling = fillHoles(cloud, 1000);
      CHECK(filling.points.size() == 0);
      // The ends of the tube are open, but not holes in a plane.
      CHECK(filling.left <= (truth.name == "cylinder" ? 2 : 0));
    }
}

TEST_CASE("what two sheets, an island and random points leave open is not a hole") {
  const Truth plane = truths().front();
  // Two sheets, half a spacing apart; there is a hole in the upper one.
  PointCloud plate = without(plane.cloud, inBall(plane.cloud, plane.middle, 3));
  const std::size_t above = plate.size();
  for (const Vec3& p : plane.cloud.positions) {
    plate.positions.push_back(p - Vec3(0.3f, 0.2f, 0.5f));
    plate.normals.emplace_back(0, 0, -1);
  }
  const HoleFilling filling = fillHoles(plate, 200);
  CHECK(filling.closed == 1);
  CHECK(filling.left == 0);
  CHECK(filling.points.size() == within(28, 3));
  for (const NewPoint& point : filling.points) {
    CHECK(point.position.z == within(0, 1e-4));
    CHECK(point.parent < above);
  }
  // What is in a hole stays, and its surroundings are closed; a bay of the border is not one.
  PointSet ring = inBall(plane.cloud, plane.middle, 6);
  ring.flip(inBall(plane.cloud, plane.middle, 1.5));
  ring.add(inBall(plane.cloud, DVec3(30, 0, 0), 5));
  const PointCloud island = without(plane.cloud, ring);
  const HoleFilling around = fillHoles(island, 15);
  CHECK(around.closed == 1);
  for (const NewPoint& point : around.points) {
    const double radius = glm::distance(DVec3(point.position), plane.middle);
    CHECK(radius >= 1.2);
    CHECK(radius <= 6.5);
  }
  CHECK(around.points.size() == within(static_cast<double>(std::numbers::pi * (36 - 2.25)), 12));
  // Random points leave gaps of three spacings here and there.
  PointCloud random;
  for (std::size_t i = 0; i < 10'000; ++i) {
    random.positions.emplace_back(100 * randomUnit(1, 2 * i), 100 * randomUnit(1, 2 * i + 1), 0);
    random.normals.emplace_back(0, 0, 1);
  }
  CHECK(fillHoles(random, 50).points.empty());
  // Too few points for a surface.
  PointCloud few;
  for (std::size_t i = 0; i < 12; ++i) {
    CHECK(fillHoles(few, 1e6).points.empty());
    few.positions.push_back(random.positions[i % 7]);
  }
}

TEST_CASE("new points have colours between those of the rim, fields of the nearest one, and change no other point") {
  PointCloud cloud = truths().front().cloud;
  Attribute number{"number", ScalarType::u64, {}};
  for (std::uint64_t i = 0; i < cloud.size(); ++i) {
    const bool isRight = cloud.positions[i].x > 3;
    cloud.colors.push_back(isRight ? std::array<std::uint8_t, 4>{200, 100, 0, 255}
                                   : std::array<std::uint8_t, 4>{100, 200, 0, 255});
    const std::uint64_t value = (std::uint64_t{1} << 60) + 2 * i + (isRight ? 1 : 0);
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    number.data.insert(number.data.end(), bytes, bytes + sizeof value);
  }
  cloud.extra.push_back(number);
  cloud.origin = DVec3(637000, 849000, 100);
  for (const Vec3& p : cloud.positions) cloud.exactPositions.push_back(cloud.origin + DVec3(p) + DVec3(1e-9));
  const PointCloud holed = without(cloud, inBall(cloud, DVec3(3, -4, 0), 5));
  const std::size_t before = holed.size();
  PreparedStep step;
  const PreparedCloud result =
      prepared(holed, {.fillHoles_mm = 150}, {.mm_per_unit = 10}, [&](const PreparedStep& each) { step = each; });
  const std::size_t added = result.cloud.size() - before;
  CHECK(added == within(78, 8));
  CHECK(step.name == "prepare.fill_holes_mm");
  CHECK(step.before == before);
  CHECK(step.after == before + added);
  CHECK(step.what == fmt::format("closes 1 hole with {} new points", added));
  CHECK(result.numbers.size() == before);
  const auto isKept = [&](const auto& was, const auto& is) {
    return is.size() == before + added && std::memcmp(was.data(), is.data(), before * sizeof was[0]) == 0;
  };
  CHECK(isKept(holed.positions, result.cloud.positions));
  CHECK(isKept(holed.normals, result.cloud.normals));
  CHECK(isKept(holed.colors, result.cloud.colors));
  CHECK(isKept(holed.exactPositions, result.cloud.exactPositions));
  CHECK(std::ranges::equal(std::span(result.cloud.extra[0].data).first(8 * before), holed.extra[0].data));
  for (std::size_t i = before; i < result.cloud.size(); ++i) {
    const double right = result.cloud.positions[i].x - 3;
    std::uint64_t value = 0;
    std::memcpy(&value, result.cloud.extra[0].data.data() + 8 * i, sizeof value);
    CHECK(value >= std::uint64_t{1} << 60);
    if (std::abs(right) > 1.5) CHECK(value % 2 == (right > 0 ? 1 : 0));
    const auto [red, green, blue, alpha] = result.cloud.colors[i];
    CHECK(red + green == within(300, 1));
    CHECK((right > 0 ? red : green) >= 130);
    CHECK(blue == 0);
    CHECK(alpha == 255);
    CHECK(result.cloud.exactPositions[i] == result.cloud.origin + DVec3(result.cloud.positions[i]));
  }
  // Later steps are done to the new points as well, which have no number.
  const PreparedCloud fewer =
      prepared(holed, {.fillHoles_mm = 150, .random = 1000, .set = {"uint8 seen = 1"}}, {.mm_per_unit = 10});
  CHECK(fewer.cloud.size() == 1000);
  CHECK(fewer.numbers.size() < 1000);
  CHECK(fewer.numbers.size() > 900);
  const unsigned cores = 3;
  CHECK(prepared(holed, {.fillHoles_mm = 150}, {.mm_per_unit = 10, .threads = cores}).cloud.positions ==
        result.cloud.positions);
}

TEST_CASE("the rim of a bowl is left open, which is said, and a job that closes some can be stopped") {
  // Little more than half a sphere: the points of its rim face sideways.
  PointCloud bowl;
  const Truth sphere = truths()[1];
  for (std::size_t i = 0; i < sphere.cloud.size(); ++i)
    if (sphere.cloud.positions[i].z < 2) {
      bowl.positions.push_back(sphere.cloud.positions[i]);
      bowl.normals.push_back(sphere.cloud.normals[i]);
    }
  const HoleFilling filling = fillHoles(bowl, 1000);
  CHECK(filling.points.empty());
  CHECK(inWords(filling, 1) == "closes 0 holes with 0 new points; 1 hole is left open, whose rim folds");
  // Rounded up, so that the length that is shown closes it.
  CHECK(inWords({.closed = 2, .wider = 3, .narrowest = 1.23401}, 10) ==
        "closes 2 holes with 0 new points; 3 holes are wider, the narrowest 12.4 mm");
  CHECK(inWords({.wider = 1, .narrowest = 0.5}, 1) == "closes 0 holes with 0 new points; 1 hole is wider: 0.5 mm");
  const std::atomic<bool> stopped = true;
  const JobStopScope stops({.flag = &stopped, .mayCut = true});
  CHECK_THROWS_AS(fillHoles(bowl, 1000), Stopped);
}

TEST_CASE("an axis becomes z, and the ground is then below") {
  for (const auto& named : kUpAxes) {
    const UpAxis up = named.second;
    CAPTURE(named.first);
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 7, 5), Vec3(2, 2, 9)};
    cloud.normals = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    const PreparedCloud result = prepared(cloud, {.upright = up}, {});
    const DVec3 along = directionOf(up);
    const auto heightsOf = [&](std::size_t a, std::size_t b) {
      return glm::dot(along, DVec3(cloud.positions[a]) - DVec3(cloud.positions[b]));
    };
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 risen = result.cloud.positions[i] - result.cloud.positions[0];
      CHECK(static_cast<double>(risen.z) == within(heightsOf(i, 0), 1e-6));
      CHECK(static_cast<double>(result.cloud.normals[i].z) == within(glm::dot(along, DVec3(cloud.normals[i])), 1e-6));
      CHECK(static_cast<double>(glm::length(risen)) ==
            within(static_cast<double>(glm::length(cloud.positions[i] - cloud.positions[0])), 1e-5));
    }
    CHECK(result.steps.at(0).what == fmt::format("rotates {} to z", named.first));
    CHECK(upSaidIn(result.cloud.storedAs.comments) == UpAxis::z);
  }
}

}  // namespace palpate::small_holes_test
