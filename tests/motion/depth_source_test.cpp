// Frames of a depth stream as points: of a sensor that sends points, and of a stream that stops; and surfaces blended
// from one depth frame to the next, against moving planes and spheres.
#include "engine/motion/depth_source.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_points.hpp"
#include "shaders/shared/motion.h"
#include "tests/motion/depth_scene.hpp"
#include "tests/motion/depth_stream.hpp"
#include "tests/near.hpp"

namespace palpate::depth_source_test {

namespace {

/// A live stream that limits how long its frames stay valid.
class Trusted final : public DepthStream {
 public:
  Trusted(const DepthCamera& camera, double staysTrue_s) : inner_(camera), staysTrue_s_(staysTrue_s) {}
  const DepthCamera& camera() const override { return inner_.camera(); }
  bool next(DepthFrame& frame) override { return inner_.next(frame); }
  void stop() noexcept override { inner_.stop(); }
  bool isRecorded() const override { return false; }
  void rewind() override {}
  double staysTrue_s() const override { return staysTrue_s_; }
  void give(const DepthFrame& frame) { inner_.give(frame); }

 private:
  LiveStream inner_;
  double staysTrue_s_;
};

DepthFrame sensed(std::uint64_t number, double time_s, std::size_t points, double x) {
  DepthFrame frame{.time_s = time_s, .number = number};
  frame.points.emplace();
  for (std::size_t i = 0; i < points; ++i) {
    frame.points->places.emplace_back(4e6 + x + static_cast<double>(i), 1, 2);
    frame.points->normals.emplace_back(0, 0, -1);
    frame.colors.push_back({std::uint8_t(i), 1, 2});
  }
  return frame;
}

constexpr DepthCamera kSensor{.width = 5, .height = 1};

/// The points at `time_s` or soon after, once isThere() accepts them.
CloudFrame frameWith(DepthSource& source, double time_s, const std::function<bool(const CloudFrame&)>& isThere) {
  CloudFrame frame;
  const Stopwatch since;
  for (source.makeFrame(time_s, frame); !isThere(frame) && since.elapsed_s() < 10; source.makeFrame(time_s, frame)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    time_s += 1e-6;  // a source accepts each time once
  }
  return frame;
}

constexpr double kPeriod_s = 1.0 / 30, kNever = std::numeric_limits<double>::infinity();

/// A plane at a distance from the camera along its normal.
DepthFrame planeFrame(const DepthCamera& camera, const DVec3& normal, double distance) {
  DepthFrame frame;
  for (std::uint32_t row = 0; row < camera.height; ++row)
    for (std::uint32_t column = 0; column < camera.width; ++column)
      frame.depth_m.push_back(static_cast<float>(distance / glm::dot(normal, camera.placeAt(column, row, 1))));
  return frame;
}

struct Blended {
  DepthBlend blend;
  CloudFrame points;
  DepthPoints maker;
  std::vector<Vec3> normals = {};

