// The adapter through the real dynamic loader, with a simulated driver. Faults while a hand presses:
// device_faults_test.cpp.
#include "haptics/devices/openhaptics_device.hpp"

#include <atomic>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "tests/error_of.hpp"
#include "tests/haptics/pressing_session.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::openhaptics_device_test {
namespace {

struct Felt {
  ServoResult result;
  DeviceLimits limits;
};

Felt feel(const OpenHapticsOptions& options = {}, double duration_s = 0.6) {
  OpenHapticsDevice device(options);
  return {.result = pressed(device, duration_s), .limits = device.limits()};
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
  checkClosed(driver);
  CHECK(driver.note().mostForce_N > 0.2);
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
  SphereContact sphere(20);
  const Trace expected = ServoLoop(touch, sphere, softLaw(), {.duration_s = 0.7}).run().trace();
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
  struct Case {
    std::string name;
    const char *script, *words;
    std::uint32_t closed = 0;
  };
  for (const auto& [name, script, words, closed] :
       {Case{"no cable", "fault init 770",
             "no communication with the device (the driver says: HD_COMM_ERROR, 0x0302); check cable"},
        Case{"two programs on one device", "fault init 769", "another program uses the device"},
        Case{"no licence", "fault init 1536", "no valid licence"},
        Case{"no joint data", "fault frozen", "always reports the position (0, -110, -35) mm", 1}}) {
    CAPTURE(name);
    const FakeDriver driver("fake_hd", script);
    CHECK(says(complaintOf(), words));
    CHECK(driver.note().closed == closed);
  }
  INFO("two users in one program");
  const FakeDriver driver;
  const OpenHapticsDevice first({});
  CHECK(says(complaintOf(), "another program uses the device"));
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
  SphereContact sphere(20);
  std::atomic<bool> stop = false;
  ServoLoop loop(device, sphere, softLaw(), {.duration_s = 30, .realtime = true, .stop = &stop});
  std::thread session([&] { loop.run(); });
  CHECK(driver.waitForForce_N(0.1) >= 0.1);
  const Stopwatch watch;
  device.emergencyStop();
  const double waited_us = watch.elapsed_us();
  if (driver.lastForce_N() != DVec3(0)) {
    // It may wait for some ticks, but not endlessly.
    MESSAGE("this machine is too busy: the driver ran no tick in " << waited_us << " us");
    CHECK(waited_us >= 50'000);
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
