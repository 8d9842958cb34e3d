// Hands so deep in a soft body that the points around them no longer define its surface. Needs no GPU.
#include <string>

#include "tests/labels.hpp"
#include "tests/matter/soft_on_cpu.hpp"
#include "tests/near.hpp"

namespace palpate::soft_hold_test {

namespace {

// A cube of 40 mm into which a hand descends vertically from above.
struct Press {
  double young_Pa = 2e4, spacing_mm = 5;
  double depth_mm = 15, speed_mm_s = 20;
  double friction = 0;
  int plate = 0;  // points along a side of a plate of 10 mm; 0: the hand itself
  int hands = 1;  // two hands are 8 mm from the centre each
  int hold_ms = 200;
};

struct Pressed {
  double most_N = 0;
  double fell_N = 0;    // largest drop in a tick; no hand moves up
  double rose_N = 0;    // largest rise in a tick beyond the increase by the hand's motion
  int ticksWithin = 0;  // ticks without a force after the first force
  SurfaceHolds holds;
  std::string failure;
};

constexpr double kStiffness_N_mm = 0.5, kMax_N = 5;

// The spring's force alone, independent of velocity.
double forceOf(SoftTouch& touch, std::span<const Contact> answers, const Pose& pose) {
  DVec3 sum(0);
  if (touch.points(0).empty() && answers[0].touching) sum = kStiffness_N_mm * (answers[0].proxy - pose.hip);
  for (const PointContact& point : touch.points(0))
    if (point.contact.touching) sum += point.share * kStiffness_N_mm * (point.contact.proxy - point.hip);
  return std::min(kMax_N, glm::length(sum));
}

Pressed pressed(const Press& press) {
  MatterScene scene = bareBlock();
  scene.fill_mm = {40, 40, 40};
  scene.young_Pa = press.young_Pa;
  scene.spacing_mm = press.spacing_mm;
  SoftTouching options;
  options.threads = 1;
  options.spring = {.stiffness_N_per_unit = kStiffness_N_mm, .damping_N_s_per_unit = 0.002, .most_N = kMax_N};
  options.touch.friction = press.friction;
  if (press.plate > 0) options.touch.tools = {flatPlate(press.plate, 10)};
  options.touch.tools.resize(static_cast<std::size_t>(press.hands));
  SoftScene block(scene, options, feltOnCpu);
  Pressed result;
  double before_N = 0, before_mm = -1;
  const double down_ms = 1e3 * (press.depth_mm + 1) / press.speed_mm_s;
  for (int k = 0; k < 100 + static_cast<int>(down_ms) + press.hold_ms; ++k) {
    const double depth = k < 100 ? -1 : std::min(press.depth_mm, -1 + press.speed_mm_s * 1e-3 * (k - 100));
    const Pose pose{.time_s = 1e-3 * k, .hip = {50, 40 - depth, 50}};
    std::vector<Pose> poses(static_cast<std::size_t>(press.hands), pose);
    if (press.hands == 2) poses[0].hip.x -= 8, poses[1].hip.x += 8;
    const auto answers = block.touch().query(poses, 0);
    const double force_N = forceOf(block.touch(), answers, poses[0]);
    result.most_N = std::max(result.most_N, force_N);
    result.fell_N = std::max(result.fell_N, before_N - force_N);
    result.rose_N = std::max(result.rose_N, force_N - before_N - kStiffness_N_mm * (depth - before_mm));
    if (result.most_N > 0.1 && force_N == 0) ++result.ticksWithin;
    before_N = force_N;
    before_mm = depth;
  }
  result.holds = block.source().surfaceHolds();
  result.failure = block.touch().simulation()->failure();
  return result;
}

// Checks that the force has no steps.
void checkEven(const Pressed& result, double within_N) {
  CHECK(result.failure.empty());
  CHECK(result.ticksWithin == 0);
  CHECK(result.fell_N < within_N);
  CHECK(result.rose_N < within_N);
}

}  // namespace

TEST_CASE("a soft cube holds a hand that presses deep into it all the way, without a force step") {
  const Pressed result = pressed({.depth_mm = 30, .speed_mm_s = 100, .hold_ms = 60});
  checkEven(result, 0.1);
  CHECK(result.most_N > 2.5);
  CHECK(result.holds.keptTicks > 50);
  // While the points define the surface, no other surface holds the hand.
  const Pressed flat = pressed({.depth_mm = 8, .speed_mm_s = 100, .hold_ms = 20});
  checkEven(flat, 0.1);
  CHECK(flat.holds.keptTicks == 0);
}

TEST_CASE("soft cubes hold hands and tools at all speeds, or yield evenly and report it" * kFull) {
  int letIn = 0;
  for (const double young_Pa : {2e4, 2e3})
    for (const double friction : {0.0, 0.5})
      for (const double speed_mm_s : {20.0, 100.0, 500.0})
        for (const double depth_mm : {15.0, 30.0})
          for (const Press& hands : {Press{}, Press{.spacing_mm = 4}, Press{.plate = 3}, Press{.hands = 2}}) {
            Press press = hands;
            press.young_Pa = young_Pa;
            press.friction = friction;
            press.speed_mm_s = speed_mm_s;
            press.depth_mm = depth_mm;
            const Pressed result = pressed(press);
            MESSAGE(young_Pa << " Pa, friction " << friction << ", " << speed_mm_s << " mm/s to " << depth_mm
                             << " mm, spacing " << press.spacing_mm << ", plate " << press.plate << ", hands "
                             << press.hands << ": most " << result.most_N << " N, fell " << result.fell_N << ", rose "
                             << result.rose_N << ", ticks within " << result.ticksWithin << ", kept "
                             << result.holds.keptTicks << ", gave way " << result.holds.gaveWayTicks);
            CHECK(result.failure.empty());
            CHECK(result.fell_N < 0.13);
            CHECK(result.rose_N < 0.13);
            // A hand enters only where the body is reported to yield.
            if (result.holds.gaveWayTicks == 0) CHECK(result.ticksWithin == 0);
            letIn += result.ticksWithin > 0;
          }
  CHECK(letIn <= 8);
}

}  // namespace palpate::soft_hold_test