  void follow(const DepthCamera& camera, const DepthFrame& before, const DepthFrame& frame, double since_s = kNever,
              const DVec3& origin = DVec3(0)) {
    maker.make(camera, before, origin, points);
    maker.normalsByPixel(points, before.depth_m.size(), normals);
    maker.make(camera, frame, origin, points);
    blend.follow(camera, {.frame = before, .normals = normals}, frame, origin, maker.pixels(),
                 {.between_s = kPeriod_s, .since_s = since_s, .lasts_s = kPeriod_s}, points);
    requireWhole(points, frame.depth_m.size());
    REQUIRE(maker.pixels().size() == points.size());
  }
  DVec3 placeAfter(std::size_t i, double time_s) const {
    return DVec3(points.positions[i]) + std::min(time_s, points.extrapolationLimit_s) * DVec3(points.velocities[i]);
  }
};

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

}  // namespace

TEST_CASE("a sensor's points are used with their colours, far from zero too, and at rest") {
  const auto stream = std::make_shared<Trusted>(kSensor, 3);
  stream->give(sensed(0, 0, 3, 0.125));
  DepthSource source(playedStream(stream, {.exact = false}), DVec3(4e6, 0, 0));
  CHECK(source.size() == 5);
  CloudFrame frame = frameWith(source, 0.01, [](const CloudFrame& made) { return made.size() == 3; });
  REQUIRE(frame.size() == 3);
  CHECK(frame.positions[1] == Vec3(1.125f, 1, 2));
  CHECK(frame.normals[1] == Vec3(0, 0, -1));
  CHECK(frame.colors[2][0] == 2);
  stream->give(sensed(1, 0.03, 4, 0.25));
  frame = frameWith(source, 0.04, [](const CloudFrame& made) { return made.size() == 4; });
  REQUIRE(frame.size() == 4);
  CHECK(frame.positions[3] == Vec3(3.25f, 1, 2));
  for (const Vec3& velocity : frame.velocities) CHECK(velocity == Vec3(0));
  requireWhole(frame, source.size());
}

TEST_CASE("points of a row sensor move from the previous surface along their rays to where they are observed") {
  // Two rows of two rays observe a plane that is a centimetre nearer in the next frame; the last ray had no point
  // before.
  constexpr DepthCamera kRays{.width = 4, .height = 1};
  const auto seen = [](std::uint64_t number, double time_s, double far, std::uint32_t rowLength) {
    DepthFrame frame{.time_s = time_s, .number = number};
    frame.points = SensedPoints{.rowLength = rowLength};
    for (std::uint32_t ray = 0; ray < 3 + number; ++ray) {
      frame.points->places.emplace_back(far * DVec3(0.1 * ray, 0.2, 1));
      frame.points->normals.emplace_back(0, 0, -1);
      frame.points->rays.push_back(ray);
    }
    return frame;
  };
  const auto normalsOf = [&](const DepthFrame& frame) {
    DepthPoints maker;
    CloudFrame points;
    maker.make(kRays, frame, DVec3(0), points);
    std::vector<Vec3> normals;
    maker.normalsByPixel(points, kRays.width, normals);
    return normals;
  };
  for (const std::uint32_t rowLength : {2u, 4u}) {
    CAPTURE(rowLength);
    const DepthFrame before = seen(0, 0, 1, 2), frame = seen(1, 0.05, 0.99, rowLength);
    CHECK(DepthBlend::canFollow(before, frame) == (rowLength == 2));
    if (rowLength == 4) continue;  // with other rays nothing can be blended
    DepthPoints maker;
    CloudFrame points;
    const std::vector<Vec3> normals = normalsOf(before);
    maker.make(kRays, frame, DVec3(0), points);
    DepthBlend blend;
    blend.follow(kRays, {.frame = before, .normals = normals}, frame, DVec3(0), maker.pixels(),
                 {.between_s = 0.05, .lasts_s = 0.05}, points);
    REQUIRE(points.size() == 4);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(points.positions[i].z == near(1, 1e-6));
      CHECK(points.positions[i].x == within(0.1 * static_cast<double>(i), 1e-6));
      CHECK(points.velocities[i].z == within(-0.2, 1e-5));
    }
    CHECK(points.positions[3].z == near(0.99, 1e-6));
    CHECK(points.velocities[3] == Vec3(0));
  }
  // Speeds above one metre per second are not blended.
  const DepthFrame before = seen(0, 0, 1, 2), leap = seen(1, 0.05, 0.9, 2);
  DepthPoints maker;
  CloudFrame points;
  maker.make(kRays, leap, DVec3(0), points);
  const std::vector<Vec3> normals = normalsOf(before);
  DepthBlend().follow(kRays, {.frame = before, .normals = normals}, leap, DVec3(0), maker.pixels(),
                      {.between_s = 0.05, .lasts_s = 0.05}, points);
  for (const Vec3& velocity : points.velocities) CHECK(velocity == Vec3(0));
  DepthFrame odd = leap;
  odd.points->rays.back() = 4;
  CHECK_THROWS_AS(maker.make(kRays, odd, DVec3(0), points), Error);
  CHECK_FALSE(DepthBlend::canFollow(tinyFrame(0, 0), leap));
  CHECK(DepthBlend::canFollow(tinyFrame(0, 0), tinyFrame(1, 1)));
}

TEST_CASE("a sensor frame with too many points, or without normals, is refused") {
  CloudFrame points;
  CHECK_THROWS_AS(DepthPoints().make(kSensor, sensed(0, 0, 6, 0), DVec3(0), points), Error);
  DepthFrame bare = sensed(0, 0, 3, 0);
  bare.points->normals.pop_back();
  CHECK_THROWS_AS(DepthPoints().make(kSensor, bare, DVec3(0), points), Error);
}

