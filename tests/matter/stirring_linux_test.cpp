// A hand that stirs for a long time.
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "tests/labels.hpp"
#include "tests/matter/matter_scenes.hpp"

#if defined(__SANITIZE_ADDRESS__)
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();  // not every compiler provides its header
#endif

namespace palpate::stirring_test {

namespace {

// Memory of this process. A sanitizer keeps freed memory for long: there, memory allocated and not freed.
std::size_t memoryBytes() {
#if defined(__SANITIZE_ADDRESS__)
  return __sanitizer_get_current_allocated_bytes();
#else
  std::size_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
#endif
}

}  // namespace

TEST_CASE("water stirred for seconds by a hand uses no more memory and releases no energy" * kMoreInFull) {
  MatterScene scene = tank({10, 14, 10}, 7);
  scene.tool = {.radius_mm = 20, .mass_kg = 0.034};
  const auto world = atRest(onCpu(), scene, 1);
  std::size_t early = 0;
  double min_J = 0, mostKinetic_J = 0;
  for (int k = 0; k < byTier(2000, 4000); ++k) {
    const double angle = 0.008 * k, down_m = std::min(5e-4 * k, 0.05);
    const HandPose hand{.place_m = {0.05 + 0.02 * std::cos(angle), 0.11 - down_m, 0.05 + 0.02 * std::sin(angle)}};
    world->step({&hand, 1});
    min_J = std::min(min_J, world->portEnergy_J(0));
    mostKinetic_J = std::max(mostKinetic_J, world->totals().kinetic_J);
    if (k == byTier(500, 1000)) early = memoryBytes();
  }
  REQUIRE(world->state() == MatterState::running);
  CHECK(memoryBytes() < early + (1u << 20));
  CHECK(min_J >= -1e-3);
  CHECK(world->portEnergy_J(0) > 1e-3);
  CHECK(mostKinetic_J < 0.1);
  CHECK(missingMomentum(*world) <= 1e-5);
}

}  // namespace palpate::stirring_test
