#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "haptics/devices/dualsense_report.hpp"
#include "haptics/devices/hid_listener.hpp"
#include "tests/near.hpp"

namespace palpate::hid_report_test {
namespace {

using Report = std::vector<std::uint8_t>;

bool isNear(const DVec3& a, const DVec3& b, double within = 1e-12) { return glm::distance(a, b) <= within; }

/// The report of a DualSense at rest over USB.
Report restingDualSense() {
  Report report(64, 0);
  report[0] = 1;
  report[1] = report[2] = report[3] = report[4] = 128;
  report[8] = 8;  // the directional pad is not pressed
  return report;
}

}  // namespace

TEST_CASE("a 3D mouse's translation is converted to x right, y up and z towards the user") {
  HidMotion motion;
  CHECK(takeSpaceMouseReport(Report{1, 0x5e, 0x01, 0, 0, 0, 0}, motion));  // 350, 0, 0
  CHECK(isNear(motion.push, {1, 0, 0}));
  CHECK(takeSpaceMouseReport(Report{1, 0, 0, 0xaf, 0x00, 0, 0}, motion));  // 0, 175, 0
  CHECK(isNear(motion.push, {0, 0, 0.5}));
  CHECK(takeSpaceMouseReport(Report{1, 0, 0, 0, 0, 0xa2, 0xfe}, motion));  // 0, 0, -350: the cap is lifted
  CHECK(isNear(motion.push, {0, 1, 0}));
  CHECK(isNear(motion.turn, DVec3(0)));
}

TEST_CASE("rotation arrives in its own report or after the translation, and neither form disturbs the other") {
  HidMotion motion;
  CHECK(takeSpaceMouseReport(Report{1, 0x5e, 0x01, 0, 0, 0, 0}, motion));
  CHECK(takeSpaceMouseReport(Report{2, 0, 0, 0x5e, 0x01, 0, 0}, motion));
  CHECK(isNear(motion.push, {1, 0, 0}));
  CHECK(isNear(motion.turn, {0, 0, 1}));
  CHECK(takeSpaceMouseReport(Report{1, 0, 0, 0, 0, 0x5e, 0x01, 0xa2, 0xfe, 0, 0, 0, 0}, motion));
  CHECK(isNear(motion.push, {0, -1, 0}));
  CHECK(isNear(motion.turn, {-1, 0, 0}));
}

TEST_CASE("buttons are one bit each, in any number of bytes") {
  HidMotion motion;
  CHECK(takeSpaceMouseReport(Report{3, 0x02}, motion));
  CHECK(motion.buttons == 2);
  CHECK(takeSpaceMouseReport(Report{3, 0x01, 0x00, 0x80, 0x40, 0xff, 0xff}, motion));
  CHECK(motion.buttons == 0x40800001u);
  CHECK(takeSpaceMouseReport(Report{3, 0x00}, motion));
  CHECK(motion.buttons == 0);
}

TEST_CASE("a deflection beyond the maximum counts as the maximum") {
  HidMotion motion;
  CHECK(takeSpaceMouseReport(Report{1, 0xff, 0x7f, 0x00, 0x80, 0, 0}, motion));
  CHECK(isNear(motion.push, {1, 0, -1}));
}

TEST_CASE("short and foreign reports change nothing") {
  HidMotion motion;
  REQUIRE(takeSpaceMouseReport(Report{1, 0x5e, 0x01, 0, 0, 0, 0}, motion));
  for (const Report& report : {Report{}, Report{1}, Report{3}, Report{1, 0, 0, 0, 0, 0}, Report{2, 0, 0},
                               Report{0, 1, 2, 3, 4, 5, 6}, Report{0x17, 1, 2, 3, 4, 5, 6}, Report(128, 0xff)}) {
    CHECK(!takeSpaceMouseReport(report, motion));
    CHECK(isNear(motion.push, {1, 0, 0}));
  }
  for (std::size_t size = 0; size < 64; ++size) {
    Report report = restingDualSense();
    report.resize(size);
    CHECK(!takeDualSenseReport(report, motion));
  }
  CHECK(isNear(motion.push, {1, 0, 0}));
}

TEST_CASE("random bytes give a push within its range") {
  std::mt19937 random(7);
  HidMotion motion;
  for (int i = 0; i < 20'000; ++i) {
    Report report(random() % 80);
    for (auto& byte : report) byte = static_cast<std::uint8_t>(random());
    if (!report.empty()) report[0] %= 4;
    takeSpaceMouseReport(report, motion);
    takeDualSenseReport(report, motion);
    REQUIRE(isFinite(motion.push));
    REQUIRE(glm::length(motion.push) <= std::sqrt(3.0) + 1e-12);
    REQUIRE(glm::length(shaped(motion.push, 0.1)) <= 1 + 1e-12);
  }
}

TEST_CASE("the left stick of a DualSense moves right and up, the right one away and back") {
  HidMotion motion;
  Report report = restingDualSense();
  CHECK(takeDualSenseReport(report, motion));
  CHECK(glm::length(motion.push) < 0.01);
  CHECK(motion.buttons == 0);
  report[1] = 255;
  report[2] = 0;
  report[4] = 0;
  report[8] = 0x28;  // cross
  report[9] = 0x02;  // R1
  CHECK(takeDualSenseReport(report, motion));
  CHECK(isNear(motion.push, {1, 1, -1}));
  CHECK(motion.buttons == 0x21);
  report[0] = 0x31;  // over Bluetooth the layout differs
  CHECK(!takeDualSenseReport(report, motion));
}

TEST_CASE("the rumble report sets two motors and nothing else") {
  const auto report = dualSenseRumble({.strong = 40, .weak = 200}, kDualSense);
  CHECK(report[0] == 0x02);
  CHECK(report[1] == 0x03);
  CHECK(report[2] == 0);
  CHECK(report[3] == 200);  // right
  CHECK(report[4] == 40);   // left
  for (std::size_t k = 5; k < report.size(); ++k) CHECK(report[k] == 0);
  const auto edge = dualSenseRumble({.strong = 40, .weak = 200}, kDualSenseEdge);
  CHECK(edge[1] == 0x02);
  CHECK(edge[39] == 0x04);
  CHECK(edge[3] == 200);
  CHECK(dualSenseRumble({}, kDualSense)[1] == 0x03);  // silence must be sent, too
}

TEST_CASE("a push has a dead zone, grows progressively and keeps its direction") {
  CHECK(shaped({0.05, 0, 0}, 0.06) == DVec3(0));
  CHECK(shaped({0, 0, 0}, 0) == DVec3(0));
  const double half = glm::length(shaped({0, 0.53, 0}, 0.06));
  const double full = glm::length(shaped({0, 1, 0}, 0.06));
  CHECK(half == near(full / 4, 1e-6));
  CHECK(full == near(1, 1e-6));
  const DVec3 oblique = shaped({0.3, -0.4, 0}, 0.06);
  CHECK(isNear(glm::normalize(oblique), {0.6, -0.8, 0}));
}

}  // namespace palpate::hid_report_test
