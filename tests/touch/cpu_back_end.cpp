#include "engine/touch/cpu_touch.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate {

const bool kOnGpu = false;

OnBackEnd::~OnBackEnd() { destroy(); }

std::unique_ptr<TouchBackend> OnBackEnd::make(const PointCloud& cloud, const TouchWanted& wanted) const {
  return std::make_unique<CpuTouch>(cloud, CpuTouchOptions{.radius = wanted.radius,
                                                           .index = wanted.index,
                                                           .friction = wanted.friction,
                                                           .tools = wanted.tools,
                                                           .brush = wanted.brush,
                                                           .threads = wanted.threads,
                                                           .source = wanted.source});
}

}  // namespace palpate
