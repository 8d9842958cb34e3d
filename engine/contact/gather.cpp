#include "engine/contact/gather.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/unknown_name.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr double kRounding = 0.05;  // in cells: rounding of positions up to 2^18 cells from the grid's origin
constexpr double kMargin = 1.001;   // of the reach: boxAround() in shaders/lib/cells.glsl

}  // namespace

const std::vector<std::pair<std::string_view, QueryMethod>>& builtMethods() {
  static const auto built = [] {
    std::vector<std::pair<std::string_view, QueryMethod>> methods{{"fused", QueryMethod::fused}};
    for (const GatherKind& kind : gatherKinds()) methods.emplace_back(nameOf(kQueryMethods, kind.method), kind.method);
    return methods;
  }();
  return built;
}

QueryMethod queryMethodNamed(std::string_view name) {
  if (const auto method = valueNamed(builtMethods(), name)) return *method;
  if (valueNamed(kQueryMethods, name))
    throw UsageError("{} needs PALPATE_STUDY, which this palpate was built without", name);
  throw UsageError("{}", unknownName("query method", name, namesOf(builtMethods())));
}

std::uint32_t cellsPerGather(const shared::HashGrid& grid, double radius) {
  const double reach = kMargin * (1.0 + static_cast<double>(shared::kPatchSlack)) * radius;
  const double side = std::floor(2.0 * reach * static_cast<double>(grid.inverseCell) + kRounding) + 2.0;
  return static_cast<std::uint32_t>(std::min(side * side * side, static_cast<double>(shared::kPatchMaxCells)));
}

double widestReach(const shared::HashGrid& grid, std::uint32_t cellsPerSide) {
  return (cellsPerSide - 2.0 - kRounding) / (2.0 * kMargin * static_cast<double>(grid.inverseCell));
}

std::uint32_t gatherRounds(std::uint32_t cells) {
  return (cells + shared::kContactWorkgroup - 1) / shared::kContactWorkgroup;
}

std::unique_ptr<Gather> makeGather(Device& device, QueryMethod method, const shared::HashGrid& grid, double radius,
                                   std::uint32_t points) {
  if (method == QueryMethod::fused) return nullptr;
  for (const GatherKind& kind : gatherKinds())
    if (kind.method == method) return kind.make(device, grid, radius, points);
  throw UsageError("{} needs PALPATE_STUDY, which this palpate was built without", nameOf(kQueryMethods, method));
}

Buffer makeGatheredPatch(Device& device, std::uint64_t slots) {
  constexpr std::uint64_t kHead = sizeof(shared::GatherHeader) + shared::kMaxSegments * sizeof(UVec2);
  Buffer patch(device, kHead + 2 * sizeof(Vec4) * slots, Memory::device, "gathered patch");
  upload(device, patch, std::vector<shared::GatherHeader>(1));
  return patch;
}

}  // namespace palpate
