#include "engine/cuda/push_edit.hpp"

#include <bit>

#include "engine/cuda/live_copy.hpp"
#include "engine/edit/normal_fit.hpp"
#include "engine/edit/placed_brush.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "tests/cuda/cuda_fixture.hpp"
#include "tests/edit/tool_at.hpp"

namespace palpate::push_edit_test {

namespace {

struct Moved {
  std::vector<Vec4> positions, normals;  // in id order
};

// One edited tick (push, rebuild, refit) for a given contact state.
Moved push(const PointCloud& cloud, const DVec3& hip, const DVec3& spring, const BrushOptions& options, double radius) {
  const cu::Stream stream;
  cu::LiveCopy live(cloud, stream);
  cu::CubBuild build(makeHashGrid(Vec3(0), radius, cloud.size()), live.count());
  cu::PushEdit edit(sharedBrush(options, radius), radius, stream, live.count());
  edit.setTool(placedTool(toolAt(options, radius, hip, spring)));
  edit.recordPush(stream, live.half(0), live.count());
  build.record(stream, live.half(0), live.half(1), live.count());
  edit.recordRefit(stream, build.view(live.half(1), live.count()));
  Moved moved{std::vector<Vec4>(cloud.size()), std::vector<Vec4>(cloud.size())};
  const auto positions = live.half(1).positions.download(stream);
  const auto normals = live.half(1).normals.download(stream);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto id = std::bit_cast<std::uint32_t>(positions[i].w);
    REQUIRE(id < cloud.size());
    moved.positions[id] = positions[i];
    moved.normals[id] = normals[i];
  }
  return moved;
}

bool movedAt(const Moved& moved, const PointCloud& cloud, std::size_t i) {
  return Vec3(moved.positions[i]) != cloud.positions[i];
}

}  // namespace

TEST_CASE("a CUDA push moves points in range as the reference does and leaves the others bit by bit") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const DVec3 outward = glm::normalize(DVec3(1, 2, 2));
  for (const BrushOptions options : {BrushOptions{.yieldDepth = 0.5, .pushRate = 0.1, .radius = 6},
                                     BrushOptions{.yieldDepth = 0, .pushRate = 1, .radius = 12}}) {
    const DVec3 hip = 47.0 * outward, spring = 3.0 * outward;
    const Moved moved = push(scene.cloud, hip, spring, options, scene.radius);
    const PlacedBrush brush = brushAt(options, scene.radius, hip, spring);
    std::size_t inRange = 0, wrong = 0, marked = 0, disturbed = 0;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
      const DVec3 before(scene.cloud.positions[i]), normal(scene.cloud.normals[i]);
      const DVec3 expected = brush.brushed(before, normal, {before, normal, double{shared::kUnseen}}).position;
      inRange += expected != before;
      wrong += glm::distance(DVec3(moved.positions[i]), expected) > 1e-4;
      marked += moved.normals[i].w != 0;
      // A point within rounding of the brush's border may be marked and refitted without having moved.
      const bool clearlyOutside = glm::distance(before, brush.center()) > brush.radius() + 1e-3;
      disturbed +=
          clearlyOutside && (movedAt(moved, scene.cloud, i) || Vec3(moved.normals[i]) != scene.cloud.normals[i]);
    }
    CHECK(inRange > 40);
    CHECK(wrong == 0);
    CHECK(marked == 0);
    CHECK(disturbed == 0);
  }
}

TEST_CASE("after a CUDA push, moved points have the normals of the new shape, on their old side") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const DVec3 outward(0, 0, 1);
  const Moved moved =
      push(scene.cloud, 46.0 * outward, 4.0 * outward, {.yieldDepth = 0.1, .pushRate = 1, .radius = 12}, scene.radius);
  std::vector<Vec3> positions;
  for (const Vec4& position : moved.positions) positions.emplace_back(position);
  SortedGrid grid(makeHashGrid(Vec3(0), scene.radius, positions.size()), 1);
  grid.build(positions);
  double worst_deg = 0;
  std::size_t count = 0, clear = 0, turned = 0, notUnit = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!movedAt(moved, scene.cloud, i)) continue;
    ++count;
    const DVec3 old(scene.cloud.normals[i]), normal{Vec3(moved.normals[i])};
    NormalFit fit(scene.radius);
    const DVec3 center(positions[i]);
    grid.forEachNear(center, scene.radius,
                     [&](const SortedGrid::Placed& point) { fit.add(DVec3(point.position) - center); });
    const NormalFit::Result expected = fit.normal(old);
    turned += glm::dot(normal, old) < -1e-5;
    notUnit += std::abs(glm::length(normal) - 1) > 1e-5;
    if (expected.flatness < 0.5 && glm::dot(expected.normal, old) > 0.01) {
      ++clear;
      worst_deg = std::max(worst_deg, angleBetween_deg(normal, expected.normal));
    }
  }
  CHECK(count > 100);
  CHECK(clear > count * 3 / 4);
  CHECK(turned == 0);
  CHECK(notUnit == 0);
  CHECK(worst_deg < 0.1);
}

