#include "engine/spatial/counted_dispatch.hpp"

#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

// For a list with work for some thousand subgroups. More workgroups have a higher overhead on short lists, fewer cannot
// fill a large GPU.
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
