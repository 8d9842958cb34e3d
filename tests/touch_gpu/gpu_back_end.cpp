#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate {

const bool kOnGpu = true;

namespace {

Device& deviceFor(Validated validated) {
  if (validated == Validated::fully) return validatedDevice();
  return validated == Validated::core ? coreValidatedDevice() : plainDevice();
}

}  // namespace

OnBackEnd::~OnBackEnd() {
  const GpuFixture ends(deviceFor(validated_));  // its end fails the case if there are messages
  destroy();
}

std::unique_ptr<TouchBackend> OnBackEnd::make(const PointCloud& cloud, const TouchWanted& wanted) const {
  return std::make_unique<TouchSide>(deviceFor(validated_), cloud,
                                     TouchOptions{.radius = wanted.radius,
                                                  .friction = wanted.friction,
                                                  .tools = wanted.tools,
                                                  .brush = wanted.brush,
                                                  .source = wanted.source,
                                                  .paintable = wanted.paintable,
                                                  .index = wanted.index});
}

}  // namespace palpate
