// Transforms between ROS frames, without a network.
#include "haptics/sharing/ros_tf.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <random>

#include "haptics/sharing/network.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::ros_transforms_test {

using namespace sharing;

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
const double kHalf = std::sqrt(0.5);

RosTransform transform(std::string_view parent, std::string_view child, const DVec3& translation = DVec3(0),
                       const DQuat& turn = DQuat(1, 0, 0, 0), std::int64_t stamp_ns = 0) {
  return {.parent = parent, .child = child, .stamp_ns = stamp_ns, .translation = translation, .turn = turn};
}

std::string refusal(const RosTransforms& tree, std::string_view frame, std::string_view target, std::int64_t stamp_ns) {
  return errorOf<NetworkError>([&] { tree.find(frame, target, stamp_ns); });
}

}  // namespace

TEST_CASE("a chain of static transforms is followed up, down, and over a common ancestor") {
  RosTransforms tree;
  // The mast is 2 m above the base; the camera on it is rotated by a quarter about z, and uses optical axes.
  CHECK(tree.add(transform("/map", "base", {10, 0, 0}), true));
  CHECK(tree.add(transform("base", "/mast", {0, 0, 2}, DQuat(kHalf, 0, 0, kHalf)), true));
  CHECK(tree.add(transform("mast", "optical", {1, 0, 0}, DQuat(0.5, -0.5, 0.5, -0.5)), true));
  CHECK(tree.add(transform("base", "lidar", {0, 1, 0.5}), true));
  const auto isAt = [&](std::string_view frame, std::string_view target, const DVec3& place, const DVec3& there) {
    const DVec3 found = tree.find(frame, target, 7 * kSecond).toWorld(place);
    CAPTURE(fmt::format("{} {} {}", found.x, found.y, found.z));
    CHECK(glm::distance(found, there) < 1e-12);
  };
  // A point 3 m in front of the camera is along x of the mast, which is y of the base.
  isAt("optical", "mast", {0, 0, 3}, {4, 0, 0});
  isAt("optical", "base", {0, 0, 3}, {0, 4, 2});
  isAt("/optical", "map", {0, 0, 3}, {10, 4, 2});
  isAt("map", "/optical", {10, 4, 2}, {0, 0, 3});
  isAt("optical", "lidar", {0, 0, 3}, {0, 3, 1.5});
  isAt("lidar", "optical", {0, 3, 1.5}, {0, 0, 3});
  isAt("base", "base", {1, 2, 3}, {1, 2, 3});
  isAt("nobody", "nobody", {1, 2, 3}, {1, 2, 3});
  // A repeated joint replaces the old one.
  CHECK(tree.add(transform("base", "mast", {0, 0, 3}), true));
  isAt("optical", "base", {0, 0, 3}, {4, 0, 3});
}

TEST_CASE("a moving frame uses its newest transform that is not later than the time, nor too old") {
  RosTransforms tree;
  for (const int tick : {3, 1, 2, 0})  // in the order received
    CHECK(tree.add(transform("map", "arm", {double(tick), 0, 0}, DQuat(1, 0, 0, 0), 5 * kSecond + tick * kSecond / 100),
                   false));
  CHECK(tree.add(transform("arm", "camera", {0, 1, 0}), true));
  const auto x = [&](std::int64_t stamp_ns) { return tree.find("camera", "map", stamp_ns).centre.x; };
  CHECK(x(5 * kSecond) == 0);
  CHECK(x(5 * kSecond + kSecond / 100 - 1) == 0);
  CHECK(x(5 * kSecond + kSecond / 100) == 1);
  CHECK(x(5 * kSecond + kSecond / 40) == 2);
  CHECK(x(6 * kSecond) == 3);
  CHECK(tree.find("camera", "map", 6 * kSecond).centre.y == 1);
  CHECK(says(refusal(tree, "camera", "map", 5 * kSecond - kSecond / 2),
             "'arm' in 'map' is unknown at its time: the oldest one received is 0.500 s newer"));
  CHECK(x(6 * kSecond + kSecond / 100) == 3);
  CHECK(says(refusal(tree, "camera", "map", 7 * kSecond + kSecond / 10), "2.070 s before its time, and is too old"));
  // Transforms that are not needed do not matter.
  CHECK(tree.find("camera", "arm", 100 * kSecond).centre.y == 1);
  CHECK(tree.add(transform("arm", "lamp", {0, 0, 5}), true));
  CHECK(tree.find("camera", "lamp", 100 * kSecond).centre == DVec3(0, 1, -5));
  // The last thousand are kept.
  for (int tick = 0; tick < 5000; ++tick)
    tree.add(transform("map", "arm", {double(tick), 0, 0}, DQuat(1, 0, 0, 0), 20 * kSecond + tick * kSecond / 1000),
             false);
  CHECK(x(24 * kSecond) == 4000);
  CHECK(x(25 * kSecond) == 4999);
  CHECK(says(refusal(tree, "camera", "map", 23 * kSecond), "newer"));
}

