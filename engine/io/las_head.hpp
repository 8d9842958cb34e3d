// The bytes before the points of a LAS file that is written.
#pragma once

#include "engine/io/las_plan.hpp"

namespace palpate {

/// The header and the records, without the values that depend on the points.
std::vector<std::byte> lasHeadFor(const PointCloud& cloud, const LasPlan& plan);

/// Sets these values: the number of points and of returns, the bounding box, and the end of the points (byte `end`),
/// where further data begins.
void putPointsInto(std::vector<std::byte>& head, const LasPlan& plan, const PointCloud& cloud, std::uint64_t end);

}  // namespace palpate
