// A late answer is bridged by the tangent plane of the last one, softened by its age.
#include "engine/core/held_contact.hpp"

#include <doctest/doctest.h>

namespace palpate {

namespace {

constexpr Pose kPressed{.time_s = 1, .hip = {0, 0, -2}};

// Two units deep in the plane z = 0.
Contact pressed() {
  return {.proxy = DVec3(0), .normal = {0, 0, 1}, .touching = true, .fresh = true, .valid = true, .neighbours = 7};
}

}  // namespace

TEST_CASE("a late answer is bridged by the tangent plane of the last one and marked as not fresh") {
  const Pose pose{.time_s = 1.002, .hip = {3, 1, -0.5}};
  const Contact held = heldContact(pressed(), kPressed, pose);
  CHECK(held.touching);
  CHECK(held.valid);
  CHECK_FALSE(held.fresh);
  CHECK(held.proxy == DVec3(3, 1, 0));
  CHECK(held.normal == DVec3(0, 0, 1));
  CHECK(held.neighbours == 7);
  CHECK(held.dataTime_s == 1);
  // Above the plane nothing is touched.
  const Contact free = heldContact(pressed(), kPressed, {.time_s = 1.002, .hip = {0, 0, 0.1}});
  CHECK_FALSE(free.touching);
  CHECK_FALSE(free.fresh);
  CHECK(free.valid);
  CHECK(free.proxy == DVec3(0, 0, 0.1));
  CHECK(free.dataTime_s == 1);
}

TEST_CASE(
    "an answer that is held from a bridged one is as old as the data of that one, for a hand that touches or not") {
  Contact last = pressed();
  last.fresh = false;
  last.dataTime_s = 0.97;
  CHECK(heldContact(last, kPressed, {.time_s = 1.002, .hip = {0, 0, -2}}).dataTime_s == 0.97);
  CHECK(heldContact(last, kPressed, {.time_s = 1.002, .hip = {0, 0, 1}}).dataTime_s == 0.97);
  CHECK(heldContact(last, kPressed, {.time_s = 2, .hip = {0, 0, -2}}).dataTime_s == 0.97);
  last.valid = false;
  CHECK(heldContact(last, kPressed, {.time_s = 1.002, .hip = {0, 0, -2}}).dataTime_s < 0);
}

TEST_CASE("a bridged contact moves with its surface and fades out with its age") {
  Contact last = pressed();
  last.velocity = {0, 0, 100};
  CHECK(glm::distance(heldContact(last, kPressed, {.time_s = 1.003, .hip = {0, 0, -2}}).proxy, DVec3(0, 0, 0.3)) <
        1e-9);
  last.velocity = DVec3(0);
  const auto depthAt = [&](double age_s) {
    const Contact held = heldContact(last, kPressed, {.time_s = 1 + age_s, .hip = {0, 0, -2}});
    return held.touching ? held.proxy.z + 2 : 0;
  };
  CHECK(depthAt(0) == 2);
  CHECK(depthAt(0.9 * kStale_s) == 2);
  CHECK(glm::distance(DVec3(depthAt((kStale_s + kStalest_s) / 2)), DVec3(1)) < 1e-9);
  CHECK(depthAt(1.01 * kStalest_s) == 0);
  CHECK(depthAt(1) == 0);
}

TEST_CASE("a fault or a free hand is not bridged by a contact") {
  const Pose pose{.time_s = 1.001, .hip = {0, 0, -2}};
  Contact last = pressed();
  last.touching = false;
  CHECK_FALSE(heldContact(last, kPressed, pose).touching);
  last = pressed();
  last.valid = false;
  const Contact held = heldContact(last, kPressed, pose);
  CHECK_FALSE(held.touching);
  CHECK(held.proxy == pose.hip);
  CHECK(held.dataTime_s < 0);
}

}  // namespace palpate
