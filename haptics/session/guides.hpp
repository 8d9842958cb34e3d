// Guides beside a model in a picture: its box with lengths, axes with coordinates, a grid on the ground, a compass.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/render/camera.hpp"
#include "engine/render/frame_options.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

struct GuideConfig {
  bool box = false;      ///< edges of the box around what is shown, with their lengths
  bool axes = false;     ///< three edges of that box with the coordinates of the file
  bool grid = false;     ///< squares of a round length below the model
  bool compass = false;  ///< directions of the axes, in the corner of the picture

  bool any() const { return box || axes || grid || compass; }
  bool operator==(const GuideConfig&) const = default;
};
inline constexpr std::array<std::pair<std::string_view, bool GuideConfig::*>, 4> kGuides{
    {{"box", &GuideConfig::box},
     {"axes", &GuideConfig::axes},
     {"grid", &GuideConfig::grid},
     {"compass", &GuideConfig::compass}}};
/// From names separated by commas, as in "box,grid"; empty: none. Throws UsageError, which begins with `option`.
GuideConfig guidesNamed(std::string_view names, std::string_view option);

/// A text at a position, model units relative to the cloud's origin.
struct SpaceLabel {
  DVec3 at{0};
  std::string text;
  bool operator==(const SpaceLabel&) const = default;
};
struct Guides {
  std::vector<SpaceLine> lines;
  std::vector<SpaceLabel> labels;
};
/// All but the compass. `up`: the ground is at the lowest position along it; `unit`: of the lengths.
Guides guidesOf(const Model& model, UpAxis up, LengthUnit unit, const GuideConfig& config);
/// In the upper left corner of a picture of that size, in front of everything.
Guides compassOf(const Camera& camera, const UVec2& size_px);

/// A label in a picture; its middle, pixels from the top left.
struct PictureLabel {
  DVec2 at_px{0};
  std::string text;
  bool always = false;  ///< also where it covers others
};

/// Room for the labels of a picture, so that they cover neither each other nor what else is written there.
class LabelRoom {
 public:
  void reserve(const DVec2& low_px, const DVec2& high_px) { reserved_.push_back({low_px, high_px}); }
  /// Reserves it for a label; false if a part of it is reserved already and the label must not cover that.
  bool admits(const PictureLabel& label, const DVec2& low_px, const DVec2& high_px);

 private:
  std::vector<std::array<DVec2, 2>> reserved_;
};

/// The guides of the pictures of one model.
class PictureGuides {
 public:
  PictureGuides() = default;
  PictureGuides(const GuideConfig& config, const Model& model, UpAxis up, LengthUnit unit)
      : compass_(config.compass), still_(guidesOf(model, up, unit, config)) {}

  /// Without the compass.
  const Guides& still() const { return still_; }
  /// `lines` and all guides, for FrameOptions; null if there are none.
  std::shared_ptr<const std::vector<SpaceLine>> linesWith(const std::vector<SpaceLine>& lines, const Camera& camera,
                                                          const UVec2& size_px) const;
  /// Those in front of the camera and within the picture, the more important ones first (LabelRoom).
  std::vector<PictureLabel> labelsIn(const Camera& camera, const UVec2& size_px) const;

 private:
  bool compass_ = false;
  Guides still_;
};

}  // namespace palpate
