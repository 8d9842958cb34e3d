// What a push does to thin and folded parts, judged point by point: the side that it does not touch stays in its place,
// and the pressed one stops before it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "engine/cloud/point_tree.hpp"
#include "engine/touch/blocked_count.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "tests/near.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::thin_parts_test {

namespace {

constexpr double kSpacing = 0.5, kSupport = 4 * kSpacing, kBrush = 6, kTau = 0.25;

/// A sheet of this thickness whose middle is at height(x), with a rim at either end along x: first its upper points,
/// then its lower ones, then those of the rims.
struct Sheet {
  PointCloud cloud;
  std::size_t eachSide = 0;
};
template <class Height>
Sheet makeSheet(double length, double width, double thickness, Height&& height) {
  Sheet sheet;
  PointCloud lower;
  const auto normalAt = [&](double x) { return glm::normalize(DVec3(height(x - 1e-4) - height(x + 1e-4), 0, 2e-4)); };
  const auto add = [](PointCloud& cloud, const DVec3& place, const DVec3& normal) {
    cloud.positions.emplace_back(place);
    cloud.normals.emplace_back(normal);
  };
  for (double y = -0.5 * width; y <= 0.5 * width; y += kSpacing) {
    for (double x = -0.5 * length; x <= 0.5 * length; x += kSpacing * normalAt(x).z) {
      const DVec3 normal = normalAt(x), middle(x, y, height(x));
      add(sheet.cloud, middle + 0.5 * thickness * normal, normal);
      add(lower, middle - 0.5 * thickness * normal, -normal);
    }
    for (const double end : {-0.5, 0.5}) {
      const DVec3 middle(end * length, y, height(end * length)), up = normalAt(middle.x);
      const DVec3 out = glm::cross(up, DVec3(0, end < 0 ? -1 : 1, 0)) * -1.0;
      const int steps = std::max(1, static_cast<int>(0.5 * std::numbers::pi * thickness / kSpacing));
      for (int k = 0; k < steps; ++k) {
        const double angle = std::numbers::pi * ((k + 0.5) / steps - 0.5);
        const DVec3 normal = std::sin(angle) * up + std::cos(angle) * out;
        add(lower, middle + 0.5 * thickness * normal, normal);
      }
    }
  }
  sheet.eachSide = sheet.cloud.size();
  for (const Vec3& place : lower.positions) sheet.cloud.positions.push_back(place);
  for (const Vec3& normal : lower.normals) sheet.cloud.normals.push_back(normal);
  return sheet;
}

/// The points of a sheet after a push: pressed at `from`, dragged to `to` at 100 mm/s, lifted straight up.
PointCloud pushed(TouchBackend& touch, const Sheet& sheet, const DVec3& from, const DVec3& to) {
  double time_s = 0;
  const auto go = [&](const DVec3& a, const DVec3& b, double speed) {
    const int ticks = std::max(1, static_cast<int>(glm::distance(a, b) / speed * 1000));
    for (int k = 0; k < ticks; ++k, time_s += 1e-3)
      touch.query({.time_s = time_s, .hip = a + (b - a) * (double(k) / ticks)}, 0);
  };
  const DVec3 up(0, 0, 8);
  go(from + up, from, 100);
  go(from, to, 100);
  go(to, to + up, 100);
  touch.finish();
  PointCloud after = sheet.cloud;
  CHECK(touch.readBack(after) > 50);
  return after;
}

struct Judged {
  std::size_t moved = 0, through = 0;
  double median = 0, highest = 0;  // of the moved points: distance from the lower side; height over the upper one
};
/// `lower(x)`, `upper(x)`: heights of the sides. A point is through if it faces up and is below the lower one.
template <class Lower, class Upper>
Judged judge(const Sheet& sheet, const PointCloud& after, Lower&& lower, Upper&& upper) {
  Judged judged;
  judged.highest = -std::numeric_limits<double>::infinity();
  const PointTree before(sheet.cloud.positions);
  std::vector<double> left;
  std::vector<std::uint32_t> same;
  for (std::size_t i = 0; i < after.size(); ++i) {
    same.clear();
    before.near(DVec3(after.positions[i]), 1e-6, same);
    if (!same.empty()) continue;
    const double x = after.positions[i].x, z = after.positions[i].z;
    ++judged.moved;
    judged.through += after.normals[i].z > 0.3f && z < lower(x);
    judged.highest = std::max(judged.highest, z - upper(x));
    left.push_back(z - lower(x));
  }
  std::ranges::sort(left);
  if (!left.empty()) judged.median = left[left.size() / 2];
  return judged;
}

/// Number of points of the far side that are farther than this from their place.
std::size_t farMoved(const Sheet& sheet, const PointCloud& after, double distance) {
  const PointTree tree(after.positions);
  std::vector<std::uint32_t> there;
  std::size_t moved = 0;
  for (std::size_t i = sheet.eachSide; i < sheet.cloud.size(); ++i) {
    there.clear();
    tree.near(DVec3(sheet.cloud.positions[i]), distance, there);
    moved += there.empty();
  }
  return moved;
}

/// Flat, with something to smooth for that brush.
auto waveFor(BrushKind kind) {
  return [high = kind == BrushKind::smooth ? 0.1 : 0.0](double x) { return high * std::sin(std::numbers::pi * x); };
}

/// What a brush could not do, and how many states of points it made, while the hand rests.
struct Rest {
  BlockedMoves blocked;
  std::uint64_t states = 0;
};
constexpr int kRest = 40;  // ticks
/// Pressed at the middle, dragged aside at 500 mm/s, and at rest there.
Rest atRest(TouchBackend& touch, double top, double depth, double aside) {
  double time_s = 0;
  const auto go = [&](int ticks, const DVec3& from, const DVec3& to) {
    for (int k = 1; k <= ticks; ++k)
      touch.query({.time_s = time_s += 1e-3, .hip = from + (double(k) / ticks) * (to - from)}, 0);
  };
  const DVec3 over(0, 0, top + 2), in(0, 0, top - depth), end(aside, 0, top - depth);
  go(20, over, in);
  if (aside > 0) go(static_cast<int>(2 * aside), in, end);
  go(100, end, end);
  const BlockedMoves before = touch.edits()->blocked();
  const std::uint64_t states = touch.edits()->progress().states;
  go(kRest, end, end);
  const BlockedMoves after = touch.edits()->blocked();
  return {.blocked = {.moves = after.moves - before.moves, .edits = after.edits - before.edits},
          .states = touch.edits()->progress().states - states};
}

TouchWanted wanted(BrushKind kind, bool resample = true) {
  return {
      .radius = kSupport,
      .brush = BrushOptions{.kind = kind, .yieldDepth = kTau, .pushRate = 0.1, .radius = kBrush, .resample = resample}};
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEnd, "a push into a leaf stops a spacing before its far side, which stays") {
  for (const double thickness : {0.6, 1.6}) {
    CAPTURE(thickness);
    const Sheet leaf = makeSheet(40, 16, thickness, [](double) { return 0.0; });
    const auto touch = make(leaf.cloud, wanted(BrushKind::push));
    // Three times as deep as the leaf is thick.
    const double deep = 0.5 * thickness - 3 * thickness;
    const PointCloud after = pushed(*touch, leaf, {-5, 0, deep}, {5, 0, deep});
    CHECK(farMoved(leaf, after, 1e-6) == 0);
    const double half = 0.5 * thickness;
    const Judged judged = judge(
        leaf, after, [&](double) { return -half; }, [&](double) { return half; });
    CHECK(judged.moved > 100);
    CHECK(judged.through == 0);
    CHECK(judged.highest < 0.05);
    // Where it is thick enough, the floor of the trench is a spacing over the far side.
    if (thickness > kSpacing) CHECK(judged.median < std::max(kSpacing, thickness - 2 * kSpacing) + 0.3 * kSpacing);
    CHECK(judged.median > 0.5 * std::min(kSpacing, thickness));
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "without resampling, too, no side of a plate that is pushed deeply passes the other") {
  constexpr double kThickness = 1;
  const Sheet plate = makeSheet(40, 16, kThickness, [](double) { return 0.0; });
  for (const double depth : {2.0, 6.0}) {
    CAPTURE(depth);
    const auto touch = make(plate.cloud, wanted(BrushKind::push, false));
    const DVec3 aside(5, 0, 0), deep(0, 0, 0.5 * kThickness - depth);
    const PointCloud after = pushed(*touch, plate, deep - aside, deep + aside);
    REQUIRE(after.size() == plate.cloud.size());
    std::size_t pressed = 0, through = 0, far = 0, turned = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const bool isNear = i < plate.eachSide;
      const double z = after.positions[i].z, down = plate.cloud.positions[i].z - after.positions[i].z;
      pressed += isNear && down > 0.3 * kThickness;
      through += isNear && z < -0.5 * kThickness + 0.5 * kSpacing;
      far += !isNear && plate.cloud.normals[i].z < -0.9f &&
             (after.positions[i] != plate.cloud.positions[i] || after.normals[i] != plate.cloud.normals[i]);
      turned += glm::dot(after.normals[i], plate.cloud.normals[i]) < 0.5f;
    }
    CHECK(pressed > 100);
    CHECK(through == 0);
    CHECK(far == 0);
    CHECK(turned == 0);
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "a push across the folds of a cloth leaves its far side, and no rags") {
  constexpr double kThickness = 1.6;
  const auto height = [](double x) { return 2 * std::sin(0.2 * std::numbers::pi * x); };
  const Sheet cloth = makeSheet(40, 16, kThickness, height);
  const auto touch = make(cloth.cloud, wanted(BrushKind::push));
  const PointCloud after = pushed(*touch, cloth, {-6, 0, -1.5}, {6, 0, -1.5});
  const std::size_t far = farMoved(cloth, after, 0.1 * kSpacing);
  CHECK(far < cloth.eachSide / 30);
  CHECK(after.size() < cloth.cloud.size() + cloth.cloud.size() / 4);
  // The sides are offset along the normals: measured along z, a bound that holds at every slope.
  const auto above = [&](double x) { return height(x) + 1.9 * kThickness; };
  const auto below = [&](double x) { return height(x) - 1.9 * kThickness; };
  const Judged judged = judge(cloth, after, below, above);
  CHECK(judged.moved > 200);
  CHECK(judged.through == 0);
  CHECK(judged.highest < 0);
}

TEST_CASE_FIXTURE(OnBackEnd,
                  "where the upper side of a thin plate ends beyond the lower one, it is not pushed down as a flap") {
  constexpr double kThickness = 0.6, kBeyond = 1.6;
  Sheet plate;
  for (const double side : {1.0, -1.0})
    for (double y = -10; y <= 10; y += kSpacing)
      for (double x = -16; x <= (side > 0 ? kBeyond : 0); x += kSpacing) {
        plate.cloud.positions.emplace_back(Vec3(x, y, 0.5 * side * kThickness));
        plate.cloud.normals.emplace_back(0, 0, side);
        plate.eachSide += side > 0;
      }
  const auto touch = make(plate.cloud, wanted(BrushKind::push));
  const PointCloud after = pushed(*touch, plate, {0, -4, -2}, {0, 4, -2});
  double lowest = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    if (after.normals[i].z > 0.3f) lowest = std::min(lowest, double{after.positions[i].z});
  CHECK(lowest > -0.5 * kThickness - kSpacing);
  CHECK(after.size() < plate.cloud.size() + plate.cloud.size() / 20);
  CHECK(farMoved(plate, after, 1e-6) == 0);
}

TEST_CASE_FIXTURE(OnBackEnd, "a push under an overhang leaves it, however wide the brush is") {
  // A floor that bends up and leans back over the hand.
  constexpr double kBend = 2, kFloorEnd = 4;
  Sheet cave;
  const auto add = [&](double x, double z, const DVec3& normal) {
    for (double y = -10; y <= 10; y += kSpacing) {
      cave.cloud.positions.emplace_back(Vec3(x, y, z));
      cave.cloud.normals.emplace_back(normal);
    }
  };
  for (double x = -15; x < kFloorEnd; x += kSpacing) add(x, 0, {0, 0, 1});
  DVec3 out(0, 0, -1), end(0);
  for (double angle = -0.5 * std::numbers::pi; angle < 0.65; angle += kSpacing / kBend) {
    out = {std::cos(angle), 0, std::sin(angle)};
    if (cave.eachSide == 0 && angle > 0.3) cave.eachSide = cave.cloud.size();
    end = DVec3(kFloorEnd, 0, kBend) + kBend * out;
    add(end.x, end.z, -out);
  }
  for (double far = kSpacing; far < 8; far += kSpacing) add(end.x - far * out.z, end.z + far * out.x, -out);
  const auto touch = make(cave.cloud, wanted(BrushKind::push));
  const PointCloud after = pushed(*touch, cave, {3.5, -3, -1.5}, {3.5, 3, -1.5});
  CHECK(farMoved(cave, after, 1e-6) == 0);
  double lowest = 0;
  for (const Vec3& place : after.positions) lowest = std::min(lowest, double{place.z});
  CHECK(lowest == within(-1.5 + kTau, 0.2));
}

TEST_CASE_FIXTURE(OnBackEnd,
                  "a brush on a part that is too thin for it moves nothing, and all of its points are blocked") {
  for (const BrushKind kind : {BrushKind::push, BrushKind::smooth}) {
    CAPTURE(int(kind));
    const Sheet leaf = makeSheet(40, 16, 0.4, waveFor(kind));
    const auto touch = make(leaf.cloud, wanted(kind));
    const Rest rest = atRest(*touch, 0.2, 1.5, 0);
    CHECK(rest.blocked.edits == kRest);
    const double points = std::numbers::pi * kBrush * kBrush / (kSpacing * kSpacing);  // under a ball as wide as it is
    CHECK(double(rest.blocked.moves) > 0.25 * points * kRest);
    CHECK(double(rest.blocked.moves) < 1.05 * points * kRest);
    if (kind == BrushKind::push) CHECK(rest.states == 0);
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "a brush that has done its work, or is slower than the hand, blocks no point") {
  for (const BrushKind kind : {BrushKind::push, BrushKind::inflate, BrushKind::smooth, BrushKind::grab}) {
    CAPTURE(int(kind));
    const Sheet plate = makeSheet(40, 16, 8, waveFor(kind));
    const auto touch = make(plate.cloud, wanted(kind));
    atRest(*touch, 4, 2, kind == BrushKind::grab ? 6 : 0);
    PointCloud after = plate.cloud;
    CHECK(touch->readBack(after) > 50);
    CHECK(touch->edits()->blocked().moves == 0);
    CHECK(touch->edits()->blocked().edits == 0);
  }
}

TEST_CASE_FIXTURE(OnBackEnd, "a carve along a thin plate cuts a slot without a bridge, and nothing beyond its ball") {
  for (const double step : {0.02, 0.2}) {
    CAPTURE(step);
    const Sheet plate = makeSheet(40, 16, 1.2, waveFor(BrushKind::carve));
    const auto touch = make(plate.cloud, wanted(BrushKind::carve));
    double time_s = 0;
    const auto press = [&](const DVec3& hip, bool sculpts) {
      touch->query({.time_s = time_s += 1e-3, .hip = hip, .sculpts = sculpts, .byButton = true}, 0);
    };
    const double depth = 0.6 * kBrush;
    for (double z = 3; z > -depth; z -= 0.05) press({-8, 0, z}, true);
    for (double x = -8; x < 8; x += step) press({x, 0, -depth}, true);
    for (int k = 0; k < 300; ++k) press({8, 0, -depth}, true);
    press({8, 0, 10}, false);
    touch->finish();
    PointCloud after = plate.cloud;
    touch->readBack(after);
    std::size_t bridge = 0, beside = 0;
    for (const Vec3& p : after.positions) {
      bridge += std::abs(p.x) < 8 && std::abs(p.y) < 0.4 * kBrush;
      beside += std::abs(p.y) > 1.1 * kBrush;
    }
    CHECK(bridge == 0);
    std::size_t had = 0;
    for (const Vec3& p : plate.cloud.positions) had += std::abs(p.y) > 1.1 * kBrush;
    CHECK(beside == had);
    CHECK(touch->edits()->blocked().fromBehind == 0);
  }
}

TEST_CASE("an edit is blocked if nearly all points are that would move, and not few of those that its stroke reaches") {
  BlockedCount count;
  count.note(1, 0, 100, true);
  count.note(1, 20, 0, true);
  count.note(1, 90, 20, true);
  CHECK(count.sum().edits == 0);
  count.note(1, 90, 10, true);
  CHECK(count.sum().edits == 1);
  count.note(2, 5, 0, true);
  CHECK(count.sum().edits == 2);
  count.note(2, 0, 0, true);
  CHECK(count.sum().edits == 2);
  CHECK(count.sum().moves == 205);
  CHECK(count.sum().fromBehind == 0);
  count.note(3, 0, 5, false);
  CHECK(count.sum().fromBehind == 0);
  count.note(3, 0, 0, false);
  CHECK(count.sum().fromBehind == 0);  // the stroke has changed what was there
  count.note(4, 0, 0, false);
  CHECK(count.sum().fromBehind == 1);
}

TEST_CASE_FIXTURE(OnBackEnd, "a brush at the back of an open sheet changes nothing, which is counted") {
  for (const BrushKind kind : {BrushKind::push, BrushKind::inflate, BrushKind::smooth, BrushKind::flatten})
    for (const double side : {-1.0, 1.0}) {
      CAPTURE(int(kind));
      CAPTURE(side);
      PointCloud sheet;
      const auto wave = waveFor(kind);
      for (double y = -10; y <= 10; y += kSpacing)
        for (double x = -16; x <= 16; x += kSpacing) {
          sheet.positions.emplace_back(Vec3(x, y, wave(x)));
          sheet.normals.emplace_back(0, 0, 1);
        }
      const auto touch = make(sheet, wanted(kind));
      for (int k = 0; k < 100; ++k)
        touch->query({.time_s = 1e-3 * k, .hip = DVec3(0, 0, side * std::max(3 - 0.1 * k, -1.5))}, 0);
      touch->finish();
      PointCloud after = sheet;
      const std::size_t changed = touch->readBack(after);
      const BlockedMoves blocked = touch->edits()->blocked();
      if (side < 0) {
        CHECK(changed == 0);
        CHECK(blocked.fromBehind > 30);
      } else {
        CHECK(changed > 50);
        CHECK(blocked.fromBehind == 0);
      }
    }
}

TEST_CASE_FIXTURE(OnBackEnd, "a hand that presses its button behind a surface, without contact, is counted") {
  for (const double side : {-1.0, 1.0}) {
    CAPTURE(side);
    PointCloud sheet;
    for (double y = -10; y <= 10; y += kSpacing)
      for (double x = -16; x <= 16; x += kSpacing) {
        sheet.positions.emplace_back(Vec3(x, y, 0));
        sheet.normals.emplace_back(0, 0, 1);
      }
    const auto touch = make(sheet, wanted(BrushKind::push));
    for (const bool presses : {false, true}) {
      for (int k = 0; k < 30; ++k)
        touch->query(
            {.time_s = 1e-3 * (k + (presses ? 30 : 0)), .hip = DVec3(0, 0, side), .sculpts = presses, .byButton = true},
            0);
      touch->finish();
      CHECK((touch->edits()->blocked().fromBehind > 20) == (presses && side < 0));
    }
  }
}

// A point that waits for its turn goes no further than it has seen. If the hand went on, a gap would open beside it, be
// filled, and the new points would have to wait, too.
TEST_CASE("a quick grab of more points than an edit takes waits for them, and fills nothing that lags behind") {
  // A blade with its points at random.
  constexpr double kThickness = 0.4, kFine = 0.2;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> along(-18, 12), across(-4, 4);
  PointCloud blade;
  for (int i = 0; i < 12'000; ++i) {
    const float side = i % 2 == 0 ? 1 : -1;
    const float x = along(random);
    const float y = across(random);
    blade.positions.emplace_back(x, y, 0.5f * side * static_cast<float>(kThickness));
    blade.normals.emplace_back(0, 0, side);
  }
  CpuTouch touch(blade, {.radius = 4.7 * kFine,
                         .brush = BrushOptions{.kind = BrushKind::grab, .yieldDepth = kTau, .radius = 8.6},
                         .threads = 1});
  double time_s = 0;
  const auto go = [&](const DVec3& from, const DVec3& to) {
    const int ticks = static_cast<int>(glm::distance(from, to) / 0.4);  // at 400 mm/s
    for (int k = 0; k < ticks; ++k, time_s += 1e-3)
      touch.query({.time_s = time_s, .hip = glm::mix(from, to, double(k) / ticks)}, 0);
  };
  const std::array<DVec3, 4> path{DVec3(-8, 0, 6), DVec3(-8, 0, -5), DVec3(4, 0, -5), DVec3(4, 0, 5)};
  for (std::size_t leg = 1; leg < path.size(); ++leg) go(path[leg - 1], path[leg]);
  touch.finish();
  PointCloud after = blade;
  const std::size_t changed = touch.readBack(after);
  CHECK(changed > 1000);
  CHECK(after.size() < blade.size() + changed / 2);
}

}  // namespace palpate::thin_parts_test
