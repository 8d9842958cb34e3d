#pragma once

#include <doctest/doctest.h>

#include <bit>
#include <vector>

#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/motion/fusion_pass.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/fusion_passes.h"
#include "tests/motion/depth_scene.hpp"

namespace palpate {

// A live cloud with its index, into which depth frames are fused.
class FusedCloud {
 public:
  FusedCloud(Device& device, const DepthCamera& camera, const FusionOptions& options, const PointCloud& begun = {})
      : device_(device),
        options_(options),
        cloud_(device, begun, static_cast<std::uint32_t>(options.capacity - begun.size()), nullptr, true),
        hash_(device, makeHashGrid(Vec3(0), 0.01f, cloud_.slots()), cloud_.slots(), kDefaultSort, BucketOrder::stable,
              Slots::spare),
        incoming_{Buffer::of<Vec4>(device, cloud_.slots(), Memory::device, "incoming positions"),
                  Buffer::of<Vec4>(device, cloud_.slots(), Memory::device, "incoming normals"), 0},
        pass_(device, camera, options, cloud_.slots()) {
    pass_.reset(device.latencyQueue(), begun);
  }

  FusionCounts fuse(const DepthCamera& camera, const DepthFrame& frame, const DVec3& origin = DVec3(0)) {
    put(camera, frame, *frame.pose, origin);
    CommandList list(device_, device_.latencyQueue(), "fuse");
    list.begin();
    pass_.record(list, cloud_.front(), incoming_);
    hash_.recordBuild(list, incoming_, cloud_.back(), cloud_.slots(), hash_.sort());
    list.end();
    device_.latencyQueue().run(list);
    cloud_.flip();
    return pass_.counts();
  }

  // By id; weight 0 if no slot contains the id.
  std::vector<shared::Surfel> surfels() const {
    std::vector<shared::Surfel> all(cloud_.slots());
    const auto records = download<shared::SurfelRecord>(device_, pass_.records(), cloud_.slots());
    const auto positions = download<Vec4>(device_, cloud_.front().positions, cloud_.slots());
    const auto normals = download<Vec4>(device_, cloud_.front().normals, cloud_.slots());
    std::size_t wrong = 0;
    for (std::size_t slot = 0; slot < positions.size(); ++slot) {
      const auto id = std::bit_cast<std::uint32_t>(positions[slot].w);
      if (id == shared::kEmptySlot) continue;
      if (id >= options_.capacity || all[id].record.weight > 0) {
        ++wrong;  // an invalid id, or one twice
        continue;
      }
      // Points of the initial cloud whose colour no frame has observed have the cloud's colour.
      const auto color = std::bit_cast<std::uint32_t>(normals[slot].w);
      wrong += records[id].color != 0 && color != shared::colorBeside(records[id]);
      all[id] = {.place = Vec3(positions[slot]), .normal = Vec3(normals[slot]), .record = records[id]};
    }
    CHECK(wrong == 0);
    return all;
  }

  const FrameImages& put(const DepthCamera& camera, const DepthFrame& frame, const CameraPose& pose,
                         const DVec3& origin = DVec3(0)) {
    readFrame(camera, frame, options_, images_);
    pass_.put(images_, pose, origin);
    return images_;
  }

  FusionPass& pass() { return pass_; }
  const LiveCloud& cloud() const { return cloud_; }

 private:
  Device& device_;
  FusionOptions options_;
  LiveCloud cloud_;
  SpatialHash hash_;
  LiveCloud::Half incoming_;
  FusionPass pass_;
  FrameImages images_;
};

}  // namespace palpate
