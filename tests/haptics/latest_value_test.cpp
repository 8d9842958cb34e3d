#include "haptics/devices/latest_value.hpp"

#include <doctest/doctest.h>

#include <thread>

namespace palpate {
namespace {

struct Five {
  std::uint64_t a = 0, b = 0, c = 0, d = 0;
  std::uint8_t e = 0;
};

}  // namespace

TEST_CASE("nothing is told before the first value, then always the last one") {
  LatestValue<Five> value;
  CHECK(!value.told());
  value.tell({.a = 7, .e = 9});
  REQUIRE(value.told());
  CHECK(value.told()->a == 7);
  CHECK(value.told()->e == 9);
  value.tell({.a = 8});
  CHECK(value.told()->a == 8);
  CHECK(value.told()->e == 0);
}

TEST_CASE("a value is whole or not there, however fast it changes, and never an older one") {
  LatestValue<Five> value;
  std::atomic<bool> stop = false;
  std::jthread teller([&] {
    for (std::uint64_t n = 1; !stop; ++n) value.tell({n, n + 1, n + 2, n + 3, static_cast<std::uint8_t>(n)});
  });
  std::uint64_t last = 0, whole = 0;
  for (int i = 0; i < 2'000'000 || whole == 0; ++i) {
    const auto told = value.told();
    if (!told) continue;
    ++whole;
    const bool fits = told->b == told->a + 1 && told->c == told->a + 2 && told->d == told->a + 3 &&
                      told->e == static_cast<std::uint8_t>(told->a) && told->a >= last;
    if (!fits) stop = true;
    REQUIRE(fits);
    last = told->a;
  }
  stop = true;
  CHECK(whole > 0);
}

}  // namespace palpate
