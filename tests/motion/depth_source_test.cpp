// Frames of a depth stream as points: of a sensor that sends points, and of a stream that stops.
#include "engine/motion/depth_source.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "engine/core/clock.hpp"
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

}  // namespace palpate::depth_source_test
