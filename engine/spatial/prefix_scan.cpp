#include "engine/spatial/prefix_scan.hpp"

#include "shaders/compiled.hpp"
#include "shaders/shared/prefix_scan.h"

namespace palpate {

namespace {

std::uint32_t tilesFor(std::uint64_t count) {
  return static_cast<std::uint32_t>((count + shared::kScanTile - 1) / shared::kScanTile);
}

PipelineOptions options(std::size_t pushBytes) {
  return {.workgroupSize = shared::kScanWorkgroup, .pushBytes = static_cast<std::uint32_t>(pushBytes)};
}

}  // namespace

PrefixScan::PrefixScan(Device& device)
    : reduce_(device, shader_code::spatial_prefix_scan_reduce, options(sizeof(shared::PrefixScanArgs))),
      scan_(device, shader_code::spatial_prefix_scan, options(sizeof(shared::PrefixScanArgs))) {}

RangeScan::RangeScan(Device& device)
    : reduce_(device, shader_code::spatial_prefix_scan_reduce, options(sizeof(shared::PrefixScanArgs))),
      ranges_(device, shader_code::spatial_bucket_ranges, options(sizeof(shared::BucketRangesArgs))) {}

std::uint64_t PrefixScan::scratchBytes(std::uint64_t count) { return tilesFor(count) * sizeof(std::uint32_t); }

void PrefixScan::record(CommandList& list, const Io& io, std::uint32_t count) const {
  record(list, std::span(&io, 1), count);
}

void PrefixScan::record(CommandList& list, std::span<const Io> arrays, std::uint32_t count) const {
  const std::uint32_t tiles = tilesFor(count);
  const auto forEach = [&](const ComputePipeline& pass) {
    const auto overlap = list.independent();
    for (const Io& io : arrays)
      list.dispatch(
          pass, std::uint64_t{tiles} * shared::kScanWorkgroup,
          shared::PrefixScanArgs{.values = io.values, .tileSums = io.scratch, .count = count, .tiles = tiles});
  };
  if (tiles > 1) forEach(reduce_);
  forEach(scan_);
}

void RangeScan::record(CommandList& list, const PrefixScan::Io& io, DeviceAddress ranges, std::uint32_t count) const {
  const std::uint32_t tiles = tilesFor(count);
  const std::uint64_t threads = std::uint64_t{tiles} * shared::kScanWorkgroup;
  if (tiles > 1)
    list.dispatch(reduce_, threads,
                  shared::PrefixScanArgs{.values = io.values, .tileSums = io.scratch, .count = count, .tiles = tiles});
  list.dispatch(ranges_, threads,
                shared::BucketRangesArgs{
                    .counts = io.values, .tileSums = io.scratch, .ranges = ranges, .count = count, .tiles = tiles});
}

}  // namespace palpate
