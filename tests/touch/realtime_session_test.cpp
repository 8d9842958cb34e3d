// A session against the wall clock: whatever the GPU does, every tick has an answer, and says where it comes from.
#include <algorithm>

#include "engine/touch/touch_side.hpp"
#include "haptics/path_device.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate {

TEST_CASE("every tick in real time has a valid answer, and is fresh or bridged, at 1 and at 10 kHz") {
  const Scene scene = makeScene("sphere", 20'000);
  Device device({.gpu = "", .validate = false});
  for (const double rate_Hz : {1000.0, 10'000.0}) {
    CAPTURE(rate_Hz);
    TouchSide touch(device, scene.cloud, {.radius = scene.radius});
    PathDevice hand(Path({{0, {0, 0, 52}}, {0.2, {0, 0, 52}}, {0.3, {0, 0, 49}}, {0.5, {4, 0, 49}}}));
    ServoLoop loop(hand, touch, ForceLaw({}, {}), {.rate_Hz = rate_Hz, .duration_s = 0.5, .realtime = true});
    const ServoResult result = loop.run();
    const auto& rows = result.trace.rows;
    const auto fresh = static_cast<std::size_t>(std::ranges::count_if(rows, &TraceRow::fresh));
    CHECK(std::ranges::all_of(rows, &TraceRow::valid));
    CHECK(touch.bridgeTimes_us().size() == rows.size() - fresh);
    CHECK(summarize(result.trace).freshFraction == doctest::Approx(static_cast<double>(fresh) / rows.size()));
    CHECK(rows.size() + result.trace.missedTicks == loop.plannedTicks());
    touch.finish();
  }
}

}  // namespace palpate
