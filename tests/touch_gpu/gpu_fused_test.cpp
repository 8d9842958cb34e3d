// Depth frames that are fused while they are felt, on the GPU.
#include "engine/core/clock.hpp"
#include "engine/motion/fused_source.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/touch/fused_scene.hpp"

namespace palpate::gpu_fused_test {

namespace {

constexpr double kRadius = 0.008;

std::unique_ptr<TouchSide> fusedTouch(Device& device, const FusedStream& frames, double radius = kRadius) {
  return std::make_unique<TouchSide>(device, *frames.begin, TouchOptions{.radius = radius, .fusion = frames});
}

PointCloud pointsOf(TouchSide& touch, const FusedStream& frames) {
  PointCloud cloud = *frames.begin;
  touch.finish();
  touch.readBack(cloud);
  return cloud;
}

/// Above the map, where nothing is touched.
Pose awayAt(double time_s) { return {.time_s = time_s, .hip = {0, 0, 0.5}}; }

}  // namespace

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "depth frames are felt while they are fused on the GPU, and removed objects are no longer felt") {
  checkFusedTouch(
      [this](TableStream& stream, double radius) {
        return FusedTouch{.backend = fusedTouch(device, stream.fused(smallMap(60'000)), radius), .source = nullptr};
      },
      2e-3);
}

TEST_CASE_FIXTURE(GpuFixture, "a map fused on the host is felt on the GPU as on the host") {
  TableStream first, second;
  const FusedStream onHost = first.fused(smallMap(60'000)), onGpu = second.fused(smallMap(60'000));
  FusedSource source(onHost);
  TouchSide host(device, *onHost.begin, {.radius = kRadius, .source = &source});
  const auto fused = fusedTouch(device, onGpu);
  for (int i = 0; i < 300; i += 3) {
    const Pose pose{.time_s = 1e-3 * i, .hip = {0.002 * std::sin(0.05 * i), 0, std::max(0.09 - 0.0005 * i, 0.079)}};
    const Contact a = host.query(pose, 0), b = fused->query(pose, 0);
    CHECK(a.touching == b.touching);
    CHECK(glm::distance(a.proxy, b.proxy) < 1e-5);
  }
  CHECK(onGpu.stream->player->counts().played == onHost.stream->player->counts().played);
}

TEST_CASE_FIXTURE(GpuFixture, "the map on the GPU restarts when time goes back, the same bit by bit, full or not") {
  TableStream stream, again;
  FusedStream frames = stream.fused(smallMap(40'000)), straight = again.fused(smallMap(40'000));
  struct Lines final : LogListener {
    std::vector<std::string> all;
    void said(std::string_view line) override { all.emplace_back(line); }
    void progressed(std::string_view, double) override {}
  } lines;
  Log log(true);
  log.listen(&lines);
  frames.log = &log;
  // The second frame does not fit.
  for (FusedStream* each : {&frames, &straight}) each->options.capacity = each->begin->size() + 10;
  const auto touch = fusedTouch(device, frames), other = fusedTouch(device, straight);
  for (const double time_s : {0.1, 0.2, 0.05}) touch->query(awayAt(time_s), 0);
  other->query(awayAt(0.05), 0);
  const PointCloud a = pointsOf(*touch, frames), b = pointsOf(*other, straight);
  CHECK(a.positions == b.positions);
  CHECK(a.normals == b.normals);
  CHECK(a.colors == b.colors);
  CHECK(lines.all ==
        std::vector{fmt::format("the map is full: {} points; new points are not added", frames.options.capacity)});
  touch->query(awayAt(0), 0);
  CHECK(pointsOf(*touch, frames).positions == frames.begin->positions);
}

TEST_CASE_FIXTURE(GpuFixture, "frames without poses are placed on the GPU, also after a pause and with the next map") {
  TableStream stream(false);
  FusedStream frames = stream.fused(smallMap(40'000));
  auto touch = fusedTouch(device, frames);
  touch->query(awayAt(0.11), 0);  // up to the third frame
  const DVec3 target(0, 0, 0.02);
  const auto errorOf = [&](const FusedStream& played, int frame) {
    return glm::distance(played.stream->seenFrom->centre, onArc(target, 0.8, 0.03 * frame).centre);
  };
  CHECK(frames.stream->player->counts().played == 4);
  CHECK(frames.stream->player->counts().lost == 0);
  CHECK(errorOf(frames, 3) < 0.004);
  frames.stream->player->pause(0.11);
  touch->query(awayAt(0.5), 0);
  const auto map = std::make_shared<PointCloud>(pointsOf(*touch, frames));
  FusedStream next{.stream = std::make_shared<PlayedStream>(std::exchange(*frames.stream, {})),
                   .begin = map,
                   .options = smallMap(40'000)};
  next.stream->player->beginHere();
  touch->query(awayAt(1), 0);  // its stream was moved away: the map stays
  CHECK(pointsOf(*touch, frames).positions == map->positions);
  touch.reset();
  touch = fusedTouch(device, next);
  CHECK(pointsOf(*touch, next).positions == map->positions);
  next.stream->player->play(0);
  // In real time, on a thread of its own: frames need their time, however fast the answers are.
  constexpr double kLong_s = 60;
  const Stopwatch watch;
  while (next.stream->player->counts().played < 6 && watch.elapsed_us() < 1e6 * kLong_s)
    touch->query(awayAt(0.06), 500);
  CHECK(next.stream->player->counts().played == 6);
  CHECK(pointsOf(*touch, next).size() > 10'000);
  CHECK(next.stream->player->counts().lost == 0);
  CHECK(errorOf(next, 5) < 0.004);
}

}  // namespace palpate::gpu_fused_test
