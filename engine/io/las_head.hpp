// What stands before the points of a LAS file that is written.
#pragma once

#include "engine/io/las_plan.hpp"

namespace palpate {

/// The header and what follows it, but for what only the points tell.
std::vector<std::byte> lasHeadFor(const PointCloud& cloud, const LasPlan& plan);

/// That: how many points there are and of which returns, the box around them, and that they end before byte `end`,
/// where what the file has behind them begins.
void putPointsInto(std::vector<std::byte>& head, const LasPlan& plan, const PointCloud& cloud, std::uint64_t end);

}  // namespace palpate
