// The GPU is lost while a command has the query of a live session.
#include <doctest/doctest.h>

#include "engine/gpu/device.hpp"
#include "haptics/session/vulkan_backend.hpp"
#include "tests/labels.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"
#include "tests/session/command_storm.hpp"

namespace palpate::lost_command_test {

TEST_CASE("a command during which the GPU is lost fails, and the session ends without force" * kMoreInFull) {
  for (const bool atSubmit : {false, true}) {
    if (atSubmit && !inFullTier()) continue;
    CAPTURE(atSubmit);
    const LostGpuLayer layer;
    Device device({.gpu = "", .validation = Validation::off});
    const auto kind = vulkanBackend([&]() -> Device& { return device; }, [](Device&) { return std::string(); });
    const auto takeGpu = LostGpuLayer::takeGpu();
    PressingHand hand;
    const auto clock = std::make_shared<SteppedClock>();
    Session session(stormy(*kind, "sphere"), sphereModel(), {.backend = *kind, .threads = 1, .keepsPoints = true});
    session.start({hand.hand()}, {.clock = clock});
    clock->goOnTo(1);
    std::vector<TraceRow> rows;
    session.live()->take(rows);
    REQUIRE(rows.back().force_N != DVec3(0));
    takeGpu(atSubmit);
    CHECK_THROWS_AS(session.setContact({.kind = SurfaceKind::sphere}, {}, ""), GpuError);
    clock->goOnTo(1.5);
    CHECK_FALSE(session.isLive());
    session.stop();
    CHECK(session.live()->fault().find("was lost") != std::string::npos);
    session.live()->take(rows);
    CHECK(rows.back().force_N == DVec3(0));
    CHECK(hand.last_N() == DVec3(0));
    CHECK_THROWS_AS(session.setBrush(std::nullopt), GpuError);  // after the end: an error, and no hang
  }
}

}  // namespace palpate::lost_command_test
