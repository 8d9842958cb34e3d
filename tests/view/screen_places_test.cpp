// The screens of a desktop: which one shows a window, and how it is brought back onto one.
#include "apps/view/screen_places.hpp"

#include <doctest/doctest.h>

#include <array>

namespace palpate::screen_places_test {

namespace {

// A laptop, and a larger screen at its right that begins above it.
constexpr std::array kTwo{DesktopPlace{0, 0, 1920, 1080}, DesktopPlace{1920, -360, 2560, 1440}};
constexpr std::span<const DesktopPlace> kLaptop(kTwo.data(), 1);

}  // namespace

TEST_CASE("the screen of a window is the one that shows most of it, else the nearest one") {
  CHECK(screenOf({100, 100, 900, 600}, kTwo) == 0);
  CHECK(screenOf({2000, 100, 900, 600}, kTwo) == 1);
  CHECK(screenOf({1400, 100, 900, 600}, kTwo) == 0);
  CHECK(screenOf({1500, 100, 900, 600}, kTwo) == 1);
  CHECK(screenOf({6000, 100, 900, 600}, kTwo) == 1);
  CHECK(screenOf({-3000, 100, 900, 600}, kTwo) == 0);
  CHECK_FALSE(screenOf({0, 0, 900, 600}, {}));
}

TEST_CASE("a window whose screen is gone is brought onto one that is there, whole, and else stays where it is") {
  const DesktopPlace onSecond{2400, -200, 1800, 1200};
  CHECK(onScreen(onSecond, kTwo) == onSecond);
  CHECK(onScreen(onSecond, kLaptop) == DesktopPlace{120, 0, 1800, 1080});
  CHECK(onScreen({-700, 900, 900, 600}, kTwo) == DesktopPlace{0, 480, 900, 600});
  CHECK(onScreen(onSecond, {}) == onSecond);
}

}  // namespace palpate::screen_places_test
