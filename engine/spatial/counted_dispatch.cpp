#include "engine/spatial/counted_dispatch.hpp"

#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

// For a list of some thousand subgroups' work. More take longer to come and go where there is little to do, fewer keep
// a large GPU from being full.
constexpr std::uint32_t kWorkgroups = 528;

}  // namespace

CountedDispatch::CountedDispatch(const Device& device) : direct_(!device.isCpu()) {}

std::uint32_t CountedDispatch::workgroups(Step step) const {
  switch (step) {
    case Step::invocation:
      return kWorkgroups / 8;
    case Step::bucket:
      return kWorkgroups / 2;
    case Step::subgroup:
      break;
  }
  return kWorkgroups;
}

std::uint32_t CountedDispatch::sharedGroups(Step step) const {
  constexpr std::uint32_t kOfSoftware = 16;
  return direct_ ? workgroups(step) / 2 : kOfSoftware;
}

}  // namespace palpate
