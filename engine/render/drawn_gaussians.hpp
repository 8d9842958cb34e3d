// The Gaussians of a drawn cloud on the GPU.
#pragma once

#include <string>

#include "engine/cloud/edited_gaussians.hpp"
#include "engine/gpu/buffer.hpp"
#include "shaders/shared/gaussians.h"

namespace palpate {

class Device;

/// All Gaussians of a file as loaded, and the points as loaded. Edits change nothing here: a picture compares the drawn
/// points with the loaded ones, so that each Gaussian is where its point (GaussianOwner) is now. All work uses the
/// throughput queue. Throws OutOfGpuMemory.
class DrawnGaussians {
 public:
  /// `cloud`: read from Gaussians.
  DrawnGaussians(Device& device, const PointCloud& cloud);

  std::uint32_t count() const { return count_; }
  /// "9080 Gaussians of degree 3, drawn as they were trained", and how many are beyond touch.
  std::string inWords() const;
  /// Mean spacing of the points, model units.
  float spacing() const { return spacing_; }
  /// shared::Gaussian each.
  const Buffer& gaussians() const { return gaussians_; }
  /// harmonicCount() colours each, in pairs of half floats.
  const Buffer& harmonics() const { return harmonics_; }
  std::uint32_t harmonicCount() const { return harmonicCount_; }
  /// The points as loaded.
  shared::GaussianPoints loaded() const;
  std::uint64_t bytes() const;

 private:
  std::uint32_t count_, harmonicCount_ = 0;
  std::uint64_t beyondTouch_ = 0;  // visible ones farther from the points than a hand feels: sky and haze
  float spacing_;
  Buffer gaussians_, harmonics_, positions_, normals_, colors_;
};

}  // namespace palpate
