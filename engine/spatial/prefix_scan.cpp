#include "engine/spatial/prefix_scan.hpp"

#include "shaders/compiled.hpp"
#include "shaders/shared/prefix_scan.h"

namespace palpate {

namespace {
constexpr std::uint32_t kWorkgroup = 256;
constexpr std::uint32_t kTile = kWorkgroup * shared::kScanItems;

std::uint32_t tilesFor(std::uint64_t count) { return static_cast<std::uint32_t>((count + kTile - 1) / kTile); }
}  // namespace

PrefixScan::PrefixScan(Device& device)
    : reduce_(device, shader_code::spatial_prefix_scan_reduce,
              {.workgroupSize = kWorkgroup, .pushBytes = sizeof(shared::PrefixScanArgs)}),
      scan_(device, shader_code::spatial_prefix_scan,
            {.workgroupSize = kWorkgroup, .pushBytes = sizeof(shared::PrefixScanArgs)}) {}

std::uint64_t PrefixScan::scratchBytes(std::uint64_t count) { return tilesFor(count) * sizeof(std::uint32_t); }

void PrefixScan::record(CommandList& list, const Io& io, std::uint32_t count) const {
  const shared::PrefixScanArgs args{
      .values = io.values, .tileSums = io.scratch, .count = count, .tiles = tilesFor(count)};
  const std::uint64_t threads = std::uint64_t{args.tiles} * kWorkgroup;
  if (args.tiles > 1) list.dispatch(reduce_, threads, args);
  list.dispatch(scan_, threads, args);
}

}  // namespace palpate