TEST_CASE("the points of a live stream that stops are removed when its frames expire, until the next frame") {
  const auto stream = std::make_shared<Trusted>(kTinyCamera, 3);
  stream->give(tinyFrame(0, 0));
  DepthSource source(playedStream(stream, {.exact = false}));
  const auto hasPoints = [](const CloudFrame& made) { return made.size() > 0; };
  CHECK(frameWith(source, 1, hasPoints).size() == 12);
  CHECK(source.hasNewer(2, 1));  // its points come to rest
  CloudFrame frame;
  source.makeFrame(3.9, frame);
  CHECK(frame.size() == 12);
  CHECK_FALSE(source.hasNewer(3.95, 3.9));
  CHECK(source.hasNewer(4.1, 3.9));
  source.makeFrame(4.1, frame);
  CHECK(frame.size() == 0);
  CHECK(frame.time_s == 4.1);
  CHECK_FALSE(source.hasNewer(9, 4.1));
  stream->give(tinyFrame(1, 9));
  CHECK(frameWith(source, 9.1, hasPoints).size() == 12);
}

TEST_CASE("a live stream whose frames do not expire keeps its last one") {
  const auto stream = std::make_shared<LiveStream>();
  stream->give(tinyFrame(0, 0));
  DepthSource source(playedStream(stream, {.exact = false}));
  CHECK(frameWith(source, 1, [](const CloudFrame& made) { return made.size() > 0; }).size() == 12);
  CloudFrame frame;
  source.makeFrame(1000, frame);
  CHECK(frame.size() == 12);
}

