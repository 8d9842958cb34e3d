#pragma once

#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// Position of the device in the model, through a clutch: while it is drawn the HIP stays and only the hand moves, so
/// that a small workspace reaches all of a large model. A gain makes the HIP move more or less than the hand.
class Clutch {
 public:
  explicit Clutch(const WorkspaceMap& map, double gain = 1)
      : map_{.scale = gain * map.scale, .offset = map.offset}, usualScale_(map.scale) {}

  /// From now on, about the HIP at that position of the device, which stays.
  void setGain(double gain, const DVec3& device) noexcept {
    if (gain * usualScale_ == map_.scale) return;
    const DVec3 hip = map_.toModel(device);
    map_.scale = gain * usualScale_;
    map_.offset = hip - map_.scale * device;
  }
  /// Model units per device unit.
  double scale() const noexcept { return map_.scale; }

  /// `device`: in its own unit. Returns the HIP, model units.
  DVec3 toModel(const DVec3& device, bool drawn) noexcept {
    if (drawn) {
      if (!drawn_) hip_ = map_.toModel(device);
    } else if (drawn_) {
      map_.offset = hip_ - map_.scale * device;
    }
    drawn_ = drawn;
    return drawn ? hip_ : map_.toModel(device);
  }
  bool isDrawn() const noexcept { return drawn_; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    visit(map_.scale, map_.offset, drawn_, hip_);
  }

 private:
  WorkspaceMap map_;
  double usualScale_;  // with the gain 1
  bool drawn_ = false;
  DVec3 hip_{0};  // while the clutch is drawn
};

}  // namespace palpate