TEST_CASE("unconnected frames and cycles are reported") {
  RosTransforms tree;
  CHECK(says(refusal(tree, "camera", "map", 0),
             "is in the frame 'camera', from which no transform on /tf_static and /tf leads to 'map'"));
  tree.add(transform("a", "b"), true);
  tree.add(transform("b", "c"), true);
  tree.add(transform("c", "a"), true);
  CHECK(says(refusal(tree, "a", "map", 0), "the frames above 'a' form a cycle"));
  CHECK(says(refusal(tree, "map", "a", 0), "no transform on"));
  CHECK(tree.find("a", "c", 0).centre == DVec3(0));
  CHECK(says(refusal(tree, "x\033[2J", "map", 0), "'x?[2J'"));
}

TEST_CASE("invalid transforms, and frames beyond the limit, are refused") {
  RosTransforms tree;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  const std::string longName(300, 'x');
  for (const double bad : {kNan, kInf, -kInf, 1e10}) {
    CHECK_FALSE(tree.add(transform("a", "b", {0, bad, 0}), true));
    CHECK_FALSE(tree.add(transform("a", "b", {}, DQuat(1, 0, bad, 0)), true));
  }
  CHECK_FALSE(tree.add(transform("a", "b", {}, DQuat(0, 0, 0, 0)), true));
  CHECK_FALSE(tree.add(transform("a", "b", {}, DQuat(2, 0, 0, 0)), true));
  CHECK_FALSE(tree.add(transform("a", "a"), true));
  CHECK_FALSE(tree.add(transform("/a", "a"), true));
  CHECK_FALSE(tree.add(transform("", "a"), true));
  CHECK_FALSE(tree.add(transform("a", ""), true));
  CHECK_FALSE(tree.add(transform("a", "/"), true));
  CHECK_FALSE(tree.add(transform(longName, "a"), true));
  CHECK_FALSE(tree.add(transform("a", longName), true));
  CHECK(says(refusal(tree, "b", "a", 0), "no transform on"));
  CHECK(tree.add(transform("a", "b"), true));
  std::size_t taken = 0;
  for (int i = 0; i < 10'000; ++i) taken += tree.add(transform("a", fmt::format("f{}", i)), false);
  CHECK(taken == RosTransforms::kMaxFrames - 1);
  CHECK(tree.add(transform("a", "b", {1, 0, 0}), true));  // a known frame is still updated
  CHECK(tree.find("b", "a", 0).centre.x == 1);
}

TEST_CASE("random transforms cause no failure and no wrong position") {
  std::mt19937 dice(5);
  RosTransforms tree;
  const auto number = [&] {
    const std::uint32_t kind = dice() % 8;
    return kind == 0 ? std::nan("") : kind == 1 ? 1e300 : double(dice() % 2000) / 1000 - 1;
  };
  std::size_t found = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::string parent(1, static_cast<char>('a' + dice() % 12)), child(1, static_cast<char>('a' + dice() % 12));
    const double x = number(), y = number(), z = number(), w = number();
    const auto stamp_ns = static_cast<std::int64_t>((std::uint64_t{dice()} << 32) | dice());
    tree.add(transform(parent, child, {x, y, z}, dice() % 2 == 0 ? DQuat(1, 0, 0, 0) : DQuat(w, x, y, z),
                       dice() % 2 == 0 ? stamp_ns : 0),
             dice() % 2 == 0);
    try {
      const CameraPose pose = tree.find("a", "b", dice() % 2 == 0 ? stamp_ns : 1);
      ++found;
      CHECK(std::abs(glm::length(pose.turn) - 1) < 1e-9);
      CHECK(std::isfinite(glm::length(pose.centre)));
    } catch (const NetworkError&) {  // states the reason
    }
  }
  CHECK(found > 100);
}

TEST_CASE("transforms of a restarted recording replace the earlier ones") {
  RosTransforms tree;
  const auto play = [&](double from_s, double to_s) {
    for (double t = from_s; t < to_s; t += 0.01)
      CHECK(tree.add(transform("map", "arm", {t, 0, 0}, DQuat(1, 0, 0, 0), static_cast<std::int64_t>(1e9 * t)), false));
  };
  const auto placeAt = [&](double t) {
    return tree.find("arm", "map", static_cast<std::int64_t>(1e9 * t)).toWorld(DVec3(0)).x;
  };
  play(0, 60);
  CHECK(placeAt(55) == near(55, 0.001));
  play(1, 2);
  CHECK(placeAt(1.5) == near(1.5, 0.01));
  // A transform a few seconds late is not a restart.
  play(2, 20);
  play(17, 17.005);
  CHECK(placeAt(19.5) == near(19.5, 0.001));
}

}  // namespace palpate::ros_transforms_test
