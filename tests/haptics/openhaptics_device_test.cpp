// The adapter through the real dynamic loader, with a simulated driver.
#include "haptics/devices/openhaptics_device.hpp"

#include <atomic>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/error_of.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::openhaptics_device_test {
namespace {

constexpr double kRadius = 20;
/// From outside down onto the sphere's pole, 2 mm deep, and still there at the end.
const char* const kPressing = "0,0,26,0\n0.1,0,26,0\n0.4,0,18,0\n";

struct Felt {
  ServoResult result;
  DeviceLimits limits;
};

// Ticks of the session equal ticks of the driver, however rarely the driver runs.
Felt feel(const OpenHapticsOptions& options = {}, double duration_s = 0.6) {
  OpenHapticsDevice device(options);
  SphereContact sphere(kRadius);
  SteppedClock clock;
  ServoLoop loop(device, sphere, ForceLaw({.stiffness_N_per_mm = 0.4}, {}),
                 {.duration_s = duration_s, .realtime = true, .clock = &clock});
  Felt felt{.result = loop.run(), .limits = device.limits()};
  return felt;
}

std::string complaintOf(const OpenHapticsOptions& options = {.calibrationPatience_s = 0.2}) {
  return errorOf([&] { const OpenHapticsDevice device(options); });
}

}  // namespace

TEST_CASE("a stylus presses on a sphere, on the driver's scheduler and on palpate's own") {
  const FakeDriver driver("fake_hd", "", kPressing);
  Scheduler scheduler = Scheduler::device;
  SUBCASE("the driver's") {}
  SUBCASE("palpate's own") { scheduler = Scheduler::own; }
  const Felt felt = feel({.scheduler = scheduler});
  CHECK_FALSE(felt.result.deviceFailed);
  CHECK(felt.result.fault.empty());
  CHECK(felt.limits.peakForce_N == 3.3);
  CHECK(felt.limits.continuousForce_N == 0.88);
  CHECK(felt.limits.mostStiffness_N_per_mm == 0.4);
  const FakeNote note = driver.note();
  CHECK(note.threadFaults == 0);
  CHECK(note.frameFaults == 0);
  CHECK(note.opened == 1);
  CHECK(note.closed == 1);
  CHECK(note.enabled == 0);  // forces were on, and are off again
  CHECK(note.mostForce_N > 0.2);
  CHECK(driver.lastForce_N() == DVec3(0));
  REQUIRE(felt.result.trace().rows.size() > 300);
  // The force is that of the surface at the stylus's position, and points up.
  const TraceRow& last = felt.result.trace().rows.back();
  REQUIRE(last.contact);
  CHECK(last.force_N.y > 0.2);
}

TEST_CASE("the closed loop through the driver equals that of the simulated Touch") {
  const std::string hand = "0,0,26,0\n0.1,0,26,0\n0.4,0,18,0\n0.5,2,18.5,1\n0.6,2,26,0\n";
  const FakeDriver driver("fake_hd", "skip 1", hand);
  const Felt felt = feel({}, 0.7);
  SimulatedTouch touch(readPathCsv(driver.folder() / "hand.csv"), {});
  SphereContact sphere(kRadius);
  ServoLoop loop(touch, sphere, ForceLaw({.stiffness_N_per_mm = 0.4}, {}), {.duration_s = 0.7});
  const Trace expected = loop.run().trace();
  CHECK(felt.result.trace().missedTicks == 0);
  const auto& rows = felt.result.trace().rows;
  REQUIRE(rows.size() == 700);
  double most_N = 0, worst_N = 0;
  for (std::size_t tick = 0; tick < rows.size(); ++tick) {
    worst_N = std::max(worst_N, glm::distance(rows[tick].force_N, expected.rows[tick].force_N));
    most_N = std::max(most_N, glm::length(rows[tick].force_N));
  }
  CHECK(worst_N <= 1e-6);
  CHECK(most_N > 0.2);
}

