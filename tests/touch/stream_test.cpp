// A wall in front of a depth camera that steps, approaches and disappears between frames, felt through its newest
// frame.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "engine/motion/depth_points.hpp"
#include "engine/motion/depth_source.hpp"
#include "tests/motion/depth_scene.hpp"
#include "tests/motion/plane_stream.hpp"
#include "tests/near.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::stream_test {

namespace {

// The camera is at the origin and looks along z; 30 frames a second.
class WallStream final : public DepthStream {
 public:
  static constexpr double kPeriod_s = 1.0 / 30;

  // `depths_m`: depth of the wall in each frame; 0: no wall.
  explicit WallStream(std::vector<double> depths_m) : depths_m_(std::move(depths_m)) {}

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override {
    if (at_ == depths_m_.size()) return false;
    frame = {.time_s = kPeriod_s * static_cast<double>(at_), .number = at_};
    frame.depth_m.assign(std::size_t{camera_.width} * camera_.height, static_cast<float>(depths_m_[at_]));
    ++at_;
    return true;
  }
  bool isRecorded() const override { return true; }
  void rewind() override { at_ = 0; }
  std::uint64_t frames() const override { return depths_m_.size(); }
  double duration_s() const override { return kPeriod_s * static_cast<double>(depths_m_.size() - 1); }

 private:
  DepthCamera camera_{.width = 80, .height = 60, .fx = 260, .fy = 260, .cx = 39.5, .cy = 29.5};
  std::vector<double> depths_m_;
  std::size_t at_ = 0;
};

// Half a metre away: its pixels are 1.9 mm wide.
constexpr double kWall_m = 0.5, kWallRadius_m = 0.008, kStreamTick_s = 1e-3;

// Answers to a stylus in virtual time that arrives within 20 ms from 5 mm in front of the first wall, and stays at a
// depth.
std::vector<Contact> feelWall(const OnBackEnd& backEnd, const std::vector<double>& depths_m, double hip_m) {
  DepthSource source(playedStream(std::make_shared<WallStream>(depths_m)), DVec3(0));
  CloudFrame first;
  source.makeFrame(0, first);
  PointCloud cloud;
  placeAt(first, cloud);
  const auto touch = backEnd.make(cloud, {.radius = kWallRadius_m, .source = &source});
  std::vector<Contact> contacts;
  const double end_s = WallStream::kPeriod_s * static_cast<double>(depths_m.size());
  for (int i = 0; kStreamTick_s * i < end_s; ++i) {
    const double way = std::min(1.0, 0.05 * i);
    const DVec3 hip(0.001, -0.002, (1 - way) * (depths_m[0] - 0.005) + way * hip_m);
    contacts.push_back(touch->query({.time_s = kStreamTick_s * i, .hip = hip}, 0));
    CHECK(contacts.back().valid);
  }
  return contacts;
}

}  // namespace

// A step of a millimetre is felt as a ramp over one frame, without reversal or overshoot.
TEST_CASE_FIXTURE(OnBackEnd, "a wall that steps by a millimetre before a depth camera is felt as a ramp") {
  constexpr double kStep_m = 0.001, kTiny_m = 2e-6;
  for (const double sign : {1.0, -1.0}) {
    CAPTURE(sign);
    std::vector<double> depths_m(7, kWall_m);
    std::fill(depths_m.begin() + 3, depths_m.end(), kWall_m + sign * kStep_m);
    const auto contacts = feelWall(*this, depths_m, kWall_m + 0.003);
    const double from_s = 3 * WallStream::kPeriod_s, until_s = 4 * WallStream::kPeriod_s;
    double last = kWall_m, steepest = 0;
    for (std::size_t i = 30; i < contacts.size(); ++i) {
      const double time_s = kStreamTick_s * static_cast<double>(i), place = contacts[i].proxy.z;
      CHECK(contacts[i].touching);
      CHECK(sign * (place - last) > -kTiny_m);
      CHECK(sign * (place - kWall_m) < kStep_m + kTiny_m);
      steepest = std::max(steepest, std::abs(place - last));
      last = place;
      if (time_s <= from_s) CHECK(std::abs(place - kWall_m) < kTiny_m);
      if (time_s >= until_s) CHECK(std::abs(place - kWall_m - sign * kStep_m) < kTiny_m);
    }
    CHECK(steepest < 1.2 * kStep_m * kStreamTick_s / WallStream::kPeriod_s);
  }
}

// A wall that approaches at half a metre a second carries the stylus along and never lets it through.
TEST_CASE_FIXTURE(OnBackEnd, "a wall approaching a depth camera cannot pass a stylus") {
  std::vector<double> depths_m;
  for (int i = 0; i < 10; ++i) depths_m.push_back(kWall_m - 0.5 * WallStream::kPeriod_s * std::max(0, i - 2));
  const double hip_m = kWall_m + 0.0005;
  const auto contacts = feelWall(*this, depths_m, hip_m);
  for (std::size_t i = 30; i < contacts.size(); ++i) {
    const double place_s = kStreamTick_s * static_cast<double>(i) - WallStream::kPeriod_s;  // a frame behind
    const double truth = kWall_m - 0.5 * std::max(0.0, place_s - 2 * WallStream::kPeriod_s);
    CHECK(contacts[i].touching);
    CHECK(std::abs(contacts[i].proxy.z - truth) < 1e-4);
    CHECK(contacts[i].normal.z < -0.99);
  }
}

// A hand held in a tilted, moving plane: from tick to tick, with or without a new frame, its spring hardly stretches.
TEST_CASE_FIXTURE(OnBackEnd, "no frame of a tilted plane is felt as a step") {
  struct Case {
    SeenPlane seen;
    double mostStretch_mm;
  };
  for (const Case& at :
       {Case{{.tilt_rad = 0.3, .rounded_m = 0.001}, 0.03}, Case{{.tilt_rad = 0.3, .noise_m = 0.001}, 0.1}}) {
    DepthSource source(playedStream(std::make_shared<PlaneStream>(at.seen)), DVec3(0));
    CloudFrame first;
    source.makeFrame(0, first);
    PointCloud cloud;
    placeAt(first, cloud);
    const auto touch = make(cloud, {.radius = 4 * PlaneStream::kSpacing_m, .source = &source});
    double most_mm = 0;
    DVec3 last(0);
    for (int i = 0; i < 250; ++i) {
      const DVec3 hip = PlaneStream::heldAt(kStreamTick_s * i, 0.003, at.seen.normal());
      const Contact contact = touch->query({.time_s = kStreamTick_s * i, .hip = hip}, 0);
      if (i > 120) CHECK(contact.touching);
      if (i > 120) most_mm = std::max(most_mm, 1000 * glm::distance(contact.proxy - hip, last));
      last = contact.proxy - hip;
    }
    CHECK(most_mm < at.mostStretch_mm);
  }
}

// After the wall has disappeared nothing is felt, from the first tick on.
TEST_CASE_FIXTURE(OnBackEnd, "a wall that leaves a depth camera's view is no longer felt") {
  std::vector<double> depths_m(6, kWall_m);
  std::fill(depths_m.begin() + 3, depths_m.end(), 0.0);
  const auto contacts = feelWall(*this, depths_m, kWall_m + 0.002);
  for (std::size_t i = 30; i < contacts.size(); ++i) {
    const bool isThere = kStreamTick_s * static_cast<double>(i) < 3 * WallStream::kPeriod_s - 1e-9;
    CHECK(contacts[i].touching == isThere);
    if (!isThere) CHECK(contacts[i].proxy.z == near(kWall_m + 0.002, 1e-5));
  }
}

}  // namespace palpate::stream_test
