// The proxy on the GPU against double precision, on sheets.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/contact/contact_reference.hpp"
#include "engine/core/clock.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/contact/sheet.hpp"
#include "tests/labels.hpp"

namespace palpate::proxy_gpu_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE("the GPU feels both faces, the edges and the friction of sheets as double precision does") {
  Device device(
      {.gpu = "", .validation = Validation::off});  // surfaces_gpu_test.cpp runs the same shader with validation
  for (const double thickness : {0.0, 0.4}) {
    CAPTURE(thickness);
    const PointCloud cloud = sheet(thickness);
    TouchSide gpu(device, cloud, {.radius = kSheetRadius, .surface = SurfaceKind::sharp, .friction = 0.3});
    ContactReference cpu(cloud, {.radius = kSheetRadius, .kind = SurfaceKind::sharp}, 0.3);
    std::size_t touched = 0, differ = 0;
    double worst = 0;
    for (int i = 0; i < 700; ++i) {  // down and up through the plane, from the middle of the sheet to past its edge
      const DVec3 hip(0.033 * i, 0.1 + 0.01 * i, -0.2 + 3.5 * std::cos(0.06 * i));
      const Contact a = gpu.query({.hip = hip}, 0), b = cpu.query({.hip = hip}, 0);
      touched += b.touching;
      differ += a.touching != b.touching;
      if (a.touching && b.touching) worst = std::max(worst, glm::distance(a.proxy, b.proxy) / kSheetRadius);
    }
    CHECK(touched > 200);
    CHECK(differ == 0);
    CHECK(worst < 1e-4);
    gpu.finish();
  }
}

TEST_CASE("a hand that jumps beyond the range of single precision neither hangs the GPU nor spoils later contacts") {
  Device device({.gpu = "", .validation = Validation::off});
  const PointCloud cloud = sheet(0.0);
  TouchSide touch(device, cloud, {.radius = kSheetRadius});
  const auto press = [&] {
    Contact contact;
    for (const double z : {2.0, 1.0, -0.3}) contact = touch.query({.hip = {8, 8, z}}, 0);
    return contact;
  };
  const Contact before = press();
  for (const double far : {1e300, -1e300, 3e38, -3e38, 1e30}) {
    CAPTURE(far);
    REQUIRE(press().touching);  // from a contact, so that the displacement to the next position is not finite
    const Stopwatch watch;
    CHECK_FALSE(touch.query({.hip = {far, -far, std::abs(far)}}, 0).touching);
    CHECK(watch.elapsed_us() < 2e6);
    for (const double z : {50.0, 4.0}) touch.query({.hip = {8, 8, z}}, 0);
    CHECK(press().proxy == before.proxy);
    for (const double z : {4.0, 50.0}) touch.query({.hip = {8, 8, z}}, 0);
  }
  touch.finish();
}

TEST_SUITE_END();

}  // namespace palpate::proxy_gpu_test
