#include "engine/core/latest_value.hpp"

#include <doctest/doctest.h>

#include <thread>

namespace palpate::latest_value_test {
namespace {

struct Five {
  std::uint64_t a = 0, b = 0, c = 0, d = 0;
  std::uint8_t e = 0;
};

}  // namespace

TEST_CASE("a latest value is empty before the first store, then always the last one stored") {
  LatestValue<Five> value;
  CHECK(!value.load());
  value.store({.a = 7, .e = 9});
  REQUIRE(value.load());
  CHECK(value.load()->a == 7);
  CHECK(value.load()->e == 9);
  value.store({.a = 8});
  CHECK(value.load()->a == 8);
  CHECK(value.load()->e == 0);
}

TEST_CASE("a value loaded during stores is complete or empty, and never older than the last one loaded") {
  LatestValue<Five> value;
  std::atomic<bool> stop = false;
  std::jthread teller([&] {
    for (std::uint64_t n = 1; !stop; ++n) value.store({n, n + 1, n + 2, n + 3, static_cast<std::uint8_t>(n)});
  });
  std::uint64_t last = 0, whole = 0;
  for (int i = 0; i < 2'000'000 || whole == 0; ++i) {
    const auto loaded = value.load();
    if (!loaded) continue;
    ++whole;
    const bool fits = loaded->b == loaded->a + 1 && loaded->c == loaded->a + 2 && loaded->d == loaded->a + 3 &&
                      loaded->e == static_cast<std::uint8_t>(loaded->a) && loaded->a >= last;
    if (!fits) stop = true;
    REQUIRE(fits);
    last = loaded->a;
  }
  stop = true;
  CHECK(whole > 0);
}

}  // namespace palpate::latest_value_test
