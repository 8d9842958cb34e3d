#include "engine/cuda/push_edit.hpp"

#include <bit>
#include <random>

#include "engine/cuda/live_copy.hpp"
#include "engine/edit/cpu_sculpture.hpp"
#include "engine/edit/spacing_measure.hpp"
#include "engine/io/ply_reader.hpp"
#include "shaders/shared/plane_fit.h"
#include "tests/cuda/cuda_fixture.hpp"
#include "tests/edit/tool_at.hpp"
#include "tests/shared_files.hpp"

namespace palpate::push_edit_test {

namespace {

struct Moved {
  std::vector<Vec4> positions, normals;  // in id order
};

/// A cloud on the GPU, pushed edit by edit.
class Pushed {
 public:
  Pushed(const PointCloud& cloud, const BrushOptions& options, double radius)
      : live_(cloud, stream_),
        build_(makeHashGrid(Vec3(0), radius, cloud.size()), live_.count()),
        edit_(sharedBrush(options, radius), radius, spacingsOf(cloud, radius), stream_) {}

  /// Push, rebuild, normals and look ahead.
  void edit(const BrushStroke::Tool& tool) {
    cu::CloudHalf &from = live_.half(live_.parity()), &to = live_.half(1 - live_.parity());
    edit_.setTool(placedTool(tool));
    edit_.recordPush(stream_, from, live_.count());
    build_.record(stream_, from, to, live_.count());
    edit_.recordSequel(stream_, build_.view(to, live_.count()));
    stream_.synchronize("editing");
    live_.flip();
  }
  Moved points() {
    Moved moved{std::vector<Vec4>(live_.count()), std::vector<Vec4>(live_.count())};
    const auto positions = live_.half(live_.parity()).positions.download(stream_);
    const auto normals = live_.half(live_.parity()).normals.download(stream_);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const auto id = std::bit_cast<std::uint32_t>(positions[i].w);
      REQUIRE(id < positions.size());
      moved.positions[id] = positions[i];
      moved.normals[id] = normals[i];
    }
    return moved;
  }

 private:
  static std::vector<float> spacingsOf(const PointCloud& cloud, double radius) {
    SortedGrid grid(makeHashGrid(Vec3(0), radius, cloud.size()), 1);
    grid.build(cloud.positions);
    return measuredSpacings(grid, cloud.positions, cloud.normals, radius, std::vector<float>(cloud.size()));
  }

  cu::Stream stream_;
  cu::LiveCopy live_;
  cu::CubBuild build_;
  cu::PushEdit edit_;
};

// One edited tick for a given contact state.
Moved push(const PointCloud& cloud, const DVec3& hip, const DVec3& spring, const BrushOptions& options, double radius) {
  Pushed pushed(cloud, options, radius);
  pushed.edit(toolAt(options, radius, hip, spring));
  return pushed.points();
}

bool movedAt(const Moved& moved, const PointCloud& cloud, std::size_t i) {
  return Vec3(moved.positions[i]) != cloud.positions[i];
}

/// A hand that is pressed into a surface at `from`, `depth` deep in the end, and dragged along it.
struct Stroke {
  DVec3 from, drag, outward;
  double depth = 0;
};

/// The same strokes in the same edits on the GPU and in double precision on the CPU.
class OnBoth {
 public:
  OnBoth(const PointCloud& cloud, const BrushOptions& options, double radius)
      : before_(cloud),
        options_(options),
        radius_(radius),
        gpu_(cloud, options, radius),
        cpu_(cloud, makeHashGrid(Vec3(0), radius, cloud.size()), {.radius = radius, .threads = 1}),
        stroke_(radius) {
    stroke_.setBrush(options);
  }