TEST_CASE("the driver's first device is opened, or the named one") {
  const FakeDriver driver;
  CHECK(OpenHapticsDevice({.deviceName = "Left Device"}).facts().serial == "FAKE-0001");
  CHECK(OpenHapticsDevice({}).name() == "Touch");
  const std::string text = complaintOf({.deviceName = "Nobody"});
  CHECK(says(text, "the device 'Nobody' cannot be opened"));
  CHECK(says(text, "0x0303"));
  CHECK(says(text, "Touch_Setup"));
}

TEST_CASE("a driver that cannot open the device reports why") {
  SUBCASE("no cable") {
    const FakeDriver driver("fake_hd", "fault init 770");  // 0x0302
    const std::string text = complaintOf();
    CHECK(says(text, "no communication with the device (the driver says: HD_COMM_ERROR, 0x0302); check cable"));
  }
  SUBCASE("two programs on one device") {
    const FakeDriver driver("fake_hd", "fault init 769");
    CHECK(says(complaintOf(), "another program uses the device"));
  }
  SUBCASE("two users in one program") {
    const FakeDriver driver;
    const OpenHapticsDevice first({});
    CHECK(says(complaintOf(), "another program uses the device"));
  }
  SUBCASE("no licence") {
    const FakeDriver driver("fake_hd", "fault init 1536");
    CHECK(says(complaintOf(), "no valid licence"));
  }
  SUBCASE("no joint data") {
    const FakeDriver driver("fake_hd", "fault frozen");
    CHECK(says(complaintOf(), "always reports the position (0, -110, -35) mm"));
    CHECK(driver.note().closed == 1);
  }
}

TEST_CASE("a session waits for a stylus that must be in its inkwell to calibrate") {
  std::vector<std::string> words;
  const OpenHapticsOptions options{.calibrationPatience_s = 30,
                                   .say = [&](const std::string& text) { words.push_back(text); }};
  SUBCASE("until it is there") {
    const FakeDriver driver("fake_hd", "fault calibration 5");
    const OpenHapticsDevice device(options);
    REQUIRE(words.size() == 2);
    CHECK(says(words[0], "put the stylus into the inkwell"));
    CHECK(says(words[1], "calibrated"));
  }
  SUBCASE("not forever") {
    const FakeDriver driver("fake_hd", "fault calibration 100000");
    CHECK(says(complaintOf(), "was not calibrated within 0.2 s; put the stylus into the inkwell"));
    CHECK(driver.note().closed == 1);
  }
  SUBCASE("not after the user cancels") {
    const FakeDriver driver("fake_hd", "fault calibration 100000");
    std::atomic<bool> stop = true;
    CHECK(says(complaintOf({.stop = &stop}), "interrupted"));
  }
}

TEST_CASE("a stylus that loses its calibration gives no force, says so, and gives one again only in free space") {
  std::mutex guard;
  std::string words;
  const auto say = [&](const std::string& text) {
    const std::scoped_lock lock(guard);
    words += text + "\n";
  };
  const FakeDriver driver("fake_hd", "fault uncalibrated 0 0.45 0.1", kPressing);
  const Felt felt = feel({.say = say}, 1);
  CHECK_FALSE(felt.result.deviceFailed);
  CHECK(driver.note().mostForce_N > 0.1);
  CHECK(driver.note().lateForces == 0);
  CHECK(felt.result.trace().rows.back().contact);
  CHECK(felt.result.trace().rows.back().force_N == DVec3(0));
  CHECK(says(words, "Touch: the calibration is lost, so the pose is wrong and there is no force; put the stylus into"));
  CHECK(says(words, "Touch: calibrated; the force returns in free space"));
}

