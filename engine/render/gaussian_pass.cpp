#include "engine/render/gaussian_pass.hpp"

#include <algorithm>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/gaussians.h"

namespace palpate {

namespace {

constexpr std::uint32_t kKeyBits = 32;
// A tile takes long where many Gaussians are translucent: touch gets its share between two slices.
constexpr std::uint32_t kBlendSlice = 1 << 15;

std::uint32_t parts(std::uint32_t whole, std::uint32_t part) { return (whole + part - 1) / part; }

}  // namespace

GaussianPass::GaussianPass(Device& device)
    : device_(device),
      tile_px_(device.isCpu() ? shared::kGaussianTileOfSoftware : shared::kGaussianTile),
      sort_(device, kKeyBits),
      project_(device, shader_code::render_gaussian_project, {.pushBytes = sizeof(shared::GaussianProjectArgs)}),
      bin_(device, shader_code::render_gaussian_bin, {.pushBytes = sizeof(shared::GaussianBinArgs)}),
      blend_(device, shader_code::render_gaussian_blend,
             {.workgroupSize = shared::kGaussianWorkgroup,
              .pushBytes = sizeof(shared::GaussianBlendArgs),
              .constants = {tile_px_},
              .sliceThreads = kBlendSlice}) {}

GaussianPass::Room::Room(Device& device, const RadixSort& sort, std::uint32_t count, std::uint64_t binBytes)
    : capacity(count),
      projected(Buffer::of<shared::ProjectedGaussian>(device, count + 1, Memory::device, "projected Gaussians")),
      boxes(Buffer::of<Vec4>(device, 2 * std::uint64_t{count}, Memory::device, "boxes of Gaussians")),
      keys(deviceWords(device, count, "depths of Gaussians")),
      values(deviceWords(device, count, "order of Gaussians")),
      keysAlt(deviceWords(device, count, "depths of Gaussians")),
      valuesAlt(deviceWords(device, count, "order of Gaussians")),
      scratch(device, sort.scratchBytes(count), Memory::device, "sort of Gaussians"),
      bins(device, binBytes, Memory::device, "lists of Gaussians") {}

GaussianPass::Bins GaussianPass::binsOf(std::uint32_t count, const FrameSize& size) {
  Bins bins{.words = parts(count, 32), .side_px = shared::kGaussianBin, .across = 1, .down = 1};
  for (;; bins.side_px *= 2) {
    bins.across = parts(size.width, bins.side_px), bins.down = parts(size.height, bins.side_px);
    if (bins.bytes() <= shared::kGaussianBinBytes || bins.across * bins.down == 1) return bins;
  }
}

const GaussianPass::Room& GaussianPass::roomFor(std::uint32_t count, std::uint64_t binBytes) {
  const Room* const last = rooms_.empty() ? nullptr : &rooms_.back();
  if (last && last->capacity >= count && last->bins.bytes() >= binBytes) return *last;
  if (last && last->capacity < count) count = std::max(count, last->capacity + last->capacity / 2);
  return rooms_.emplace_back(device_, sort_, count, binBytes);
}

void GaussianPass::prepare(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target,
                           const FrameSize& size) {
  const DrawnGaussians& gaussians = *cloud.gaussians();
  const std::uint32_t count = gaussians.count() + cloud.addedPoints();
  const Bins bins = binsOf(count, size);
  const Room& room = roomFor(count, bins.bytes());
  const auto section = list.section("gaussians");
  list.dispatch(project_, count,
                shared::GaussianProjectArgs{.gaussians = gaussians.gaussians().address(),
                                            .harmonics = gaussians.harmonics().address(),
                                            .now = {.positions = cloud.positions().address(),
                                                    .normals = cloud.normals().address(),
                                                    .colors = cloud.colors().address()},
                                            .loaded = gaussians.loaded(),
                                            .projected = room.projected.address(),
                                            .keys = room.keys.address(),
                                            .values = room.values.address(),
                                            .count = count,
                                            .fileCount = gaussians.count(),
                                            .loadedPoints = cloud.loadedPoints(),
                                            .harmonicCount = gaussians.harmonicCount(),
                                            .spacing = gaussians.spacing(),
                                            .unused = 0});
  const PairSort::Sorted sorted = sort_.record(list,
                                               {.keys = room.keys.address(),
                                                .values = room.values.address(),
                                                .keysAlt = room.keysAlt.address(),
                                                .valuesAlt = room.valuesAlt.address(),
                                                .scratch = room.scratch},
                                               count);
  list.fill(room.bins, 0, bins.bytes());
  list.dispatch(bin_, count,
                shared::GaussianBinArgs{.projected = room.projected.address(),
                                        .keys = sorted.keys,
                                        .order = sorted.values,
                                        .boxes = room.boxes.address(),
                                        .bins = room.bins.address(),
                                        .count = count,
                                        .words = bins.words,
                                        .binSide_px = bins.side_px,
                                        .binsAcross = bins.across,
                                        .binsDown = bins.down,
                                        .unused = 0});
  const std::uint32_t across = parts(size.width, tile_px_);
  args_ = {.projected = room.projected.address(),
           .order = sorted.values,
           .boxes = room.boxes.address(),
           .bins = room.bins.address(),
           .depth = target.depth,
           .words = bins.words,
           .binSide_px = bins.side_px,
           .binsAcross = bins.across,
           .tilesAcross = across,
           .tiles = across * parts(size.height, tile_px_)};
}

void GaussianPass::blend(CommandList& list, DeviceAddress shaded) const {
  shared::GaussianBlendArgs args = args_;
  args.shaded = shaded;
  list.dispatch(blend_, std::uint64_t{args.tiles} * shared::kGaussianWorkgroup, args);
}

}  // namespace palpate
