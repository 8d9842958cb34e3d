#pragma once

#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// The surface stays a surface while it is sculpted: where an edit stretches it, points are inserted, where it crowds
/// them, they are merged. The GPU's side of engine/edit/resample_reference.hpp. What a point wishes for at the end of a
/// tick comes to pass with the next edit, and points that had a wish are looked at again until none has one.
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
  /// Once the index has followed and normals are fitted: new wishes. The last passes of an edit, which a force need not
  /// wait for.
  void recordWishes(CommandList& list, const Io& io, DeviceAddress changed, DeviceAddress fitted,
                    const shared::EditEnd& end) const;
  /// Where the last pass of an edit tells the host of its Resampling.
  DeviceAddress reportAddress() const { return report_.address(); }
  bool unsettled() const { return report_.mapped<const shared::Resampling>()[0].wishes > 0; }

  DeviceAddress lists() const { return lists_.address(); }
  DeviceAddress spacings() const { return spacings_.address(); }
  DeviceAddress looks() const { return looks_.address(); }
  DeviceAddress rests() const { return rests_.address(); }
  DeviceAddress reaches() const { return reaches_.address(); }
  std::uint64_t bytes() const {
    return lists_.bytes() + spacings_.bytes() + looks_.bytes() + rests_.bytes() + reaches_.bytes() + report_.bytes();
  }
  static std::uint64_t predictedBytes(std::uint64_t points, std::uint64_t slots, std::uint64_t mostWishes);

 private:
  Device& device_;
  double radius_;
  std::uint32_t mostWishes_;
  ComputePipeline measure_, wish_, grant_;
  Buffer lists_, spacings_, looks_, rests_, reaches_, report_;
};

}  // namespace palpate
