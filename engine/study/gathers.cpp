// The table of the query methods that the fused one is compared with.
#include <array>

#include "engine/study/gather_brute.hpp"
#include "engine/study/gather_indirect.hpp"
#include "engine/study/gather_naive.hpp"
#include "engine/study/gather_two_step.hpp"

namespace palpate {

namespace {

template <class Method>
std::unique_ptr<Gather> overCells(Device& device, const shared::HashGrid& grid, double radius, std::uint32_t) {
  return std::make_unique<Method>(device, cellsPerGather(grid, radius));
}

std::unique_ptr<Gather> overPoints(Device& device, const shared::HashGrid& grid, double radius, std::uint32_t points) {
  return std::make_unique<GatherBrute>(device, points,
                                       gatherRounds(cellsPerGather(grid, radius)) * shared::kPatchRoundCandidates);
}

}  // namespace

std::span<const GatherKind> gatherKinds() {
  static constexpr std::array<GatherKind, 4> kinds{{{QueryMethod::indirect, overCells<GatherIndirect>},
                                                    {QueryMethod::naive, overCells<GatherNaive>},
                                                    {QueryMethod::twoStep, overCells<GatherTwoStep>},
                                                    {QueryMethod::brute, overPoints}}};
  return kinds;
}

}  // namespace palpate
