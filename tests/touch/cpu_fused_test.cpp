// Depth frames that are fused while they are felt, on the CPU. Needs no GPU.
#include "engine/motion/fused_source.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "tests/touch/fused_scene.hpp"

namespace palpate::cpu_fused_test {

TEST_CASE("depth frames are felt on the CPU while they are fused, and removed objects are no longer felt") {
  checkFusedTouch([](TableStream& stream, double radius) {
    const FusedStream frames = stream.fused(smallMap());
    FusedTouch touch{.source = std::make_unique<FusedSource>(frames)};
    touch.backend = std::make_unique<CpuTouch>(
        *frames.begin, CpuTouchOptions{.radius = radius, .threads = 1, .source = touch.source.get()});
    return touch;
  });
}

}  // namespace palpate::cpu_fused_test
