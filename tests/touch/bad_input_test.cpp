// Push strokes over clouds that no scanner should give, and poses that no device should give, on each back end: nothing
// becomes infinite, each stroke ends, and takes no more time than one over as many points of an even plane.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "tests/touch/limbs.hpp"

namespace palpate::bad_input_test {

namespace {

constexpr double kSide = 32;
constexpr std::size_t kCoincident = 5000;
constexpr double kMaxTimes = 2;  // of an edit of as many points of an even plane

PointCloud plane() {
  Limbs limbs(false);
  limbs.addSheet({-kSide / 2, -kSide / 2, 0}, {kSide, 0, 0}, {0, kSide, 0});
  return limbs.cloud();
}

PointCloud withCoincident() {
  PointCloud cloud = plane();
  cloud.positions.insert(cloud.positions.end(), kCoincident, Vec3(0));
  cloud.normals.insert(cloud.normals.end(), kCoincident, Vec3(0, 0, 1));
  return cloud;
}

PointCloud ofFour() {
  const float h = 0.4f * static_cast<float>(kLimbSpacing);
  PointCloud cloud;
  cloud.positions = {{-h, -h, 0}, {h, -h, 0}, {-h, h, 0}, {h, h, 0}};
  cloud.normals.assign(4, Vec3(0, 0, 1));
  return cloud;
}

PointCloud flippedInPatches() {
  PointCloud cloud = plane();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& at = cloud.positions[i];
    if ((static_cast<int>(std::floor(at.x / 4)) + static_cast<int>(std::floor(at.y / 4))) % 2 != 0)
      cloud.normals[i] = -cloud.normals[i];
  }
  return cloud;
}

/// Each point twice.
PointCloud twoSheets(float side) {
  PointCloud cloud = plane();
  const std::size_t count = cloud.size();
  for (std::size_t i = 0; i < count; ++i) {
    cloud.positions.push_back(cloud.positions[i]);
    cloud.normals.push_back(side * cloud.normals[i]);
  }
  return cloud;
}

std::size_t underBrush(const PointCloud& cloud, double radius) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cloud.positions, [&](const Vec3& at) { return double{glm::length(at)} < radius; }));
}

bool isFinite(const Contact& contact) { return palpate::isFinite(contact.proxy) && palpate::isFinite(contact.normal); }

std::size_t infiniteIn(const TouchBackend& touch, PointCloud cloud) {
  touch.readBack(cloud);
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    count += !palpate::isFinite(DVec3(cloud.positions[i])) || !palpate::isFinite(DVec3(cloud.normals[i]));
  return count;
}

/// Presses 2 mm deep and drags, and repeats that until so many ticks have passed.
DVec3 hipAt(int tick) {
  const int press = onCpuOrGpu(20, 10), drag = 2 * press, k = tick % (press + drag);
  const double down = std::min(1.0, double(k) / press), along = std::max(0.0, double(k - press) / drag);
  return {4 * along, 0, 1 - 3 * down};
}

/// Median of the edits.
double editTime_us(const TouchBackend& touch) {
  const BackendReport report = touch.report();
  std::vector<double> times(report.editTimes_us.begin(), report.editTimes_us.end());
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::ranges::nth_element(times, middle);
  return times.empty() ? 0 : *middle;
}

BrushOptions pushOf(double radius) {
  return {.kind = BrushKind::push, .yieldDepth = kLimbTau, .pushRate = 0.2, .radius = radius};
}

/// The same stroke over the cloud and over an even plane with its own brush, tick by tick in turn, so that both meet
/// the same machine.
void checkStroke(const OnBackEnd& backEnd, const std::string& name, const PointCloud& cloud, double radius,
                 double evenRadius = kLimbBrush) {
  CAPTURE(name);
  const PointCloud even = plane();
  const auto bad = backEnd.make(cloud, {.radius = kLimbSupport, .brush = pushOf(radius)});
  const auto sane = backEnd.make(even, {.radius = kLimbSupport, .brush = pushOf(evenRadius)});
  const int ticks = onCpuOrGpu(240, 30);
  for (int k = 0; k < ticks; ++k) {
    const Pose pose{.time_s = 1e-3 * k, .hip = hipAt(k)};
    const Contact contact = bad->query(pose, 0);
    REQUIRE(contact.valid);
    REQUIRE(isFinite(contact));
    CHECK(sane->query(pose, 0).valid);
  }
  bad->finish();
  sane->finish();
  CHECK(infiniteIn(*bad, cloud) == 0);
  const double points = std::max(1.0, double(underBrush(cloud, radius)) / double(underBrush(even, evenRadius)));
  CHECK(editTime_us(*bad) < kMaxTimes * points * editTime_us(*sane));
}

}  // namespace

TEST_CASE_FIXTURE(OnPlainBackEnd, "a push over bad clouds stays finite, ends, and takes no longer than over a plane") {
  checkStroke(*this, "coincident points", withCoincident(), kLimbBrush);
  checkStroke(*this, "a brush of a tenth of the spacing", plane(), 0.1 * kLimbSpacing);
  checkStroke(*this, "a brush of a quarter of the model", plane(), kSide / 4);
  // Every edit of four points is one of more than a sixteenth of them: the index is built again.
  checkStroke(*this, "four points", ofFour(), kLimbBrush, kSide / 4);
  checkStroke(*this, "normals flipped in patches", flippedInPatches(), kLimbBrush);
  checkStroke(*this, "two sheets with opposite normals", twoSheets(-1), kLimbBrush);
  checkStroke(*this, "two sheets with the same normals", twoSheets(1), kLimbBrush);
}

TEST_CASE_FIXTURE(OnPlainBackEnd, "poses that are not numbers stop the force, and the stroke goes on after them") {
  const PointCloud cloud = plane();
  const auto touch = make(cloud, {.radius = kLimbSupport, .brush = pushOf(kLimbBrush)});
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::size_t bad = 0;
  for (int k = 0; k < 30; ++k) {
    Pose pose{.time_s = 1e-3 * k, .hip = hipAt(k)};
    const bool broken = k % 7 == 3;
    if (broken) pose.hip[k % 3] = k % 2 ? none : std::numeric_limits<double>::infinity();
    const Contact contact = touch->query(pose, 0);
    CHECK(contact.valid == !broken);
    bad += contact.valid && !isFinite(contact);
  }
  touch->finish();
  CHECK(bad == 0);
  CHECK(infiniteIn(*touch, cloud) == 0);
  PointCloud after = cloud;
  CHECK(touch->readBack(after) > 20);
  CHECK(depthUnder(after, {{2, 0, 0}, {0, 0, 1}}) > 1);
}

}  // namespace palpate::bad_input_test
