// Faults of devices while a hand presses: the force is zero from then on, and the reason is told in words.
// ctest: waits
#include <algorithm>

#include "haptics/devices/force_dimension_device.hpp"
#include "haptics/devices/openhaptics_device.hpp"
#include "tests/haptics/haply_session.hpp"
#include "tests/haptics/pressing_session.hpp"
#include "tests/says.hpp"

namespace palpate::device_faults_test {
namespace {

struct Fault {
  std::string name;
  std::string script;  ///< of the fake driver; of the Haply service the name of its fault
  std::vector<const char*> words;
  bool ends = true;  ///< the session; otherwise it goes on without a force
  double duration_s = 0.6;
  double fault_s = 0.15;     ///< of a Haply service
  bool isUnreached = false;  ///< not even a force of zero reaches the device any more
  bool isTicked = true;      ///< a tick meets the fault, and stands in the trace with a force of zero
};

/// What a session with a fault left behind.
struct Left {
  ServoResult result;
  std::string words;
  double most_N = 0;
  DVec3 last_N{0};
  std::size_t forcesAfterFault = 0;
  double temperature = 0;
};

/// What holds for every device and every fault.
void check(const Fault& fault, const Left& left) {
  const std::vector<TraceRow>& rows = left.result.trace().rows;
  CHECK(left.result.deviceFailed == fault.ends);
  CHECK(left.result.fault.empty() == !fault.ends);
  for (const char* part : fault.words) CHECK(says(left.words + left.result.fault, part));
  CHECK(left.most_N > 0.1);
  CHECK(left.forcesAfterFault <= 1);  // that of the tick under way
  CHECK((left.last_N == DVec3(0) || fault.isUnreached));
  // The trace is kept, with the contact before the fault and the zero at it.
  REQUIRE(rows.size() > 200);
  CHECK(std::ranges::any_of(rows, [](const TraceRow& row) { return row.contact && glm::length(row.force_N) > 0.1; }));
  if (fault.isTicked) CHECK(rows.back().force_N == DVec3(0));
  if (fault.ends)
    CHECK(static_cast<double>(rows.size()) < 1000 * fault.duration_s - 40);
  else
    CHECK(rows.back().contact);
}

/// `session` opens the device, presses and closes it.
template <class Session>
Left playDriver(const char* library, const Fault& fault, const Session& session) {
  const FakeDriver driver(library, fault.script, kPressing);
  Remarks remarks;
  Left left;
  session(left, remarks);
  const FakeNote note = driver.note();
  CHECK(note.opened == 1);  // no second try
  CHECK(note.closed == 1);
  if (!fault.isUnreached) checkClosed(driver);
  left.words = remarks.text();
  left.most_N = note.mostForce_N;
  left.last_N = driver.lastForce_N();
  left.forcesAfterFault = note.lateForces;
  return left;
}

Left playTouch(const Fault& fault) {
  return playDriver("fake_hd", fault, [&](Left& left, Remarks& remarks) {
    OpenHapticsDevice device({.say = remarks.sink()});
    left.result = pressed(device, fault.duration_s);
    left.temperature = device.motorTemperature();
  });
}

Left playOmega(const Fault& fault) {
  return playDriver("fake_dhd", fault, [&](Left& left, Remarks&) {
    ForceDimensionDevice device;
    left.result = pressed(device, fault.duration_s);
  });
}

Left playHaply(const Fault& fault) {
  HaplyFelt felt =
      feelHaply({.hand = kHaplyPressing, .fault = fault.script, .fault_s = fault.fault_s}, fault.duration_s);
  REQUIRE_MESSAGE(felt.faultBegan_s > 0, felt.said);
  const auto forces = felt.forcesAfterFault();
  MESSAGE("| " << fault.script << " | " << forces.size() << " | "
               << (forces.empty() ? 0 : 1e3 * (forces.back().time_s - felt.faultBegan_s)) << " | "
               << std::string(fault.ends ? "ends" : "goes on") << " |");
  const FakeHaply::Command last = felt.commands.back();
  return {.result = std::move(felt.result),
          .words = felt.said,
          .most_N = most_N(felt.commands),
          .last_N = last.afterFault ? last.force_N : DVec3(0),  // through a closed connection none comes any more
          .forcesAfterFault = forces.size()};
}

/// Returns what the last of the faults left behind.
Left check(Left (*play)(const Fault&), const std::vector<Fault>& faults) {
  Left left;
  for (const Fault& fault : faults) {
    CAPTURE(fault.name);
    left = play(fault);
    check(fault, left);
  }
  return left;
}

}  // namespace

TEST_CASE("a driver error during a touch stops the force as its meaning requires") {
  SUBCASE("the session ends") {
    check(playTouch, {{"no communication: the session ends",
                       "fault error 770 0.45",
                       {"Touch: no communication with the device (0x0302); check cable and power"}},
                      {"the joint data disappear", "fault frozen 0 0.45", {"frozen at (0, -110, -35) mm"}},
                      {"a position that is not a number", "fault nan 0 0.45", {"a position that is not a number"}},
                      {.name = "the driver stops calling",
                       .script = "fault stall 0 0.45",
                       .words = {"has stopped calling"},
                       .duration_s = 30,
                       .isTicked = false}});
  }
  SUBCASE("too fast: no force, then a ramp") {
    const Left left = playTouch({.script = "fault error 515 0.45"});  // 0x0203, once
    CHECK_FALSE(left.result.deviceFailed);
    std::size_t held = 0;
    double before_N = 0, after_N = 0;
    for (const TraceRow& row : left.result.trace().rows) {
      if (row.time_s < 0.445) before_N = glm::length(row.force_N);
      if (row.time_s > 0.445 && row.time_s < 0.47 && row.contact && row.force_N == DVec3(0)) ++held;
      if (row.time_s > 0.59) after_N = glm::length(row.force_N);
    }
    CHECK(before_N > 0.1);
    CHECK(held >= 1);
    CHECK(after_N > 0.01);  // ramping up
    CHECK(after_N < before_N);
  }
  SUBCASE("warm motors: no force until they have cooled down") {
    const Left left =
        playTouch({.script = "fault temperature 0.97 0.42 0.1\nfault error 512 0.42 0.1", .duration_s = 1.2});
    CHECK_FALSE(left.result.deviceFailed);
    CHECK(left.forcesAfterFault == 0);
    CHECK(left.most_N > 0.1);
    CHECK(left.result.counts().withheld.errors >= 1);
  }
  SUBCASE("hot motors that the driver only reports") {
    const Left left = playTouch({.script = "fault temperature 0.97 0.3"});
    CHECK_FALSE(left.result.deviceFailed);
    CHECK(left.temperature == 0.97);
    CHECK(left.result.trace().rows.back().contact);
    CHECK(left.last_N == DVec3(0));
    CHECK(left.result.trace().rows.back().force_N == DVec3(0));
  }
}

TEST_CASE("a stylus that loses its calibration gives no force, says so, and gives one again only in free space") {
  const Left left = check(
      playTouch, {{"uncalibrated",
                   "fault uncalibrated 0 0.45 0.1",
                   {"Touch: the calibration is lost, so the pose is wrong and there is no force; put the stylus into",
                    "Touch: calibrated; the force returns in free space"},
                   false,
                   1}});
  CHECK(left.forcesAfterFault == 0);
}

TEST_CASE("faults of a Force Dimension device are reported with a reason") {
  check(playOmega, {{"a position that is not a number", "fault nan 0 0.45", {"a position that is not a number"}}});
  const Left gone =
      check(playOmega, {{.name = "it disappears during a touch", .script = "fault error 0 0.45", .isUnreached = true}});
  CHECK(gone.result.fault == "omega.3: communication error; check cable and power of the device, and start again");
}

TEST_CASE("a fault of a Haply device takes the force within two ticks, and it stays away while the hand presses") {
  check(playHaply, {{"no calibration", "uncalibrated", {"is not calibrated (purple light)"}, false, 0.9},
                    {"no power supply", "unpowered", {"has no power supply"}, false, 0.9},
                    {"its safety", "safety", {"was stopped by its safety (cyan light)"}, false, 0.9},
                    {"a jump", "jump", {"jumped faster than a hand can move"}, false, 0.9},
                    {"text that is not JSON", "nan", {"sent a message that is not JSON"}, false, 0.9},
                    {"a position that is not a number", "null", {"a position that is not a number"}, false, 0.9},
                    {"gone for a moment", "gone", {"is no longer connected"}, false, 0.9},
                    {"no state for a moment", "mute", {"gives no data (red light)"}, false, 0.9}});
}

TEST_CASE("a Haply device that is lost ends the session without a force") {
  check(playHaply, {{"unplugged", "gone", {"is no longer connected"}, true, 5, 1e9},
                    {"a mute service", "mute", {"gives no data"}, true, 5, 1e9},
                    {"half a frame", "half", {"gives no data"}, true, 5, 1e9},
                    {"a closed connection", "closed", {"the Haply service closed the connection"}, true, 5, 1e9}});
}

}  // namespace palpate::device_faults_test
