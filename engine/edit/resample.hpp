#pragma once

#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// Examines the points that a stroke has moved. They look at what lies ahead of them (shaders/shared/look_ahead.h), and
/// if the brush resamples, the surface is kept whole: points are inserted where an edit stretches it, and merged where
/// it crowds them. The GPU's side of engine/edit/resampling.hpp. A point's request at the end of a tick is carried out
/// with the next edit, and points with requests are examined again until none is left.
class Resample {
 public:
  /// `radius`: support radius, model units.
  Resample(Device& device, const LiveCloud& live, const HashUpdate& update, double radius);

  /// Measures the target spacings of a cloud as loaded, once, and stores its points' rest positions.
  void measure(const shared::CloudView& cloud, DeviceAddress tables);

  /// Inputs common to the passes of an edit.
  struct Io {
    shared::HashUpdateArgs update;
    DeviceAddress tables;
    const HashUpdate& lists;
  };
  /// Points look ahead, and make new requests, once the index is updated and normals are fitted. The last passes of an
  /// edit; the force does not wait for them.
  void recordRequests(CommandList& list, const Io& io, DeviceAddress changed, DeviceAddress fitted,
                      const shared::EditEnd& end) const;
  /// Address at which the last pass of an edit reports its Resampling to the host.
  DeviceAddress reportAddress() const { return report_.address(); }
  bool unsettled() const { return report_.mapped<const shared::Resampling>()[0].requests > 0; }

  DeviceAddress lists() const { return lists_.address(); }
  DeviceAddress spacings() const { return spacings_.address(); }
  DeviceAddress examined() const { return examined_.address(); }
  DeviceAddress carried() const { return carried_.address(); }
  DeviceAddress rests() const { return rests_.address(); }
  DeviceAddress reaches() const { return reaches_.address(); }
  std::uint64_t bytes() const {
    return lists_.bytes() + spacings_.bytes() + examined_.bytes() + carried_.bytes() + rests_.bytes() +
           reaches_.bytes() + report_.bytes();
  }
  static std::uint64_t predictedBytes(std::uint64_t points, std::uint64_t slots, std::uint64_t mostRequests);

 private:
  Device& device_;
  double radius_;
  std::uint32_t mostRequests_;
  ComputePipeline measure_, request_, grant_;
  Buffer lists_, spacings_, examined_, carried_, rests_, reaches_, report_;
};

}  // namespace palpate
