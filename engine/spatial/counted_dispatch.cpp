#include "engine/spatial/counted_dispatch.hpp"

#include "engine/gpu/device.hpp"

namespace palpate {

CountedDispatch::CountedDispatch(const Device& device) : direct_(!device.isCpu()) {}

// More take longer to come and go where there is little to do, fewer keep a large GPU from being full.
std::uint32_t CountedDispatch::workgroups(Step step) const { return step == Step::subgroup ? 528 : 64; }

std::uint32_t CountedDispatch::sharedGroups(Step step) const {
  constexpr std::uint32_t kOfSoftware = 16;
  return direct_ ? workgroups(step) / 2 : kOfSoftware;
}

}  // namespace palpate
