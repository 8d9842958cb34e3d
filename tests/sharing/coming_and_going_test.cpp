// ctest: waits
// Clients that come and go, beside one that stays.
#include <doctest/doctest.h>

#include "tests/labels.hpp"
#include "tests/sharing/undoing_hands.hpp"

namespace palpate::coming_and_going_test {

namespace {

const DVec3 kHere(100, 100, 0);
constexpr std::uint32_t kPoint = 100 * 200 + 98, kOther = kPoint + 1;
constexpr float kUp = 0.0625f;  // in the end the point is still near the hand

/// Ends joining when the first points have been requested.
class EarlyEnd final : public LogListener {
 public:
  void said(std::string_view) override {}
  void progressed(std::string_view, double) override { isRequested_ = true; }
  bool isRequested() const { return isRequested_; }

 private:
  std::atomic<bool> isRequested_ = false;
};

void leaveEarly(const std::string& name) {
  EarlyEnd end;
  Log log(true);
  log.listen(&end);
  joinCloud(name, {.network = ownNetwork(), .log = &log, .stop = [&] { return end.isRequested(); }});
}

template <class Hand>
void sculpt(Hand& hand, int before) {
  const float height = kUp * static_cast<float>(before);
  REQUIRE(within(30, [&] {
    hand.follow();
    return hand.at(kPoint).position.z == height;
  }));
  hand.stroke({kPoint}, kUp);
  hand.stroke({kOther}, 1);
  CHECK(hand.undo() == 1);
  REQUIRE(within(30, [&] { return hand.isDelivered(); }));
}

}  // namespace

TEST_CASE("clients join, sculpt, undo and leave two hundred times: each finds the edits of all before it" *
          kMoreInFull) {
  const int times = byTier(9, 200);
  const PointCloud cloud = square();
  Served served(cloud, "coming and going");
  WholeHand stays("coming and going");
  int sculpted = 0;
  for (int i = 0; i < times; ++i) {
    CAPTURE(i);
    switch (i % 3) {
      case 0: {
        WholeHand hand("coming and going");
        sculpt(hand, sculpted++);
        break;
      }
      case 1: {
        FarHand hand("coming and going");
        REQUIRE(hand.comesTo(kHere));
        sculpt(hand, sculpted++);
        break;
      }
      default:  // leaves while it still fetches the points
        CHECK_THROWS_WITH_AS(leaveEarly("coming and going"), doctest::Contains("interrupted after"), NetworkError);
    }
  }
  const float height = kUp * static_cast<float>(sculpted);
  CHECK(within(30, [&] { return stays.at(kPoint).position.z == height; }));
  CHECK(stays.at(kOther).position.z == 0);
  WholeHand late("coming and going");
  CHECK(within(30, [&] { return late.at(kPoint).position.z == height; }));
  const ServedCounts counts = served.end();
  CHECK(counts.refused == 0);
  CHECK(counts.sculptors == static_cast<std::uint64_t>(sculpted));
  for (const PointState& point : served.points()) CHECK(point.position.z == (point.number == kPoint ? height : 0));
}

}  // namespace palpate::coming_and_going_test
