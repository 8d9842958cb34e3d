// Two picked positions on the model, and their distance.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/render/camera.hpp"

namespace palpate {

/// A position as precise as it was picked.
struct PickedPosition {
  DVec3 place{0};         ///< model units relative to the cloud's origin
  double resolution = 0;  ///< its coordinates are multiples of this, model units; 0: of a point, all digits count
};

class Measure {
 public:
  /// Adds a position; a third one begins a new pair.
  void take(const PickedPosition& picked);
  /// Assigns the measure to the model in that file; a measure of another model is cleared.
  void belongTo(const std::string& file);
  /// Called when that model is saved to another file.
  void beCalled(const std::string& file) { file_ = file; }
  void forget();

  std::span<const PickedPosition> picked() const { return picked_; }
  /// Model units; nothing with fewer than two positions.
  std::optional<double> distance() const;
  /// The middle between two positions in such a picture; nothing if it is behind the camera.
  std::optional<DVec2> middle_px(const Camera& camera, const UVec2& size_px) const;
  std::uint64_t version() const { return version_; }  ///< increases with each change

  /// Millimetres per model unit that give the measured distance the length in `text`, mm. Throws Error.
  double scaleFor(const std::string& text) const;

 private:
  std::string file_;
  std::vector<PickedPosition> picked_;
  std::uint64_t version_ = 0;
};

}  // namespace palpate
