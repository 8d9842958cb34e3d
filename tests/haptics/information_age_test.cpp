#include "haptics/information_age.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "haptics/devices/path_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"
#include "tests/near.hpp"

namespace palpate::information_age_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

InformationAge::Clock::time_point at(double time_s) {
  return InformationAge::Clock::time_point(
      std::chrono::duration_cast<InformationAge::Clock::duration>(std::chrono::duration<double>(1000 + time_s)));
}

}  // namespace

TEST_CASE("the share of a force that passes follows the table of age and round trip") {
  struct Row {
    double roundTrip_s, age_s, share;
  };
  const std::vector<Row> table{
      {0, 0, 1},   {0, 1, 1},           {0, 1.25, 0.75},     {0, 1.5, 0.5},  {0, 2, 0},
      {0, 100, 0}, {0.1, 1.25, 1},      {0.1, 1.75, 0.5},    {0.1, 2.25, 0}, {1, 3.5, 1},
      {1, 4, 0.5}, {1, 4.5, 0},         {2, 6, 1},           {2, 7, 0},      {60, 6.5, 0.5},
      {60, 7, 0},  {kInfinity, 3.5, 1}, {kInfinity, 4.5, 0}, {kNaN, 3.5, 1}, {kNaN, 4.5, 0},
      {-1, 1, 1},  {-1, 2, 0},          {0, -1, 1},          {0, kNaN, 0},   {1, kInfinity, 0},
  };
  for (const auto& [roundTrip_s, age_s, share] : table) {
    CAPTURE(roundTrip_s);
    CAPTURE(age_s);
    CHECK(shareAt(age_s, ageLimits(roundTrip_s)) == within(share, 1e-9));
  }
  // The limits 1 and 0 are exact, without a jump in between.
  CHECK(shareAt(1, ageLimits(0)) == 1);
  CHECK(shareAt(2, ageLimits(0)) == 0);
  for (double age_s = 0; age_s < 3; age_s += 0.001) {
    const double fall = shareAt(age_s, ageLimits(0)) - shareAt(age_s + 0.001, ageLimits(0));
    CHECK(fall >= 0);
    CHECK(fall < 0.0011);
  }
}

TEST_CASE("received data is half a round trip old, and never makes the known data older") {
  InformationAge known(at(0));
  CHECK(known.age_s(at(0)) == 0);
  CHECK(known.share(at(3.4)) == 1);  // the round trip is still unknown: one second is assumed
  CHECK(known.share(at(4)) == near(0.5, 1e-6));
  known.setRoundTrip(0.2);
  CHECK(known.limits().full_s == near(1.5, 1e-6));
  known.heard(at(4));
  CHECK(known.age_s(at(4)) == near(0.1, 1e-6));
  CHECK(known.share(at(5.3)) == 1);
  CHECK(known.share(at(6.5)) == 0);
  known.setRoundTrip(1.8);
  known.heard(at(4.1));
  CHECK(known.age_s(at(4.1)) == near(0.2, 1e-6));
  CHECK(known.age_s(at(3)) == 0);  // a clock that seems to run backwards
}

TEST_CASE("a fault stops the force for good, and a change is remembered for 0.1 s") {
  InformationAge known(at(0));
  CHECK_FALSE(known.isChanging(at(0)));
  known.changed(at(1));
  CHECK(known.isChanging(at(1)));
  CHECK(known.isChanging(at(1.09)));
  CHECK_FALSE(known.isChanging(at(1.11)));
  CHECK(known.isTrue());
  known.fail();
  known.heard(at(2));
  CHECK_FALSE(known.isTrue());
}

TEST_CASE("the force falls with the age of the last update, and is zero after a fault") {
  // As a silent link would leave it; the wall clock is not simulated.
  const auto ago = [](double age_s) {
    return InformationAge::Clock::now() -
           std::chrono::duration_cast<InformationAge::Clock::duration>(std::chrono::duration<double>(age_s));
  };
  SphereContact sphere(50);
  const auto forceAfter_N = [&](const InformationAge& known) {
    PathDevice script(Path({{0, {0, 0, 49}}, {1, {0, 0, 49}}}));
    ServoLoop loop(script, sphere, ForceLaw({}, {}), {.duration_s = 1, .known = &known});
    const ServoResult result = loop.run();
    CHECK(result.counts().withheld.aged == (known.share() < 1 ? result.trace().rows.size() : 0));
    return glm::length(result.trace().rows.back().force_N);
  };
  CHECK(forceAfter_N(InformationAge(ago(0.5))) == near(0.8, 1e-6));
  const double half_N = forceAfter_N(InformationAge(ago(4)));
  CHECK(half_N < 0.41);
  CHECK(half_N > 0.2);
  CHECK(forceAfter_N(InformationAge(ago(5))) == 0);
  InformationAge failed;
  failed.fail();
  PathDevice script(Path({{0, {0, 0, 49}}, {0.1, {0, 0, 49}}}));
  const ServoResult result = ServoLoop(script, sphere, ForceLaw({}, {}), {.duration_s = 0.1, .known = &failed}).run();
  for (const TraceRow& row : result.trace().rows) REQUIRE(row.force_N == DVec3(0));
}

}  // namespace palpate::information_age_test
