// Two hands in one session, and four: each behaves as if alone, and all forces stop once one device fails.
#include <doctest/doctest.h>

#include <deque>
#include <functional>
#include <thread>

#include "engine/core/error.hpp"
#include "haptics/devices/openhaptics_device.hpp"
#include "haptics/devices/path_device.hpp"
#include "tests/haptics/pressing_session.hpp"
#include "tests/haptics/troubled_hands.hpp"

namespace palpate::two_hands_test {

namespace {

/// From two sides, or from four, each at its own time and depth.
std::vector<Path> waysOf(std::size_t hands) {
  if (hands == 2) return {left(), right()};
  std::vector<Path> ways;
  for (const DVec3& side : {DVec3(0, 0, 1), DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(-0.6, -0.8, 0)}) {
    const auto hand = static_cast<double>(ways.size());
    const double begin_s = 0.55 + 0.03 * hand, depth = 1 + 0.2 * hand;
    ways.push_back(Path(
        {{0, 53.0 * side}, {begin_s, 53.0 * side}, {0.75, (kRadius - depth) * side}, {1, (kRadius - depth) * side}}));
  }
  return ways;
}

/// Devices, by default with faults controlled by a test, and their common session.
template <class Device = TroubledDevice>
struct Hands {
  std::deque<Device> devices;
  explicit Hands(std::size_t hands) {
    for (const Path& way : waysOf(hands)) devices.emplace_back(way);
  }
  ServoResult play() {
    std::vector<HapticDevice*> all;
    for (Device& device : devices) all.push_back(&device);
    return together(all);
  }
};

template <class Device>
void checkAsAlone(std::size_t hands, double felt_N) {
  Hands<Device> all(hands);
  std::vector<std::string> own;
  for (Device& device : all.devices) own.push_back(csvOf(alone(device).trace()));
  const ServoResult result = all.play();
  for (std::size_t i = 0; i < hands; ++i) {
    CAPTURE(i);
    CHECK(csvOf(result.hands[i].trace) == own[i]);
    CHECK(mostOf(result.hands[i].trace) > felt_N);
    CHECK((i == 0 || own[i] != own[0]));
  }
}

/// Each hand in turn has the trouble: it behaves as if alone with it, and the others as if nothing had happened.
void checkUndisturbed(std::size_t hands, const std::function<void(TroubledDevice&)>& trouble) {
  for (std::size_t troubled = 0; troubled < hands; ++troubled) {
    CAPTURE(troubled);
    Hands<> all(hands);
    trouble(all.devices[troubled]);
    const ServoResult result = all.play();
    for (std::size_t i = 0; i < hands; ++i) {
      CAPTURE(i);
      TroubledDevice device(waysOf(hands)[i]);
      const std::string calm = csvOf(alone(device).trace());
      if (i == troubled) trouble(device);
      const std::string own = csvOf(alone(device).trace());
      CHECK(csvOf(result.hands[i].trace) == own);
      CHECK((own == calm) == (i != troubled));
      CHECK(mostOf(result.hands[i].trace) > (i == 0 ? 0.1 : 0.05));
    }
  }
}

/// Each device fails in turn, in a read and in a write: all forces are zero from its tick on, for its reason.
void checkFaults(std::size_t hands) {
  for (std::size_t failing = 0; failing < hands; ++failing)
    for (const bool reading : {true, false}) {
      CAPTURE(failing);
      CAPTURE(reading);
      Hands<> all(hands);
      TroubledDevice& device = all.devices[failing];
      device.text = std::to_string(failing) + ": the cable is out";
      (reading ? device.failsReadAt_s : device.failsWriteAt_s) = 0.8;
      const ServoResult result = all.play();
      CHECK(result.deviceFailed);
      CHECK(result.fault == device.text);
      for (std::size_t i = 0; i < hands; ++i) {
        CAPTURE(i);
        const std::vector<TraceRow>& rows = result.hands[i].trace.rows;
        REQUIRE(rows.size() == 801);
        CHECK(glm::length(rows[799].force_N) > 0.1);
        CHECK(rows[800].force_N == DVec3(0));
        CHECK_FALSE(rows[800].valid);
        CHECK(glm::distance(rows[800].hip, rows[799].hip) < 0.1);
        CHECK(all.devices[i].last_N == DVec3(0));
      }
    }
}

/// Number of times that the query is told of each hand's being put down, if one of them is.
std::vector<int> putDown(std::size_t hands, std::size_t which) {
  Hands<> all(hands);
  all.devices[which].putDownAt_s = 0.8;
  SharedSphere sphere(hands);
  std::vector<SessionHand> session;
  for (TroubledDevice& device : all.devices) session.push_back(handOf(device));
  ServoLoop(sphere, session, kSession).run();
  return sphere.putDown;
}

}  // namespace

TEST_CASE("two hands leave the same traces as each hand alone, byte for byte") {
  SUBCASE("scripts") { checkAsAlone<PathDevice>(2, 0.5); }
  SUBCASE("devices with the limits of a Touch") { checkAsAlone<TroubledDevice>(2, 0.5); }
}

TEST_CASE("four hands leave the same traces as each hand alone, byte for byte") {
  checkAsAlone<TroubledDevice>(4, 0.3);
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
  checkFaults(2);
}

TEST_CASE("a fault of one of four devices stops all forces at its tick") { checkFaults(4); }

TEST_CASE("a fault of either device sets both forces to zero within its tick, before the session ends") {
  /// Reads both forces after the first device's last tick, before the session has ended.
  class Pacing final : public TroubledDevice {
   public:
    explicit Pacing(TroubledDevice& other) : TroubledDevice(left(), {.buttons = 2}, "pacing"), other_(other) {
      pacesItself = true;
    }
    bool pace(double, const std::function<bool()>& tick) override {
      while (tick()) std::this_thread::sleep_for(std::chrono::microseconds(300));
      mineAtEnd_N = last_N;
      otherAtEnd_N = other_.last_N;
      return true;
    }
    DVec3 mineAtEnd_N{9}, otherAtEnd_N{9};

   private:
    TroubledDevice& other_;
  };
  for (const bool reading : {true, false}) {
    CAPTURE(reading);
    TroubledDevice second(right());
    (reading ? second.failsReadAt_s : second.failsWriteAt_s) = 0.8;
    Pacing pacing(second);
    SteppedClock clock;
    const ServoResult result = together({&pacing, &second}, {.duration_s = 1, .realtime = true, .clock = &clock});
    CHECK(result.pacedByDevice);
    CHECK(result.deviceFailed);
    CHECK(result.fault == "troubled: the device failed without saying why");
    CHECK(pacing.most_N > 0.1);
    CHECK(pacing.mineAtEnd_N == DVec3(0));
    CHECK(pacing.otherAtEnd_N == DVec3(0));
  }
}

TEST_CASE("a clutched, mute or newly put down hand does not disturb the other") {
  SUBCASE("clutched") {
    checkUndisturbed(2, [](TroubledDevice& device) {
      device.clutchedFrom_s = 0.78;
      device.clutchedTo_s = 0.85;
    });
  }
  SUBCASE("mute") {
    checkUndisturbed(2, [](TroubledDevice& device) {
      device.mutedFrom_s = 0.75;
      device.mutedTo_s = 0.85;
    });
  }
  SUBCASE("put down") {
    checkUndisturbed(2, [](TroubledDevice& device) { device.putDownAt_s = 0.8; });
  }
}

TEST_CASE("a lifted, clutched or mute hand does not disturb the other three") {
  checkUndisturbed(4, [](TroubledDevice& device) {
    device.putDownAt_s = 0.8;
    device.clutchedFrom_s = 0.85;
    device.clutchedTo_s = 0.87;
    device.mutedFrom_s = 0.9;
    device.mutedTo_s = 0.92;
  });
}

TEST_CASE("the query is notified which hand was put down") { CHECK(putDown(2, 1) == std::vector<int>{0, 1}); }

TEST_CASE("the query is notified which of four hands was put down") {
  CHECK(putDown(4, 2) == std::vector<int>{0, 0, 1, 0});
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
  const FakeDriver leftStylus("fake_hd", firstScript, kPressing);
  const SecondFakeStylus rightStylus(secondScript, rightHand);
  ServoResult result;
  {
    OpenHapticsDevice first({.deviceName = "Left Device", .scheduler = scheduler});
    OpenHapticsDevice second({.deviceName = "Right Device", .scheduler = Scheduler::own});
    CHECK(first.facts().serial == "FAKE-0001");
    CHECK(second.facts().serial == "FAKE-0002");
    SharedSphere sphere(2, 20);
    SteppedClock clock;
    ServoLoop loop(sphere, {{.device = first, .law = softLaw()}, {.device = second, .law = softLaw()}},
                   {.duration_s = 0.6, .realtime = true, .clock = &clock});
    result = loop.run();
  }
  CHECK(result.deviceFailed == !fault.empty());
  CHECK(result.fault.starts_with(fault));
  for (const FakeStylus* stylus : std::initializer_list<const FakeStylus*>{&leftStylus, &rightStylus}) {
    checkClosed(*stylus);
    CHECK(stylus->note().mostForce_N > 0.1);
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
