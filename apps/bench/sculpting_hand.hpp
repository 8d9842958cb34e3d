// A hand that sculpts for a measurement: where it puts the brush down, which brush reaches so many points, how it
// moves.
#pragma once

#include "apps/cli/model.hpp"
#include "engine/core/contact_query.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/surface_walk.hpp"

namespace palpate {

/// Points of a sample, at most, to walk over a model.
inline constexpr std::size_t kWalkedPoints = 524'288;

/// A model as it is walked over: some of its points, and the best place to put a brush down; relative to the cloud's
/// origin.
struct WalkedSurface {
  explicit WalkedSurface(const PointCloud& cloud);

  ThinnedCloud points;
  SurfaceSpot best;
};

/// Places on a model where a brush can be put down well, the best first; relative to the cloud's origin.
std::vector<SurfaceSpot> sculptingPlaces(const Model& model);

struct Stroke {
  BrushConfig brush;
  double depth = 0;  ///< of the HIP behind the proxy, model units
  double speed = 0;  ///< along the surface, model units per second
};
/// The stroke whose brush reaches `touched` points in a tick, as the cloud lies around `place`. A tick at `rate_Hz`
/// does so little that a place has yielded by about the depth of the brush once that has passed over it: the points
/// that it meets stay as many as they were.
Stroke strokeThatReaches(std::size_t touched, BrushKind kind, const Model& model, const SurfaceSpot& place,
                         double rate_Hz);

/// Slides over the surface as it is felt, at constant depth behind the proxy, so that the surface yields at every tick
/// and the brush comes upon new points. Where the surface ends, or leaves the hand, it is put down at another place.
class SculptingHand final : public HapticDevice {
 public:
  /// `reach`: support radius, model units.
  SculptingHand(const Model& model, std::vector<SurfaceSpot> places, const Stroke& stroke, double reach);

  std::string_view name() const override { return "sculpting hand"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3&) noexcept override { return true; }
  void emergencyStop() noexcept override {}  // there is nothing that could pull
  std::string faultText() const override { return {}; }

  /// For a session of so many ticks.
  OpenHand hand(std::uint64_t ticks, double rate_Hz) {
    return {.device = this, .duration_s = static_cast<double>(ticks - 1) / rate_Hz};
  }

  /// The answer to the last place it was at.
  void felt(const Contact& contact) noexcept;
  /// At its full depth, on its way.
  bool sculpts() const { return contact_.touching && depth_ >= stroke_.depth; }
  /// How often it was put down.
  std::uint64_t landings() const { return landings_; }

 private:
  void putDown() noexcept;

  DVec3 origin_;
  std::vector<SurfaceSpot> places_;
  Stroke stroke_;
  double reach_;
  std::uint64_t landings_ = 0;
  std::uint32_t lost_ = 0;                    // ticks since it last touched
  double time_s_ = 0, depth_ = 0, left_ = 0;  // `left_`: of the way down that may still meet the surface
  DVec3 hip_{0}, normal_{0}, heading_{0};
  Contact contact_;
};

}  // namespace palpate
