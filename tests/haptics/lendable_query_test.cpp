// A query that is lent: the planes felt last answer meanwhile.
#include "haptics/lendable_query.hpp"

#include <doctest/doctest.h>

#include "haptics/force_law.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::lendable_query_test {

namespace {

Contact askAt(LendableQuery& query, double time_s, const DVec3& hip) {
  const Pose pose{.time_s = time_s, .hip = hip};
  return query.ask({&pose, 1}, 0).front();
}

}  // namespace

TEST_CASE("a lent query is not asked; its planes hold for a tenth of a second, and are gone after two") {
  SharedSphere sphere(1, 10);
  LendableQuery query(sphere);
  const DVec3 hip(0, 0, 8);
  CHECK(askAt(query, 0, hip).fresh);
  query.lend();
  CHECK(query.isLent());
  for (const double time_s : {0.001, 0.05, 0.099}) {
    CAPTURE(time_s);
    const Contact held = askAt(query, time_s, hip + DVec3(1, 0, -0.5));
    CHECK(held.touching);
    CHECK(held.valid);
    CHECK_FALSE(held.fresh);
    CHECK(held.dataTime_s == time_s);  // nothing else can have changed the surface
    CHECK(held.proxy.z == near(10, 1e-9));
  }
  const Contact fading = askAt(query, 0.15, hip);
  CHECK(fading.proxy.z == near(9, 1e-6));
  CHECK(fading.dataTime_s == 0);
  CHECK_FALSE(askAt(query, 0.21, hip).touching);
  CHECK_FALSE(askAt(query, 0.05, DVec3(0, 0, 11)).touching);  // a hand that withdraws is free at once
  CHECK(sphere.queries == 1);
  query.takeBack();
  CHECK(askAt(query, 0.22, hip).fresh);
  CHECK(sphere.queries == 2);
}

TEST_CASE("a hand that is put down elsewhere while the query is lent touches nothing, and is reset when it is back") {
  SharedSphere sphere(2, 10);
  LendableQuery query(sphere);
  const std::array<Pose, 2> poses{Pose{.hip = {0, 0, 8}}, Pose{.hip = {8, 0, 0}}};
  query.ask(poses, 0);
  query.lend();
  query.resetHand(1);
  const std::span<const Contact> held = query.ask(poses, 0);
  CHECK(held[0].touching);
  CHECK_FALSE(held[1].touching);
  CHECK(sphere.putDown[1] == 0);
  query.takeBack();
  CHECK(sphere.putDown[0] == 0);
  CHECK(sphere.putDown[1] == 1);
}

TEST_CASE("a lent tool of many points keeps the plane of each, and a force that was given fades") {
  HalfOverPlane plane(8.5);
  LendableQuery tool(plane);
  const Pose pose{.hip = {0, 0, -1}};
  const Contact felt = tool.ask({&pose, 1}, 0).front();
  REQUIRE(felt.touching);
  REQUIRE_FALSE(tool.points(0).empty());
  tool.lend();
  Pose later = pose;
  later.time_s = 0.05;
  const Contact held = tool.ask({&later, 1}, 0).front();
  CHECK(held.touching);
  for (int k = 0; k < 3; ++k) CHECK(held.proxy[k] == within(felt.proxy[k], 1e-9));

  class Water final : public OneHandQuery {
    Contact answerTo(const Pose& at, double) noexcept override {
      return {.proxy = at.hip,
              .normal = {0, 0, 1},
              .touching = true,
              .fresh = true,
              .valid = true,
              .force_N = DVec3(0, 0, 1)};
    }
  } water;
  LendableQuery query(water);
  askAt(query, 0, {});
  query.lend();
  CHECK(askAt(query, 0.004, {}).force_N->z == 1);
  CHECK(askAt(query, 0.0125, {}).force_N->z == near(0.5, 1e-6));
  CHECK(askAt(query, 0.03, {}).force_N->z == 0);
}

}  // namespace palpate::lendable_query_test
