#include <doctest/doctest.h>

#include "haptics/servo_loop.hpp"
#include "haptics/simulated_touch.hpp"
#include "tests/allocation_count.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate {
namespace {

/// Counts from the first read to the last write, with everything that happens between ticks.
class CountingDevice final : public HapticDevice {
 public:
  CountingDevice(Path path, double lastTick_s) : touch_(std::move(path), {}), lastTick_s_(lastTick_s) {}
  std::string_view name() const override { return "counting"; }
  DeviceLimits limits() const override { return touch_.limits(); }
  DeviceState read(double time_s) noexcept override {
    counting = time_s < lastTick_s_;
    return touch_.read(time_s);
  }
  bool write(const DVec3& force_N) noexcept override { return touch_.write(force_N); }
  void emergencyStop() noexcept override {}
  std::string faultText() const override { return {}; }

 private:
  SimulatedTouch touch_;
  double lastTick_s_;
};

}  // namespace

TEST_CASE("no tick allocates memory") {
  CountingDevice device(Path({{0, {0, 0, 12}}, {0.05, {0, 0, 8}}, {0.1, {3, 0, 12}}}), 0.095);
  SphereContact sphere(10);
  bool realtime = true;
  SUBCASE("in real time") {}
  SUBCASE("in virtual time") { realtime = false; }
  ServoLoop loop(device, sphere, ForceLaw({}, {}), {.duration_s = 0.1, .realtime = realtime});
  allocations = 0;
  const ServoResult result = loop.run();
  counting = false;
  CHECK(allocations == 0);
  if (!realtime) CHECK(summarize(result.trace).contactTicks > 0);  // a busy machine may miss them

  counting = true;
  int* volatile kept = new int(7);  // volatile, so that no compiler leaves it out
  delete kept;
  counting = false;
  CHECK(allocations == 1);  // the counter counts
}

}  // namespace palpate
