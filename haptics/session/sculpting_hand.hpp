// A sculpting hand for measurements: where it lowers the brush, which brush reaches a given number of points, and how
// it moves.
#pragma once

#include "engine/core/contact_query.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/surface_walk.hpp"

namespace palpate {

/// Maximum sample sizes for walks over a model: with its detail, and to find spots in some 10 ms.
inline constexpr std::size_t kWalkedPoints = 524'288, kCoarsePoints = 32'768;

/// A model for walks: a sample of at most `most` points, and the best spot to lower a brush; relative to the cloud's
/// origin.
struct WalkedSurface {
  explicit WalkedSurface(const PointCloud& cloud, std::size_t most = kWalkedPoints);

  ThinnedCloud points;
  SurfaceSpot best;
};

/// Spots on a model that suit a brush, the best first; relative to the cloud's origin. From a sample of `most` points.
std::vector<SurfaceSpot> sculptingPlaces(const Model& model, std::size_t most = kWalkedPoints);

struct Stroke {
  BrushConfig brush;
  double depth = 0;  ///< of the HIP behind the proxy, model units
  double speed = 0;  ///< along the surface, model units per second
};
/// A stroke with this brush, deep enough that it edits.
Stroke strokeWith(const BrushConfig& brush, const Model& model);
/// The stroke whose brush reaches `touched` points in a tick around `place`. A tick at `rate_Hz` moves the surface so
/// little that it yields by about the brush's depth in one pass: the number of reached points stays the same.
Stroke strokeThatReaches(std::size_t touched, BrushKind kind, const Model& model, const SurfaceSpot& place,
                         double rate_Hz);

/// Slides over the felt surface at constant depth behind the proxy, so that the surface yields at every tick and the
/// brush reaches new points. Where the surface ends or is lost, the brush is lowered at another spot.
class SculptingHand final : public HapticDevice {
 public:
  /// `reach`: support radius, model units.
  SculptingHand(const Model& model, std::vector<SurfaceSpot> places, const Stroke& stroke, double reach);

  std::string_view name() const override { return "sculpting hand"; }
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3&) noexcept override { return true; }
  void emergencyStop() noexcept override {}  // no force to switch off
  std::string faultText() const override { return {}; }

  /// For a session of `ticks` ticks.
  OpenHand hand(std::uint64_t ticks, double rate_Hz) {
    return {.device = this, .duration_s = static_cast<double>(ticks - 1) / rate_Hz};
  }

  /// The answer at the last position.
  void felt(const Contact& contact) noexcept;
  /// In contact at full depth.
  bool sculpts() const { return contact_.touching && depth_ >= stroke_.depth; }
  /// How often the brush was lowered.
  std::uint64_t landings() const { return landings_; }

 private:
  void putDown() noexcept;

  DVec3 origin_;
  std::vector<SurfaceSpot> places_;
  Stroke stroke_;
  double reach_;
  std::uint64_t landings_ = 0;
  std::uint32_t lost_ = 0;                    // ticks since the last contact
  double time_s_ = 0, depth_ = 0, left_ = 0;  // `left_`: rest of the descent that may still meet the surface
  DVec3 hip_{0}, normal_{0}, heading_{0};
  Contact contact_;
};

}  // namespace palpate