TEST_CASE("a CUDA push with a spring no longer than the yield depth moves no point") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("plane", 5'000);
  const Moved moved = push(scene.cloud, DVec3(0, 0, -0.5), DVec3(0, 0, 0.5),
                           {.yieldDepth = 0.5, .pushRate = 0.5, .radius = 5}, scene.radius);
  std::size_t count = 0;
  for (std::size_t i = 0; i < scene.cloud.size(); ++i) count += movedAt(moved, scene.cloud, i);
  CHECK(count == 0);
}

TEST_CASE("after a CUDA push, coincident and collinear points keep unit normals") {
  NEEDS_CUDA_DEVICE();
  PointCloud cloud = pointsInOnePlace(3000, Vec3(0));
  for (int i = 0; i < 1000; ++i) cloud.positions.push_back(Vec3(0.01f * static_cast<float>(i) - 5, 0, 0));
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  const Moved moved =
      push(cloud, DVec3(0, 0, -1), DVec3(0, 0, 1), {.yieldDepth = 0.1, .pushRate = 0.5, .radius = 3}, 0.5);
  std::size_t wrong = 0;
  for (const Vec4& normal : moved.normals)
    wrong += !isFinite(normal) || std::abs(glm::length(Vec3(normal)) - 1) > 1e-5f;
  CHECK(wrong == 0);
}

TEST_CASE("a CUDA push handles empty and tiny clouds, and moves every point at once") {
  NEEDS_CUDA_DEVICE();
  for (const std::size_t count : {0, 1, 2, 4'097}) {
    CAPTURE(count);
    const PointCloud cloud = pointsInOnePlace(count, Vec3(0, 0, 50));
    const Moved moved =
        push(cloud, DVec3(0, 0, -100), DVec3(0, 0, 150), {.yieldDepth = 1, .pushRate = 0.01, .radius = 1000}, 1);
    std::size_t moves = 0;
    for (std::size_t i = 0; i < count; ++i) moves += movedAt(moved, cloud, i);
    CHECK(moves == count);
  }
}

TEST_CASE("sculpting with CUDA gives the same cloud, bit by bit, with every bucket-based method") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 50'000);
  std::vector<DVec3> path;
  for (int tick = 0; tick < 400; ++tick) {
    const double angle = 0.002 * tick, depth = std::min(0.02 * tick, 3.0);
    path.push_back((51.0 - depth) * DVec3(std::sin(angle), 0, std::cos(angle)));
  }
  std::optional<PointCloud> expected;
  for (const CudaMethod method : allCudaMethods()) {
    if (method == CudaMethod::brute) continue;
    CAPTURE(nameOf(method));
    CudaTouchOptions options = cudaOptions(scene.cloud, scene.radius, method);
    options.push = BrushOptions{.yieldDepth = 0.5, .pushRate = 0.1, .radius = 6};
    CudaTouch touch(scene.cloud, options);
    const auto answers = answersTo(touch, path);
    CHECK(answers.back().touching);
    CHECK(touch.report().firstEdit_s.value_or(1) < 0.4);
    CHECK(touch.report().editTimes_us.size() > 100);
    for (const double time_us : touch.report().editTimes_us) CHECK(time_us > 0);
    PointCloud sculpted = scene.cloud;
    CHECK(touch.readBack(sculpted) > 100);
    if (!expected) expected = sculpted;
    CHECK(sculpted.positions == expected->positions);
    CHECK(sculpted.normals == expected->normals);
  }
}

}  // namespace palpate::push_edit_test