TEST_CASE("a plane that steps starts at its old depth, moves evenly and ends at the observed depth") {
  const DepthCamera camera = smallCamera();
  for (const DVec3& normal : {DVec3(0, 0, 1), glm::normalize(DVec3(0.6, -0.3, 1)), glm::normalize(DVec3(-1.5, 0, 1))})
    for (const double step : {0.001, -0.004, 0.01}) {
      CAPTURE(normal.x);
      CAPTURE(step);
      Blended blended;
      blended.follow(camera, planeFrame(camera, normal, 0.5), planeFrame(camera, normal, 0.5 + step));
      REQUIRE(blended.points.size() > 15'000);
      std::size_t still = 0;
      for (std::size_t i = 0; i < blended.points.size(); ++i) {
        if (blended.points.velocities[i] == Vec3(0)) {
          ++still;  // outside the previous frame
          continue;
        }
        CHECK(std::abs(glm::dot(normal, blended.placeAfter(i, 0)) - 0.5) < 1e-6);
        CHECK(std::abs(glm::dot(normal, blended.placeAfter(i, 1)) - 0.5 - step) < 1e-6);
        CHECK(std::abs(glm::dot(normal, blended.placeAfter(i, 0.5 * kPeriod_s)) - 0.5 - 0.5 * step) < 1e-6);
      }
      CHECK(still < blended.points.size() / 10);
      CHECK_FALSE(blended.points.slides);  // tangentially
    }
}

TEST_CASE("static objects stay at rest while the camera moves, at any origin of the world") {
  const DepthCamera camera = smallCamera();
  for (const DVec3& at : {DVec3(0), DVec3(5000, -3000, 200)}) {
    const DepthScene scene = tableScene(at);
    DepthFrame before = scene.frame(camera, onArc(at, 0.8, 0.3)), frame = scene.frame(camera, onArc(at, 0.8, 0.31));
    Blended blended;
    blended.follow(camera, before, frame, kNever, at);
    std::vector<double> ways;
    for (std::size_t i = 0; i < blended.points.size(); ++i)
      ways.push_back(kPeriod_s * std::abs(glm::dot(blended.points.velocities[i], blended.points.normals[i])));
    CHECK(median(ways) < 2e-6);
    std::ranges::sort(ways);
    CHECK(ways[ways.size() * 98 / 100] < 5e-4);  // except for the rims of the objects on the table
  }
}

TEST_CASE("normals start as observed before, rotate evenly and end as observed now") {
  const DepthCamera camera = smallCamera();
  const DVec3 first = glm::normalize(DVec3(0.3, 0, 1)), second = glm::normalize(DVec3(0.2, 0.2, 1));
  Blended blended;
  blended.follow(camera, planeFrame(camera, first, 0.5), planeFrame(camera, second, 0.5));
  std::size_t turned = 0;
  for (std::size_t i = 0; i < blended.points.size(); ++i) {
    if (blended.points.turns[i] == Vec3(0)) continue;
    ++turned;
    const Vec3 normal = blended.points.normals[i], turn = blended.points.turns[i];
    CHECK(glm::distance(DVec3(normal), -first) < 2e-4);
    CHECK(glm::distance(DVec3(shared::normalAfter(normal, turn, static_cast<float>(kPeriod_s))), -second) < 2e-4);
    const DVec3 halfWay(shared::normalAfter(normal, turn, static_cast<float>(0.5 * kPeriod_s)));
    CHECK(glm::distance(halfWay, glm::normalize(-first - second)) < 2e-4);
  }
  CHECK(turned > blended.points.size() * 9 / 10);
}

TEST_CASE("points of a moving sphere start on the old sphere and end on the new one") {
  const DepthCamera camera = smallCamera();
  const DVec3 from(0, 0, 0), to(0.004, -0.012, 0.003);
  const CameraPose pose = lookingAt({0, -0.6, 0.1}, DVec3(0));
  DepthScene before, after;
  before.add("sphere", 0.12, from);
  after.add("sphere", 0.12, to);
  Blended blended;
  blended.follow(camera, before.frame(camera, pose), after.frame(camera, pose));
  std::vector<double> offBefore, offAfter;
  for (std::size_t i = 0; i < blended.points.size(); ++i) {
    if (blended.points.velocities[i] == Vec3(0)) continue;
    offBefore.push_back(std::abs(glm::distance(blended.placeAfter(i, 0), from) - 0.06));
    offAfter.push_back(std::abs(glm::distance(blended.placeAfter(i, 1), to) - 0.06));
  }
  CHECK(offBefore.size() > blended.points.size() * 9 / 10);
  CHECK(median(offBefore) < 5e-4);  // of a displacement of 13 mm
  std::ranges::sort(offAfter);
  CHECK(offAfter.back() < 1e-5);
}

TEST_CASE("an early frame continues from the position reached so far, and a late one from the end") {
  const DepthCamera camera = smallCamera();
  const DVec3 ahead(0, 0, 1);
  const DepthFrame first = planeFrame(camera, ahead, 0.5), second = planeFrame(camera, ahead, 0.504),
                   third = planeFrame(camera, ahead, 0.506);
  for (const double since_s : {0.25 * kPeriod_s, kPeriod_s, 3 * kPeriod_s}) {
    Blended blended;
    blended.follow(camera, first, second);
    const double reached = 0.5 + 0.004 * std::min(1.0, since_s / kPeriod_s);
    blended.follow(camera, second, third, since_s);
    for (std::size_t i = 0; i < blended.points.size(); i += 97) {
      if (blended.points.velocities[i] == Vec3(0)) continue;
      CHECK(std::abs(blended.placeAfter(i, 0).z - reached) < 1e-6);
      CHECK(std::abs(blended.placeAfter(i, 1).z - 0.506) < 1e-6);
    }
  }
}

TEST_CASE("points not observed before stay at rest: too far away, outside the image or without depth") {
  const DepthCamera camera = smallCamera();
  const DVec3 ahead(0, 0, 1);
  Blended blended;
  const auto isStill = [&] {
    return std::ranges::all_of(blended.points.velocities, [](const Vec3& v) { return v == Vec3(0); });
  };
  blended.follow(camera, planeFrame(camera, ahead, 0.5), planeFrame(camera, ahead, 0.6));
  CHECK(isStill());
  CHECK(std::abs(blended.points.positions[0].z - 0.6f) < 1e-6f);
  DepthFrame nothing = planeFrame(camera, ahead, 0.5);
  for (const float depth :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::ranges::fill(nothing.depth_m, depth);
    blended.follow(camera, nothing, planeFrame(camera, ahead, 0.5));
    CHECK(isStill());
  }
  DepthFrame aside = planeFrame(camera, ahead, 0.5);
  aside.pose = CameraPose{.centre = {10, 0, 0}};
  blended.follow(camera, aside, planeFrame(camera, ahead, 0.5));
  CHECK(isStill());
  aside.pose = CameraPose{.centre = {0, 0, 10}};  // the camera looked elsewhere
  blended.follow(camera, aside, planeFrame(camera, ahead, 0.5));
  CHECK(isStill());
}

TEST_CASE("the first frame does not move") {
  const DepthCamera camera = smallCamera();
  CloudFrame points;
  points.extrapolationLimit_s = 7;
  points.velocities.resize(3);
  DepthBlend blend;
  DepthPoints().make(camera, planeFrame(camera, {0, 0, 1}, 0.5), DVec3(0), points);
  blend.begin(points);
  CHECK(points.velocities.empty());
  CHECK(points.extrapolationLimit_s == kMaxPointsAge_s);
}

}  // namespace palpate::depth_source_test