TEST_CASE("a driver error during a touch stops the force as its meaning requires") {
  SUBCASE("no communication: the session ends") {
    const FakeDriver driver("fake_hd", "fault error 770 0.45", kPressing);
    const Felt felt = feel();
    CHECK(felt.result.deviceFailed);
    CHECK(says(felt.result.fault, "Touch: no communication with the device (0x0302); check cable and power"));
    CHECK(felt.result.trace().rows.size() < 560);
    CHECK(driver.note().mostForce_N > 0.1);
    CHECK(driver.lastForce_N() == DVec3(0));
    CHECK(felt.result.trace().rows.back().force_N == DVec3(0));
  }
  SUBCASE("too fast: no force, then a ramp") {
    const FakeDriver driver("fake_hd", "fault error 515 0.45", kPressing);  // 0x0203, once
    const Felt felt = feel();
    CHECK_FALSE(felt.result.deviceFailed);
    std::size_t held = 0;
    double before_N = 0, after_N = 0;
    for (const TraceRow& row : felt.result.trace().rows) {
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
    const FakeDriver driver("fake_hd", "fault temperature 0.97 0.42 0.1\nfault error 512 0.42 0.1", kPressing);
    const Felt felt = feel({}, 1.2);
    CHECK_FALSE(felt.result.deviceFailed);
    CHECK(driver.note().lateForces == 0);
    CHECK(driver.note().mostForce_N > 0.1);
    CHECK(felt.result.counts().withheld.errors >= 1);
  }
  SUBCASE("hot motors that the driver only reports") {
    const FakeDriver driver("fake_hd", "fault temperature 0.97 0.3", kPressing);
    OpenHapticsDevice device({});
    SphereContact sphere(kRadius);
    SteppedClock clock;
    ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = 0.6, .realtime = true, .clock = &clock});
    const ServoResult result = loop.run();
    CHECK_FALSE(result.deviceFailed);
    CHECK(device.motorTemperature() == 0.97);
    CHECK(result.trace().rows.back().contact);
    CHECK(driver.lastForce_N() == DVec3(0));
    CHECK(result.trace().rows.back().force_N == DVec3(0));
  }
  SUBCASE("the joint data disappear") {
    const FakeDriver driver("fake_hd", "fault frozen 0 0.45", kPressing);
    const Felt felt = feel();
    CHECK(felt.result.deviceFailed);
    CHECK(says(felt.result.fault, "frozen at (0, -110, -35) mm"));
    CHECK(driver.lastForce_N() == DVec3(0));
  }
  SUBCASE("a position that is not a number") {
    const FakeDriver driver("fake_hd", "fault nan 0 0.45", kPressing);
    const Felt felt = feel();
    CHECK(felt.result.deviceFailed);
    CHECK(says(felt.result.fault, "a position that is not a number"));
    CHECK(driver.lastForce_N() == DVec3(0));
  }
  SUBCASE("the driver stops calling") {
    const FakeDriver driver("fake_hd", "fault stall 0 0.45", kPressing);
    const Felt felt = feel({}, 30);
    CHECK(felt.result.deviceFailed);
    CHECK(says(felt.result.fault, "has stopped calling"));
    CHECK(driver.lastForce_N() == DVec3(0));
  }
}

TEST_CASE("a stylus reports its orientation if its driver knows it") {
  DQuat expected(0.5, 0.5, -0.5, 0.5);
  std::string script = "turn 0.5 0.5 -0.5 0.5";
  SUBCASE("it knows") {}
  SUBCASE("it does not") {
    script += "\nfault no-transform";
    expected = DQuat(1, 0, 0, 0);
  }
  const FakeDriver driver("fake_hd", script);
  OpenHapticsDevice device({.scheduler = Scheduler::own});
  const DeviceState state = device.read(0);
  REQUIRE(state.ok);
  CHECK(state.rendersForce);
  CHECK(std::abs(glm::dot(state.turn, expected)) == near(1, 1e-12));
  CHECK(device.write(DVec3(0)));
}

