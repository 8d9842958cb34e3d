// What the touch side's options mean for its parts.
#pragma once

#include "engine/touch/edit_pipeline.hpp"
#include "engine/touch/touch_options.hpp"

namespace palpate {

/// RGBA8 of every point; empty if the cloud has no colours and is not painted.
std::vector<std::uint32_t> colorsOf(const PointCloud& cloud, const TouchOptions& options);

/// Throws UsageError if the options need the fused method and `method` is another.
void requireFused(const TouchOptions& options, QueryMethod method);

/// The cloud, after the check that it fits: before any upload.
const PointCloud& fitting(const Device& device, const PointCloud& cloud, const TouchOptions& options);

LiveIndexOptions indexOptions(const Device& device, const PointCloud& cloud, const TouchOptions& options);
EditOptions editOptions(const TouchOptions& options);

}  // namespace palpate