  void push(const Stroke& stroke) {
    constexpr int kTicks = 160, kPressed = 80;
    for (int tick = 1; tick <= kTicks; ++tick, time_s_ += 1e-3) {
      const double pressed = std::min(1.0, double(tick) / kPressed);
      const double dragged = std::max(0.0, double(tick - kPressed) / kPressed);
      const DVec3 spring = pressed * stroke.depth * stroke.outward;
      stroke_.feel({.touching = true}, stroke.from + dragged * stroke.drag - spring, spring, Press::contact, time_s_);
      if (!stroke_.acts()) continue;
      const BrushStroke::Tool& tool = stroke_.next(time_s_);
      cpu_.edit({options_, radius_, tool});
      gpu_.edit(tool);
      stroke_.note(cpu_.measure());
      CHECK(cpu_.settled());
    }
    stroke_.end();
    time_s_ += 1;
  }

  // A point keeps the normal of its last move, however short, while its neighbours go on: the last bit decides whether
  // it moves by a last bit.
  static constexpr double kTurned_deg = 5;
  /// Numbers of points: that the CPU has moved; whose positions on the GPU are farther apart than `apart`; and whose
  /// normals are by kTurned_deg.
  struct Compared {
    std::size_t moved = 0, apart = 0, turned = 0;
  };
  Compared compared(double apart) {
    after = gpu_.points();
    Compared compared;
    for (std::size_t i = 0; i < before_.size(); ++i) {
      const Vec3 &position = cpu_.points().positions[i], &normal = cpu_.points().normals[i];
      compared.moved += position != before_.positions[i];
      compared.apart += glm::distance(position, Vec3(after.positions[i])) > apart;
      compared.turned += angleBetween_deg(DVec3(normal), DVec3(Vec3(after.normals[i]))) > kTurned_deg;
    }
    return compared;
  }
  Moved after;  // on the GPU

 private:
  const PointCloud& before_;
  BrushOptions options_;
  double radius_, time_s_ = 0;
  Pushed gpu_;
  CpuSculpture cpu_;
  BrushStroke stroke_;
};

constexpr double kSpacing = 0.5, kBrush = 6;

/// Two parallel sides of 32 x 20: the points of the upper one come first, and the lower one ends at `lowerEnd` along x.
/// Uneven, so that no decision hangs on a last bit.
PointCloud plate(double thickness, double lowerEnd = 16) {
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.1 * kSpacing, 0.1 * kSpacing);
  for (const double side : {1.0, -1.0})
    for (double y = -10; y <= 10; y += kSpacing)
      for (double x = -16; x <= (side > 0 ? 16 : lowerEnd); x += kSpacing) {
        cloud.positions.emplace_back(x + jitter(random), y + jitter(random), 0.5 * side * thickness);
        cloud.normals.emplace_back(0, 0, side);
      }
  return cloud;
}

/// What a push has done to a plate.
struct Sides {
  std::size_t deep = 0, passed = 0, farChanged = 0;  // points
};
template <class Position, class Normal>
Sides sidesOf(const PointCloud& plate, double thickness, const Position& position, const Normal& normal) {
  Sides sides;
  for (std::size_t i = 0; i < plate.size(); ++i) {
    const bool isNear = plate.normals[i].z > 0;
    const float sunk = plate.positions[i].z - position(i).z;
    sides.deep += isNear && sunk > 0.4 * kSpacing;
    sides.passed += isNear && sunk > thickness - 0.5 * kSpacing;
    sides.farChanged += !isNear && (position(i) != plate.positions[i] || normal(i) != plate.normals[i]);
  }
  return sides;
}

}  // namespace

TEST_CASE("a CUDA push into plates gives what the CPU gives, and moves no side through the other one") {
  NEEDS_CUDA_DEVICE();
  constexpr double kDepth = 2.5, kThin = 0.4 * kDepth;
  struct Plate {
    double thickness, lowerEnd;
  };
  // The upper side of the last one has nothing below it in a part of the brush, and is held up by its neighbours.
  for (const auto [thickness, lowerEnd] : {Plate{4 * kDepth, 16}, Plate{kThin, 16}, Plate{kThin, 0}}) {
    CAPTURE(thickness);
    CAPTURE(lowerEnd);
    const PointCloud cloud = plate(thickness, lowerEnd);
    OnBoth both(cloud, {.yieldDepth = 0.25, .pushRate = 0.1, .radius = kBrush, .resample = false}, 4 * kSpacing);
    both.push({.from = {-4, 0, 0.5 * thickness}, .drag = {4, 4, 0}, .outward = {0, 0, 1}, .depth = kDepth});
    const OnBoth::Compared compared = both.compared(1e-3 * kSpacing);
    CHECK(compared.moved > 300);
    CHECK(compared.apart == 0);
    CHECK(compared.turned == 0);
    const Sides sides = sidesOf(
        cloud, thickness, [&](std::size_t i) { return Vec3(both.after.positions[i]); },
        [&](std::size_t i) { return Vec3(both.after.normals[i]); });
    CHECK(sides.deep > 100);
    if (lowerEnd == 16) CHECK(sides.passed == 0);
    CHECK(sides.farChanged == 0);
  }
}

