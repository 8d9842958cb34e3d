// Distances between picked positions on the model.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/view/named_texts.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/vec.hpp"
#include "engine/render/camera.hpp"
#include "haptics/session/guides.hpp"

namespace palpate {

/// A position as precise as it was picked.
struct PickedPosition {
  DVec3 place{0};         ///< model units relative to the cloud's origin
  double resolution = 0;  ///< its coordinates are multiples of this, model units; 0: of a point, all digits count
};

struct MeasuredDistance {
  std::string name;
  std::array<PickedPosition, 2> ends;

  double length() const { return glm::distance(ends[0].place, ends[1].place); }  ///< model units
  double height(UpAxis up) const;  ///< of the second end over the first, model units
  double across(UpAxis up) const;  ///< the length without the height, model units
};

/// The measured distances of a model. They are kept by the file's name, for the next time it is opened.
class Measure {
 public:
  /// Adds a position; the second of a pair adds a distance, which is the chosen one then.
  void take(const PickedPosition& picked);
  /// Assigns the measure to the model in that file; it has the distances that were kept of it. `origin`: of the cloud.
  void belongTo(const std::string& file, const DVec3& origin);
  /// Called when that model is saved to another file.
  void beCalled(const std::string& file);
  /// Drops a position without a second one, and chooses none; the distances remain.
  void end();
  /// No effect if none has that name, nor if another one has the new name. Returns whether it had.
  bool choose(const std::string& name);
  bool rename(const std::string& name, const std::string& to);
  void forget(const std::string& name);

  std::span<const MeasuredDistance> distances() const { return distances_; }
  /// Those that pictures show: all of them while distances are measured or one is chosen, else none.
  std::span<const MeasuredDistance> shown(bool measures) const;
  /// The positions of the pair that is picked, or of the chosen distance.
  std::span<const PickedPosition> picked() const { return picked_; }
  /// Null: none is chosen.
  const MeasuredDistance* chosen() const;
  /// Of those of shown() that are in front of the camera, in the middle between their ends.
  std::vector<PictureLabel> labelsIn(const Camera& camera, const UVec2& size_px, LengthUnit unit, bool measures) const;
  /// A table with a header line: names, coordinates of the file, lengths in its unit and, if that is known, in mm.
  /// `resolution`: of the model's coordinates (coordinateText()).
  std::string csv(double resolution, LengthUnit unit, UpAxis up) const;
  std::uint64_t version() const { return version_; }  ///< increases with each change

  /// Millimetres per model unit that give the chosen distance the length in `text`, mm. Throws Error.
  double scaleFor(const std::string& text) const;

 private:
  void keep(MeasuredDistance& distance);

  NamedTexts kept_{"distances", "distance"};
  std::string file_, chosen_;
  DVec3 origin_{0};
  std::vector<MeasuredDistance> distances_;
  std::vector<PickedPosition> picked_;
  std::uint64_t version_ = 0;
};

}  // namespace palpate
