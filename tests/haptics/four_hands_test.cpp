// Four hands in one session: each behaves as if alone, and all forces stop once one device fails.
#include <deque>

#include "tests/haptics/troubled_hands.hpp"

namespace palpate::four_hands_test {
namespace {

constexpr std::size_t kHands = 4;

/// Onto the sphere from four sides, each at its own time and depth.
Path wayOf(std::size_t hand) {
  const DVec3 sides[kHands]{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-0.6, -0.8, 0}};
  const double begin_s = 0.55 + 0.03 * static_cast<double>(hand), depth = 1 + 0.2 * static_cast<double>(hand);
  return Path({{0, 53.0 * sides[hand]},
               {begin_s, 53.0 * sides[hand]},
               {0.75, (kRadius - depth) * sides[hand]},
               {1, (kRadius - depth) * sides[hand]}});
}

/// Four devices with faults controlled by a test, and their common session.
struct Four {
  std::deque<TroubledDevice> devices;
  Four() {
    for (std::size_t i = 0; i < kHands; ++i) devices.emplace_back(wayOf(i));
  }
  ServoResult play() {
    std::vector<HapticDevice*> all;
    for (TroubledDevice& device : devices) all.push_back(&device);
    return together(all);
  }
};

}  // namespace

TEST_CASE("four hands leave the same traces as each hand alone, byte for byte") {
  Four four;
  const ServoResult result = four.play();
  for (std::size_t i = 0; i < kHands; ++i) {
    CAPTURE(i);
    TroubledDevice device(wayOf(i));
    CHECK(csvOf(result.hands[i].trace) == csvOf(alone(device).trace()));
    CHECK(mostOf(result.hands[i].trace) > 0.3);
  }
}

TEST_CASE("a lifted, clutched or mute hand does not disturb the other three") {
  for (std::size_t troubled = 0; troubled < kHands; ++troubled) {
    CAPTURE(troubled);
    const auto trouble = [&](TroubledDevice& device) {
      device.putDownAt_s = 0.8;
      device.clutchedFrom_s = 0.85;
      device.clutchedTo_s = 0.87;
      device.mutedFrom_s = 0.9;
      device.mutedTo_s = 0.92;
    };
    Four four;
    trouble(four.devices[troubled]);
    const ServoResult result = four.play();
    for (std::size_t i = 0; i < kHands; ++i) {
      CAPTURE(i);
      TroubledDevice calm(wayOf(i)), device(wayOf(i));
      if (i == troubled) trouble(device);
      const std::string own = csvOf(alone(device).trace());
      CHECK(csvOf(result.hands[i].trace) == own);
      CHECK((own == csvOf(alone(calm).trace())) == (i != troubled));
    }
  }
}

TEST_CASE("the query is notified which of four hands was put down") {
  Four four;
  four.devices[2].putDownAt_s = 0.8;
  SharedSphere sphere(kHands);
  std::vector<SessionHand> hands;
  for (TroubledDevice& device : four.devices) hands.push_back(handOf(device));
  ServoLoop(sphere, hands, kSession).run();
  CHECK(sphere.putDown == std::vector<int>{0, 0, 1, 0});
}

TEST_CASE("a fault of one of four devices stops all forces at its tick") {
  for (std::size_t failing = 0; failing < kHands; ++failing)
    for (const bool reading : {true, false}) {
      CAPTURE(failing);
      CAPTURE(reading);
      Four four;
      TroubledDevice& device = four.devices[failing];
      device.text = "the cable is out";
      (reading ? device.failsReadAt_s : device.failsWriteAt_s) = 0.8;
      const ServoResult result = four.play();
      CHECK(result.deviceFailed);
      CHECK(result.fault == "the cable is out");
      for (std::size_t i = 0; i < kHands; ++i) {
        CAPTURE(i);
        const std::vector<TraceRow>& rows = result.hands[i].trace.rows;
        REQUIRE(rows.size() == 801);
        CHECK(glm::length(rows[799].force_N) > 0.1);
        CHECK(rows[800].force_N == DVec3(0));
        CHECK_FALSE(rows[800].valid);
        CHECK(four.devices[i].last_N == DVec3(0));
      }
    }
}

}  // namespace palpate::four_hands_test
