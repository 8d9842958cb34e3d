#pragma once

#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// The surface stays a surface while it is sculpted: where an edit stretches it, points are inserted, where it crowds
/// them, they are merged. The GPU's side of engine/edit/resampling.hpp. What a point requests at the end of a
/// tick is carried out with the next edit, and points that made a request are examined again until none has one.
class Resample {
 public:
  /// `radius`: support radius, model units.
  Resample(Device& device, const LiveCloud& live, const HashUpdate& update, double radius);

  /// Measures the target spacings of a cloud as it was loaded, once, and keeps where its points rest.
  void measure(const shared::CloudView& cloud, DeviceAddress tables);

  /// What the passes of an edit have in common.
  struct Io {
    shared::HashUpdateArgs update;
    DeviceAddress tables;
    const HashUpdate& lists;
  };
  /// Once the index has followed and normals are fitted: new requests. The last passes of an edit, which a force need
  /// not wait for.
  void recordRequests(CommandList& list, const Io& io, DeviceAddress changed, DeviceAddress fitted,
                      const shared::EditEnd& end) const;
  /// Where the last pass of an edit reports its Resampling to the host.
  DeviceAddress reportAddress() const { return report_.address(); }
  bool unsettled() const { return report_.mapped<const shared::Resampling>()[0].requests > 0; }

  DeviceAddress lists() const { return lists_.address(); }
  DeviceAddress spacings() const { return spacings_.address(); }
  DeviceAddress examined() const { return examined_.address(); }
  DeviceAddress rests() const { return rests_.address(); }
  DeviceAddress reaches() const { return reaches_.address(); }
  std::uint64_t bytes() const {
    return lists_.bytes() + spacings_.bytes() + examined_.bytes() + rests_.bytes() + reaches_.bytes() + report_.bytes();
  }
  static std::uint64_t predictedBytes(std::uint64_t points, std::uint64_t slots, std::uint64_t mostRequests);

 private:
  Device& device_;
  double radius_;
  std::uint32_t mostRequests_;
  ComputePipeline measure_, request_, grant_;
  Buffer lists_, spacings_, examined_, rests_, reaches_, report_;
};

}  // namespace palpate
