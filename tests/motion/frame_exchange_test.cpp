#include "engine/motion/frame_exchange.hpp"

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <stdexcept>
#include <thread>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/motion/cloud_source.hpp"

namespace palpate::frame_exchange_test {

TEST_CASE("a reader gets the newest complete frame once, and its half is not overwritten meanwhile") {
  FrameExchange exchange;
  const auto nothing = [](const FrameExchange::Frame&) { FAIL("no frame was published"); };
  CHECK_FALSE(exchange.read(nothing));
  CHECK(exchange.beginWriting(1));
  CHECK_FALSE(exchange.read(nothing));
  exchange.publish(1, 0.5);
  CHECK(exchange.beginWriting(0));
  CHECK(exchange.read([&](const FrameExchange::Frame& frame) {
    CHECK(frame.half == 1);
    CHECK(frame.time_s == 0.5);
    CHECK(frame.number == 1);
    CHECK_FALSE(exchange.beginWriting(1));
    exchange.publish(0, 0.6);
  }));
  CHECK(exchange.beginWriting(1));
  CHECK(exchange.read([&](const FrameExchange::Frame& frame) { CHECK(frame.number == 2); }));
  CHECK_FALSE(exchange.read(nothing));
}

TEST_CASE("a half reserved for writing is not read, and a reader that throws releases its half") {
  FrameExchange exchange;
  exchange.publish(0, 1);
  CHECK(exchange.beginWriting(0));
  CHECK_FALSE(exchange.read([](const FrameExchange::Frame&) { FAIL("a half in use by the writer was read"); }));
  exchange.publish(0, 2);
  CHECK_THROWS_AS(exchange.read([](const FrameExchange::Frame&) { throw std::runtime_error("no room"); }),
                  std::runtime_error);
  CHECK(exchange.beginWriting(0));
}

TEST_CASE("no frame is torn between a writing and a reading thread") {
  FrameExchange exchange;
  std::array<std::array<int, 64>, 2> halves{};
  constexpr int kFrames = 20'000;
  std::jthread writer([&] {
    std::uint32_t half = 0;
    for (int number = 1; number <= kFrames;) {
      if (!exchange.beginWriting(half)) {
        std::this_thread::yield();
        continue;
      }
      halves[half].fill(number);
      exchange.publish(half, number++);
      half = 1 - half;
    }
  });
  int torn = 0, last = 0, backwards = 0;
  while (last < kFrames)
    exchange.read([&](const FrameExchange::Frame& frame) {
      const auto& half = halves[frame.half];
      for (const int value : half) torn += value != static_cast<int>(frame.time_s);
      backwards += half[0] <= last;
      last = half[0];
    });
  CHECK(torn == 0);
  CHECK(backwards == 0);
}

TEST_CASE("a frame with inconsistent sizes or values that are not finite is refused") {
  const CloudFrame whole{.positions = {{1, 2, 3}, {4, 5, 6}}, .normals = {{0, 0, 1}, {1, 0, 0}}};
  CHECK_NOTHROW(requireWhole(whole, 2));
  CHECK_THROWS_AS(requireWhole(whole, 1), Error);
  CloudFrame wrong = whole;
  wrong.positions[1].z = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_WITH_AS(requireWhole(wrong, 2), "a frame for 0 s: in its positions, the value of point 1 is not finite",
                       Error);
  wrong = whole;
  wrong.normals[0].x = -std::numeric_limits<float>::infinity();
  CHECK_THROWS_AS(requireWhole(wrong, 2), Error);
  wrong = whole;
  wrong.velocities = {Vec3(0)};
  CHECK_THROWS_AS(requireWhole(wrong, 2), Error);
  wrong = whole;
  wrong.normals.pop_back();
  CHECK_THROWS_AS(requireWhole(wrong, 2), Error);
  wrong = whole;
  wrong.colors = {{1, 2, 3}};
  CHECK_THROWS_AS(requireWhole(wrong, 2), Error);
  for (const std::vector<std::uint32_t>& ids : {std::vector<std::uint32_t>{1}, {1, 1}, {3, 2}, {1, 4}}) {
    wrong = whole;
    wrong.ids = ids;
    CHECK_THROWS_AS(requireWhole(wrong, 4), Error);
  }
  wrong.ids = {1, 3};
  CHECK_NOTHROW(requireWhole(wrong, 4));
}

TEST_CASE("a frame replaces the points of a cloud: one by one, or all if the ids differ") {
  PointCloud cloud;
  cloud.positions = {{1, 2, 3}, {4, 5, 6}};
  cloud.normals = {{0, 0, 1}, {1, 0, 0}};
  cloud.extra.push_back({.name = "class", .type = ScalarType::u8, .data = std::vector<std::byte>(2)});
  CloudFrame frame{.positions = {{1, 2, 3}, {4, 5, 7}}, .normals = {{0, 1, 0}, {0, 1, 0}}};
  CHECK(placeAt(frame, cloud) == 1);
  CHECK(cloud.positions == frame.positions);
  CHECK(cloud.normals == frame.normals);
  CHECK(cloud.extra.size() == 1);
  CHECK_FALSE(cloud.hasColors());
  frame.ids = {0, 7};
  frame.colors = {{1, 2, 3}, {4, 5, 6}};
  CHECK(placeAt(frame, cloud) == 2);
  CHECK(cloud.extra.empty());
  CHECK(cloud.colors.at(1) == std::array<std::uint8_t, 4>{4, 5, 6, 255});
  CHECK(placeAt({}, cloud) == 0);
  CHECK(cloud.empty());
}

}  // namespace palpate::frame_exchange_test