TEST_CASE("a device with less force than others of its kind gets no more") {
  const FakeDriver driver("fake_hd", "fault weak");
  CHECK(OpenHapticsDevice({}).limits().peakForce_N == 1.5);
}

TEST_CASE("a force that is not a number, or exceeds the device's limit, does not reach it") {
  const FakeDriver driver;
  OpenHapticsDevice device({.scheduler = Scheduler::own});
  REQUIRE(device.read(0).ok);
  CHECK(device.write({0, 5, 0}));
  CHECK(driver.lastForce_N() == DVec3(0, 3.3, 0));
  REQUIRE(device.read(0).ok);
  CHECK_FALSE(device.write({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
  CHECK(driver.lastForce_N() == DVec3(0));
  REQUIRE(device.read(0).ok);
  device.emergencyStop();
  CHECK(device.write({0, 1, 0}));
  CHECK(driver.lastForce_N() == DVec3(0));
}

TEST_CASE("a closed device is left without force") {
  const FakeDriver driver;
  {
    OpenHapticsDevice device({.scheduler = Scheduler::own});
    REQUIRE(device.read(0).ok);
    CHECK(device.write({0, 1, 0}));
    CHECK(driver.lastForce_N() == DVec3(0, 1, 0));
  }
  CHECK(driver.lastForce_N() == DVec3(0));
}

TEST_CASE("an emergency stop from another thread waits for the driver to send the zero") {
  const FakeDriver driver("fake_hd", "", kPressing);
  OpenHapticsDevice device({});
  SphereContact sphere(kRadius);
  std::atomic<bool> stop = false;
  ServoLoop loop(device, sphere, ForceLaw({.stiffness_N_per_mm = 0.4}, {}),
                 {.duration_s = 30, .realtime = true, .stop = &stop});
  std::thread session([&] { loop.run(); });
  CHECK(driver.waitForForce_N(0.1) >= 0.1);
  const Stopwatch watch;
  device.emergencyStop();
  const double waited_us = watch.elapsed_us();
  if (driver.lastForce_N() != DVec3(0)) {
    // It may wait for some ticks, but not endlessly.
    MESSAGE("this machine is too busy: the driver ran no tick in " << waited_us << " us");
    CHECK(waited_us >= 5000);
  }
  CHECK(driver.waitForZero());
  stop = true;
  session.join();
}

TEST_CASE("the driver's servo loop takes another rate, or reports that it cannot") {
  const FakeDriver driver("fake_hd", "", kPressing);
  CHECK(OpenHapticsDevice({.rate_Hz = 500}).name() == "Touch");
  CHECK(says(complaintOf({.rate_Hz = 777}), "does not run at 777 Hz; use a rate of 1000 Hz"));
}

TEST_CASE("every error of the driver has a meaning and advice") {
  using hdapi::Severity;
  for (const std::uint32_t code :
       {0x100u, 0x101u, 0x102u, 0x103u, 0x104u, 0x200u, 0x201u, 0x202u, 0x203u, 0x204u, 0x300u,
        0x301u, 0x302u, 0x303u, 0x304u, 0x400u, 0x401u, 0x402u, 0x500u, 0x501u, 0x600u}) {
    const hdapi::ErrorMeaning& meaning = hdapi::meaningOf(code);
    CHECK(meaning.code == code);
    CHECK(meaning.severity != Severity::none);
    CHECK(std::strlen(meaning.words) > 5);
    CHECK(std::strlen(meaning.advice) > 5);
    if (code >= 0x300) CHECK(meaning.severity == Severity::end);
  }
  CHECK(hdapi::meaningOf(0x0200).severity == Severity::pause);
  CHECK(hdapi::meaningOf(0x0202).severity == Severity::rampBack);
  CHECK(hdapi::meaningOf(0x7777).severity == Severity::end);  // unknown codes are not trusted
  CHECK(hdapi::meaningOf(0).severity == Severity::none);
}

}  // namespace palpate::openhaptics_device_test