TEST_CASE("a CUDA push into a scan gives what the CPU gives") {
  NEEDS_CUDA_DEVICE();
  const std::filesystem::path file = sharedFile("bunny_34834.ply");
  if (file.empty()) return;
  const PointCloud cloud = readPly(file);
  const double spacing = meanSpacing(cloud);
  OnBoth both(cloud, {.yieldDepth = 0.5 * spacing, .pushRate = 0.1, .radius = 12 * spacing, .resample = false},
              4 * spacing);
  for (const std::size_t at : {500, 9'500, 18'500, 27'500, 33'500}) {
    const DVec3 outward(glm::normalize(DVec3(cloud.normals[at])));
    both.push({.from = DVec3(cloud.positions[at]),
               .drag = 16 * spacing * shared::besides(outward),
               .outward = outward,
               .depth = 6 * spacing});
  }
  const OnBoth::Compared compared = both.compared(0.01 * spacing);
  CHECK(compared.moved > 1000);
  CHECK(compared.apart <= compared.moved / 500);
  CHECK(compared.turned <= compared.moved / 100);
}

TEST_CASE("a hand that sculpts with CUDA leaves the far side of a thin plate") {
  NEEDS_CUDA_DEVICE();
  constexpr double kThickness = 1, kDepth = 2.5;
  const PointCloud cloud = plate(kThickness);
  CudaTouchOptions options = cudaOptions(cloud, 4 * kSpacing, CudaMethod::fused);
  options.push = BrushOptions{.yieldDepth = 0.25, .pushRate = 0.1, .radius = kBrush, .resample = false};
  CudaTouch touch(cloud, options);
  std::vector<DVec3> path;
  for (int tick = 0; tick < 200; ++tick)
    path.emplace_back(std::max(0.0, 0.05 * (tick - 100)) - 3, 0, std::max(0.5 * kThickness - kDepth, 2 - 0.05 * tick));
  answersTo(touch, path);
  PointCloud after = cloud;
  CHECK(touch.readBack(after) > 100);
  const Sides sides = sidesOf(
      cloud, kThickness, [&](std::size_t i) { return after.positions[i]; },
      [&](std::size_t i) { return after.normals[i]; });
  CHECK(sides.deep > 100);
  CHECK(sides.passed == 0);
  CHECK(sides.farChanged == 0);
}

TEST_CASE("a CUDA push moves points in range as the reference does and leaves the others bit by bit") {
  NEEDS_CUDA_DEVICE();
  const Scene scene = makeScene("sphere", 20'000);
  const DVec3 outward = glm::normalize(DVec3(1, 2, 2));
  for (const BrushOptions& options : {BrushOptions{.yieldDepth = 0.5, .pushRate = 0.1, .radius = 6},
                                      BrushOptions{.yieldDepth = 0, .pushRate = 1, .radius = 12}}) {
    const DVec3 hip = 47.0 * outward, spring = 3.0 * outward;
    const Moved moved = push(scene.cloud, hip, spring, options, scene.radius);
    const PlacedBrush brush = brushAt(options, scene.radius, hip, spring);
    const double firstStep = double{shared::kFirstStep} * scene.radius;
    std::size_t inRange = 0, wrong = 0, marked = 0, disturbed = 0;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i) {
      const DVec3 before(scene.cloud.positions[i]), normal(scene.cloud.normals[i]);
      const DVec3 expected = brush.brushed(before, normal, {before, normal, firstStep}).position;
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
