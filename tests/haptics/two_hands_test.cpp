// Two hands in one session: each behaves as if alone, and both forces stop once one device fails.
#include <doctest/doctest.h>

#include <thread>

#include "engine/core/error.hpp"
#include "haptics/devices/openhaptics_device.hpp"
#include "haptics/devices/path_device.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/haptics/troubled_hands.hpp"

namespace palpate::two_hands_test {

TEST_CASE("two hands leave the same traces as each hand alone, byte for byte") {
  const auto check = [](HapticDevice& first, HapticDevice& second) {
    const std::string firstAlone = csvOf(alone(first).trace()), secondAlone = csvOf(alone(second).trace());
    const ServoResult both = together({&first, &second});
    CHECK(csvOf(both.trace()) == firstAlone);
    CHECK(csvOf(both.hands[1].trace) == secondAlone);
    CHECK(mostOf(both.trace()) > 0.5);
    CHECK(mostOf(both.hands[1].trace) > 0.5);
    CHECK(csvOf(both.trace()) != csvOf(both.hands[1].trace));
  };
  SUBCASE("scripts") {
    PathDevice first(left()), second(right());
    check(first, second);
  }
  SUBCASE("devices with the limits of a Touch") {
    TroubledDevice first(left()), second(right());
    check(first, second);
  }
}

TEST_CASE("a second hand has its own map, force and passivity") {
  PathDevice first(left());
  TroubledDevice second(right());
  SharedSphere sphere(2);
  const SessionHand half{.device = second,
                         .law = ForceLaw({.stiffness_N_per_mm = 0.1}, {}),
                         .options = {.map = {.scale = 1, .offset = {0.5, 0, 0}}, .passivity = PassivityMode::observe}};
  const ServoResult result = ServoLoop(sphere, {handOf(first), half}, kSession).run();
  CHECK(result.hands[1].trace.rows[0].hip == DVec3(54.5, 0, 0));
  CHECK_FALSE(result.counts().leastEnergy_mJ);
  CHECK(result.hands[1].counts.leastEnergy_mJ);
  CHECK(mostOf(result.trace()) > 1);
  CHECK(mostOf(result.hands[1].trace) < 0.2);
  CHECK(mostOf(result.hands[1].trace) > 0.05);
}

TEST_CASE("a fault of either device stops both forces and ends the session with that device's reason") {
  for (const bool firstFails : {true, false})
    for (const bool reading : {true, false}) {
      CAPTURE(firstFails);
      CAPTURE(reading);
      TroubledDevice first(left()), second(right());
      first.text = second.text = "";
      TroubledDevice& failing = firstFails ? first : second;
      failing.text = firstFails ? "left: the cable is out" : "right: the cable is out";
      (reading ? failing.failsReadAt_s : failing.failsWriteAt_s) = 0.8;
      const ServoResult result = together({&first, &second});
      CHECK(result.deviceFailed);
      CHECK(result.fault == failing.text);
      for (const Trace* trace : {&result.trace(), &result.hands[1].trace}) {
        REQUIRE(trace->rows.size() == 801);
        CHECK(glm::length(trace->rows[799].force_N) > 0.1);
        CHECK(trace->rows[800].force_N == DVec3(0));
        CHECK_FALSE(trace->rows[800].valid);
        CHECK(glm::distance(trace->rows[800].hip, trace->rows[799].hip) < 0.1);
      }
      CHECK(first.last_N == DVec3(0));
      CHECK(second.last_N == DVec3(0));
    }
}

TEST_CASE("a fault of either device sets both forces to zero within its tick, before the session ends") {
  /// Reads both forces after the first device's last tick, before the session has ended.
  class Pacing final : public HapticDevice {
   public:
    explicit Pacing(TroubledDevice& inner, TroubledDevice& other) : inner_(inner), other_(other) {}
    std::string_view name() const override { return "pacing"; }
    DeviceLimits limits() const override { return inner_.limits(); }
    bool paces() const override { return true; }
    bool pace(double, const std::function<bool()>& tick) override {
      while (tick()) std::this_thread::sleep_for(std::chrono::microseconds(300));
      mineAtEnd_N = inner_.last_N;
      otherAtEnd_N = other_.last_N;
      return true;
    }
    DeviceState read(double time_s) noexcept override { return inner_.read(time_s); }
    bool write(const DVec3& force_N) noexcept override { return inner_.write(force_N); }
    void emergencyStop() noexcept override {}
    std::string faultText() const override { return {}; }
    DVec3 mineAtEnd_N{9}, otherAtEnd_N{9};

   private:
    TroubledDevice &inner_, &other_;
  };
  for (const bool reading : {true, false}) {
    CAPTURE(reading);
    TroubledDevice first(left()), second(right());
    (reading ? second.failsReadAt_s : second.failsWriteAt_s) = 0.8;
    Pacing pacing(first, second);
    ServoOptions options = kSession;
    options.realtime = true;
    SteppedClock clock;
    options.clock = &clock;
    const ServoResult result = together({&pacing, &second}, options);
    CHECK(result.pacedByDevice);
    CHECK(result.deviceFailed);
    CHECK(result.fault == "troubled: the device failed without saying why");
    CHECK(first.most_N > 0.1);
    CHECK(pacing.mineAtEnd_N == DVec3(0));
    CHECK(pacing.otherAtEnd_N == DVec3(0));
  }
}

TEST_CASE("a clutched, mute or newly put down hand does not disturb the other") {
  for (const bool firstIsTroubled : {true, false}) {
    CAPTURE(firstIsTroubled);
    TroubledDevice first(left()), second(right());
    const std::string calm = csvOf(alone(firstIsTroubled ? second : first).trace());
    TroubledDevice& troubled = firstIsTroubled ? first : second;
    SUBCASE("clutched") {
      troubled.clutchedFrom_s = 0.78;
      troubled.clutchedTo_s = 0.85;
    }
    SUBCASE("mute") {
      troubled.mutedFrom_s = 0.75;
      troubled.mutedTo_s = 0.85;
    }
    SUBCASE("put down") { troubled.putDownAt_s = 0.8; }
    const std::string own = csvOf(alone(troubled).trace());
    const ServoResult both = together({&first, &second});
    CHECK(csvOf(firstIsTroubled ? both.hands[1].trace : both.trace()) == calm);
    CHECK(csvOf(firstIsTroubled ? both.trace() : both.hands[1].trace) == own);
    CHECK(mostOf(both.trace()) > 0.1);
    CHECK(mostOf(both.hands[1].trace) > 0.05);
  }
}

TEST_CASE("the query is notified which hand was put down") {
  TroubledDevice first(left()), second(right());
  second.putDownAt_s = 0.8;
  SharedSphere sphere(2);
  ServoLoop(sphere, {handOf(first), handOf(second)}, kSession).run();
  CHECK(sphere.putDown == std::vector<int>{0, 1});
}

TEST_CASE("a session has as many hands as its query answers, and at least one") {
  PathDevice first(left()), second(right());
  SphereContact one(kRadius);
  SharedSphere two(2);
  CHECK_THROWS_WITH_AS(ServoLoop(one, {handOf(first), handOf(second)}, kSession),
                       doctest::Contains("a session of 2 hands, and a back end for 1"), UsageError);
  CHECK_THROWS_AS(ServoLoop(two, {handOf(first)}, kSession), UsageError);
  CHECK_THROWS_AS(ServoLoop(one, {}, kSession), UsageError);
}

TEST_CASE("forces are switched off for both hands") {
  TroubledDevice first(left()), second(right());
  const std::atomic<bool> off = false;
  ServoOptions options = kSession;
  options.forcesOn = &off;
  const ServoResult result = together({&first, &second}, options);
  CHECK(first.most_N == 0);
  CHECK(second.most_N == 0);
  CHECK(summarize(result.hands[1].trace).contactTicks > 100);
}

TEST_CASE("a second device cannot pace the ticks, nor be braked if it does not yield") {
  TroubledDevice first(left()), second(right());
  SharedSphere sphere(2);
  second.pacesItself = true;
  ServoOptions options = kSession;
  const auto made = [&](const SessionHand& hand) { ServoLoop(sphere, {handOf(first), hand}, options); };
  CHECK_NOTHROW(made(handOf(second)));  // in virtual time no device paces
  options.realtime = true;
  CHECK_THROWS_WITH_AS(made(handOf(second)), doctest::Contains("only the first one may"), UsageError);
  PathDevice script(right());
  const SessionHand braked{.device = script, .law = ForceLaw({}, {}), .options = {.passivity = PassivityMode::on}};
  CHECK_THROWS_AS(made(braked), UsageError);
}

TEST_CASE("two styluses of one driver feel the same sphere at once, and both end without force") {
  const char* const leftHand = "0,0,26,0\n0.1,0,26,0\n0.4,0,18,0\n";
  const char* const rightHand = "0,26,0,0\n0.1,26,0,0\n0.4,17,0,0\n";
  std::string firstScript, secondScript, fault;
  Scheduler scheduler = Scheduler::device;
  SUBCASE("on the driver's scheduler") {}
  SUBCASE("on palpate's own") { scheduler = Scheduler::own; }
  SUBCASE("until the right one fails") {
    secondScript = "fault error 770 0.45";
    fault = "Right Device: no communication with the device (0x0302)";
  }
  SUBCASE("until the left one fails") {
    firstScript = "fault error 770 0.45";
    fault = "Left Device: no communication with the device (0x0302)";
  }
  const FakeDriver leftStylus("fake_hd", firstScript, leftHand);
  const SecondFakeStylus rightStylus(secondScript, rightHand);
  ServoResult result;
  {
    OpenHapticsDevice first({.deviceName = "Left Device", .scheduler = scheduler});
    OpenHapticsDevice second({.deviceName = "Right Device", .scheduler = Scheduler::own});
    CHECK(first.facts().serial == "FAKE-0001");
    CHECK(second.facts().serial == "FAKE-0002");
    SharedSphere sphere(2, 20);
    SteppedClock clock;
    const ForceLaw law({.stiffness_N_per_mm = 0.4}, {});
    ServoLoop loop(sphere, {{.device = first, .law = law}, {.device = second, .law = law}},
                   {.duration_s = 0.6, .realtime = true, .clock = &clock});
    result = loop.run();
  }
  CHECK(result.deviceFailed == !fault.empty());
  CHECK(result.fault.starts_with(fault));
  for (const FakeStylus* stylus :
       {static_cast<const FakeStylus*>(&leftStylus), static_cast<const FakeStylus*>(&rightStylus)}) {
    const FakeNote note = stylus->note();
    CHECK(note.threadFaults == 0);
    CHECK(note.frameFaults == 0);
    CHECK(note.opened == 1);
    CHECK(note.closed == 1);
    CHECK(note.enabled == 0);
    CHECK(note.mostForce_N > 0.1);
    CHECK(stylus->lastForce_N() == DVec3(0));
  }
  REQUIRE(result.trace().rows.size() > 300);
  const TraceRow &first = result.trace().rows[result.trace().rows.size() - 2],
                 &second = result.hands[1].trace.rows[result.trace().rows.size() - 2];
  REQUIRE(first.contact);
  REQUIRE(second.contact);
  CHECK(first.force_N.y > 0.1);  // each is pushed out on its own side
  CHECK(second.force_N.x > 0.1);
  CHECK(std::abs(first.force_N.x) < 0.01);
  CHECK(std::abs(second.force_N.y) < 0.01);
}

}  // namespace palpate::two_hands_test
