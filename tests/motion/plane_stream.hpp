// A plane that oscillates before a depth camera, tilted or not, with noise and rounding of its depths.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/depth_stream.hpp"

namespace palpate {

struct SeenPlane {
  double tilt_rad = 0;
  double noise_m = 0;    ///< standard deviation of a depth, independent per pixel
  double rounded_m = 0;  ///< depths are multiples of this; 0: not rounded

  DVec3 normal() const { return {std::sin(tilt_rad), 0, -std::cos(tilt_rad)}; }
};

/// 30 frames per second from the origin along z, 1000 in all; 4 mm to either side at 0.5 Hz.
class PlaneStream final : public DepthStream {
 public:
  static constexpr double kPeriod_s = 1.0 / 30, kAway_m = 0.5, kAmplitude_m = 0.004, kFrequency_Hz = 0.5;
  static constexpr double kSpacing_m = kAway_m / 525;
  static constexpr std::uint64_t kFrames = 1000;

  explicit PlaneStream(const SeenPlane& seen) : seen_(seen) {}

  /// Position of the plane on the camera's axis.
  static double placeAt(double time_s) {
    return kAway_m + kAmplitude_m * std::sin(2 * std::numbers::pi * kFrequency_Hz * time_s);
  }
  /// Position as felt: interpolated evenly from frame to frame, one frame late.
  static double feltAt(double time_s) {
    const double frame = std::floor(time_s / kPeriod_s + 1e-9), share = time_s / kPeriod_s - frame;
    const double before = placeAt(kPeriod_s * std::max(0.0, frame - 1));
    return before + share * (placeAt(kPeriod_s * frame) - before);
  }
  /// Position of a hand that approaches within 0.1 s from 5 mm before the plane, then stays at a depth below the felt
  /// plane.
  static DVec3 heldAt(double time_s, double depth_m, const DVec3& normal) {
    const double way = std::min(1.0, time_s / 0.1);
    return DVec3(0, 0, feltAt(time_s)) + ((1 - way) * 0.005 - way * depth_m) * normal;
  }

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override {
    if (number_ == kFrames) return false;
    frame = {.time_s = kPeriod_s * static_cast<double>(number_), .number = number_, .pose = CameraPose{}};
    const DVec3 normal = seen_.normal();
    const double distance = normal.z * placeAt(frame.time_s);
    for (std::uint32_t pixel = 0; pixel < camera_.width * camera_.height; ++pixel) {
      const DVec3 ray = camera_.placeAt(pixel % camera_.width, pixel / camera_.width, 1);
      double depth = distance / glm::dot(normal, ray) + seen_.noise_m * randomNormal3(number_ + 1, pixel).x;
      if (seen_.rounded_m > 0) depth = seen_.rounded_m * std::round(depth / seen_.rounded_m);
      frame.depth_m.push_back(static_cast<float>(depth));
    }
    ++number_;
    return true;
  }
  bool isRecorded() const override { return true; }
  void rewind() override { number_ = 0; }
  std::uint64_t frames() const override { return kFrames; }
  double duration_s() const override { return kPeriod_s * (kFrames - 1); }

 private:
  SeenPlane seen_;
  DepthCamera camera_{.width = 64, .height = 48, .fx = 525, .fy = 525, .cx = 31.5, .cy = 23.5};
  std::uint64_t number_ = 0;
};

}  // namespace palpate
