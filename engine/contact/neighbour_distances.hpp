#pragma once

#include <cstdint>
#include <optional>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

class Device;

/// Mean distance of each point to its nearest `neighbours`, model units, on the GPU: in a hash whose cells hold about
/// so many, then in coarser and finer ones for the points that are far from others or in a crowd, and for those that
/// are left by a scan of all points. As neighbourDistances() of engine/select, but for the last digits of doubles.
/// Empty where that is not possible, or not sooner: for more than 32 neighbours, for no more points than neighbours, or
/// if too many points are left; and if samples show that this GPU does not round as it must. Waits for the latency
/// queue. Throws OutOfGpuMemory.
std::optional<BareVector<double>> neighbourDistances(Device& device, const PointCloud& cloud, std::uint32_t neighbours,
                                                     unsigned threads = 0);

}  // namespace palpate
