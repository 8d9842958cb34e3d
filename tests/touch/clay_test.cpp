// What a stroke leaves is what the hand meant: how deep, how high, how many layers, by analytic truth. Needs no GPU.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "tests/clay.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::clay_test {

TEST_CASE("table" * doctest::skip()) {
  const char* shape = std::getenv("CLAY_SHAPE");
  const Scene scene = makeScene(shape ? shape : "plane", std::getenv("CLAY_N") ? atoi(std::getenv("CLAY_N")) : 20'000);
  for (const BrushKind kind :
       {BrushKind::push, BrushKind::carve, BrushKind::flatten, BrushKind::inflate, BrushKind::smooth, BrushKind::grab})
    for (const double speed : {20.0, 100.0, 500.0})
      for (const double depth : {2.0, 3.0, 4.0, 9.0, 18.0})
        for (const int every : {1, 3}) {
          if (every > 1 && speed < 100) continue;
          const ClayGesture gesture = clayDrag(scene, depth, speed);
          CpuTouch touch(scene.cloud, {.radius = scene.radius, .brush = clayBrush(kind)});
          const ClayResult r = mould(touch, scene, gesture, every);
          fmt::print(
              "{:8} {:4} mm/s {:4} mm 1/{}: deepest {:.2f} highest {:.2f} trench {:.2f}..{:.2f} new {} changed {} "
              "second {:.1f}%\n",
              std::string(std::ranges::find(kBrushKinds, kind, &std::pair<std::string_view, BrushKind>::second)->first),
              speed, depth, every, r.deepest, r.highest, r.trenchLeast, r.trenchMost, r.added, r.changed,
              100 * r.secondLayer);
        }
}

}  // namespace palpate::clay_test
