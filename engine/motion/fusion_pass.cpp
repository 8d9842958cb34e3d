#include "engine/motion/fusion_pass.hpp"

#include <algorithm>
#include <array>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/fusion_passes.h"

namespace palpate {

namespace {

using shared::kMaskBits;

std::uint32_t wordsFor(std::uint32_t bits) { return (bits + kMaskBits - 1) / kMaskBits; }

Buffer words(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<std::uint32_t>(device, count, Memory::device, name);
}

Buffer scanScratch(Device& device, std::uint64_t count, const char* name) {
  return Buffer(device, PrefixScan::scratchBytes(count), Memory::device, name);
}

template <class Args>
ComputePipeline pass(Device& device, const ShaderCode& code) {
  return {device, code, {.pushBytes = sizeof(Args)}};
}

const DepthCamera& checked(const DepthCamera& camera) {
  requireCamera(camera);
  return camera;
}

FusionOptions checked(const FusionOptions& options, std::uint32_t slots) {
  options.validate();
  if (options.capacity > slots)
    throw Error("fusion: a capacity of {} points, and the live cloud has {} slots", options.capacity, slots);
  return options;
}

}  // namespace

FusionPass::FusionPass(Device& device, const DepthCamera& camera, const FusionOptions& options, std::uint32_t slots)
    : device_(device),
      camera_(checked(camera)),
      options_(checked(options, slots)),
      slots_(slots),
      passes_{pass<shared::PixelSurfaceArgs>(device, shader_code::motion_pixel_surface),
              pass<shared::FusePointsArgs>(device, shader_code::motion_fuse_points),
              pass<shared::FindNewArgs>(device, shader_code::motion_find_new),
              pass<shared::CountFreeArgs>(device, shader_code::motion_count_free),
              pass<shared::ListFreeArgs>(device, shader_code::motion_list_free),
              pass<shared::AppendPointsArgs>(device, shader_code::motion_append_points)},
      scan_(device),
      images_{Buffer::of<shared::FusionView>(device, 1, Memory::upload, "fusion view"),
              Buffer::of<float>(device, pixels(), Memory::upload, "fusion depths"),
              Buffer::of<std::uint32_t>(device, pixels(), Memory::upload, "fusion colours"),
              Buffer::of<shared::PixelSurface>(device, pixels(), Memory::device, "fusion surfaces"),
              words(device, pixels(), "fusion covered")},
      new_{words(device, pixelWords(), "fusion new pixels"), words(device, pixelWords(), "fusion new before"),
           scanScratch(device, pixelWords(), "fusion new scratch"),
           Buffer::of<UVec2>(device, pixels(), Memory::device, "fusion new places")},
      free_{words(device, slotWords(), "fusion free ids"),
            words(device, slotWords(), "fusion empty slots"),
            words(device, slotWords(), "fusion ids before"),
            words(device, slotWords(), "fusion slots before"),
            scanScratch(device, slotWords(), "fusion id scratch"),
            scanScratch(device, slotWords(), "fusion slot scratch")},
      records_(Buffer::of<shared::SurfelRecord>(device, slots, Memory::device, "fusion records")),
      totals_(Buffer::of<shared::FusionTotals>(device, 1, Memory::device, "fusion totals")),
      totalsRead_(Buffer::of<shared::FusionTotals>(device, 1, Memory::readback, "fusion totals read")) {
  totalsRead_.mapped<shared::FusionTotals>()[0] = {};
}

std::uint32_t FusionPass::pixelWords() const { return wordsFor(pixels()); }
std::uint32_t FusionPass::slotWords() const { return wordsFor(slots_); }

void FusionPass::reset(Queue& queue, const PointCloud& given) {
  PALPATE_CHECK_LE(given.size(), options_.capacity);
  std::vector<std::uint32_t> ids(slotWords(), 0);
  for (std::size_t id = given.size(); id < options_.capacity; ++id) ids[id / kMaskBits] |= 1u << id % kMaskBits;
  upload(device_, queue, free_.ids, ids);
  std::vector<shared::SurfelRecord> records(slots_);
  for (std::size_t id = 0; id < given.size(); ++id) records[id] = givenRecord(options_, packedColor(given, id));
  upload(device_, queue, records_, records);
}

void FusionPass::put(const FrameImages& images, const CameraPose& pose, const DVec3& origin) {
  PALPATE_CHECK(images.camera == camera_);
  setPose(images, pose, origin);
  std::ranges::copy(images.depths, images_.depths.mapped<float>().begin());
  std::ranges::copy(images.colors, images_.colors.mapped<std::uint32_t>().begin());
}

void FusionPass::setPose(const FrameImages& images, const CameraPose& pose, const DVec3& origin) {
  shared::FusionView view = fusionView(images, pose, origin, options_);
  view.felt = isFelt_ ? 1 : 0;
  view.left = left_s_;
  view.perSecond = perSecond_;
  images_.view.mapped<shared::FusionView>()[0] = view;
}

void FusionPass::setWay(double left_s, double comes_s) {
  isFelt_ = true;
  left_s_ = static_cast<float>(left_s);
  perSecond_ = static_cast<float>(comes_s > 0 ? 1 / comes_s : 0);
}

void FusionPass::recordSurfaces(CommandList& list) const {
  list.dispatch(passes_.pixelSurface, pixels(),
                shared::PixelSurfaceArgs{.view = images_.view.address(),
                                         .depths = images_.depths.address(),
                                         .surfaces = images_.surfaces.address(),
                                         .covered = images_.covered.address(),
                                         .pixels = pixels(),
                                         .unused = 0});
}

void FusionPass::record(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                        const Velocities& velocities) const {
  const auto section = list.section("fusion");
  recordUpdate(list, from, to, velocities);
  recordAppend(list, to, velocities.to);
  list.copy(totals_, totalsRead_, totals_.bytes());
}

void FusionPass::recordUpdate(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                              const Velocities& velocities) const {
  {
    const auto overlap = list.independent();
    list.fill(totals_, 0, totals_.bytes());
    recordSurfaces(list);
  }
  list.dispatch(passes_.fusePoints, slots_,
                shared::FusePointsArgs{.view = images_.view.address(),
                                       .depths = images_.depths.address(),
                                       .colors = images_.colors.address(),
                                       .surfaces = images_.surfaces.address(),
                                       .covered = images_.covered.address(),
                                       .positionsIn = from.positions.address(),
                                       .normalsIn = from.normals.address(),
                                       .positionsOut = to.positions.address(),
                                       .normalsOut = to.normals.address(),
                                       .records = records_.address(),
                                       .freeIds = free_.ids.address(),
                                       .emptySlots = free_.slots.address(),
                                       .totals = totals_.address(),
                                       .velocitiesIn = velocities.from,
                                       .velocitiesOut = velocities.to,
                                       .slots = slots_,
                                       .unused = 0});
}

void FusionPass::recordAppend(CommandList& list, const LiveCloud::Half& to, DeviceAddress velocities) const {
  {
    const auto overlap = list.independent();
    list.dispatch(passes_.findNew, pixels(),
                  shared::FindNewArgs{.view = images_.view.address(),
                                      .surfaces = images_.surfaces.address(),
                                      .covered = images_.covered.address(),
                                      .newPixels = new_.pixels.address(),
                                      .counts = new_.before.address(),
                                      .places = new_.places.address(),
                                      .pixels = pixels(),
                                      .unused = 0});
    list.dispatch(passes_.countFree, slotWords(),
                  shared::CountFreeArgs{.freeIds = free_.ids.address(),
                                        .emptySlots = free_.slots.address(),
                                        .idCounts = free_.idsBefore.address(),
                                        .slotCounts = free_.slotsBefore.address(),
                                        .words = slotWords(),
                                        .unused = 0});
  }
  scan_.record(list, {new_.before.address(), new_.scratch.address()}, pixelWords());
  const std::array<PrefixScan::Io, 2> both{{{free_.idsBefore.address(), free_.idScratch.address()},
                                            {free_.slotsBefore.address(), free_.slotScratch.address()}}};
  scan_.record(list, both, slotWords());
  list.dispatch(passes_.listFree, slotWords(),
                shared::ListFreeArgs{.freeIds = free_.ids.address(),
                                     .emptySlots = free_.slots.address(),
                                     .idsBefore = free_.idsBefore.address(),
                                     .slotsBefore = free_.slotsBefore.address(),
                                     .places = new_.places.address(),
                                     .newPixels = new_.pixels.address(),
                                     .newBefore = new_.before.address(),
                                     .totals = totals_.address(),
                                     .words = slotWords(),
                                     .pixelWords = pixelWords(),
                                     .slots = slots_,
                                     .unused = 0});
  list.dispatch(passes_.appendPoints, pixels(),
                shared::AppendPointsArgs{.view = images_.view.address(),
                                         .depths = images_.depths.address(),
                                         .colors = images_.colors.address(),
                                         .surfaces = images_.surfaces.address(),
                                         .newPixels = new_.pixels.address(),
                                         .newBefore = new_.before.address(),
                                         .places = new_.places.address(),
                                         .positions = to.positions.address(),
                                         .normals = to.normals.address(),
                                         .records = records_.address(),
                                         .totals = totals_.address(),
                                         .velocities = velocities,
                                         .pixels = pixels(),
                                         .slots = slots_});
}

FusionCounts FusionPass::counts() const {
  const auto& totals = totalsRead_.mapped<const shared::FusionTotals>()[0];
  return {.points = std::uint64_t{totals.points} + totals.appended,
          .matched = totals.matched,
          .appended = totals.appended,
          .removed = totals.removed,
          .refused = totals.refused};
}

std::uint64_t FusionPass::bytes() const {
  std::uint64_t sum = records_.bytes();
  for (const Buffer* buffer : {&images_.view, &images_.depths, &images_.colors, &images_.surfaces, &images_.covered,
                               &new_.pixels, &new_.before, &new_.scratch, &new_.places, &free_.ids, &free_.slots,
                               &free_.idsBefore, &free_.slotsBefore, &free_.idScratch, &free_.slotScratch})
    sum += buffer->bytes();
  return sum;
}

}  // namespace palpate
