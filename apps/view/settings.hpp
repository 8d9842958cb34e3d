// All settings of the window.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "apps/cli/look.hpp"
#include "apps/view/session.hpp"
#include "engine/cloud/length_text.hpp"
#include "haptics/session/colored_field.hpp"
#include "haptics/session/guides.hpp"
#include "haptics/session/light_config.hpp"

namespace palpate {

/// Sizes of the panels and their text, %.
inline constexpr std::array<std::pair<std::string_view, int>, 9> kTextSizes{{{"75", 75},
                                                                             {"90", 90},
                                                                             {"100", 100},
                                                                             {"110", 110},
                                                                             {"125", 125},
                                                                             {"150", 150},
                                                                             {"200", 200},
                                                                             {"250", 250},
                                                                             {"300", 300}}};

/// How the model is shown, and how the mouse holds the stylus.
struct ViewSettings {
  ColorConfig color;
  LightConfig light;
  std::optional<UpAxis> up;    ///< nothing: by the model's shape
  std::optional<DVec3> front;  ///< of a model that was turned; nothing: by its shape
  std::optional<LengthUnit> unit;
  double discRadius_mm = 0;  ///< 0: automatic, so that the discs close the surface
  bool smoothOutlines = false, scaleBar = true, dark = true;
  int text_percent = 100;  ///< of kTextSizes
  bool fullScreen = false;
  bool orthographic = false;
  GuideConfig guides;
  bool cameras = true;    ///< show the cameras that took pictures of the model
  bool measures = false;  ///< the left button picks the two positions of a measure
  bool mesh = false;
  int resolution = 128;
  bool followsSurface = true;  ///< the stylus stays at the visible surface under the cursor; else in one plane
  double press_mm = 2.5;       ///< depth that the hand aims at while it presses
  double string_px = 0;        ///< StrokeOptions::string_px
  bool waitsForDisplay = true;
  bool panels = true, plots = false, help = false;
  bool firstSteps = false;      ///< show the first steps
  std::string_view opens = {};  ///< the section of the panel that is opened next; empty: none
  int scrolls = 0;              ///< heights of the panel by which it is scrolled next, down

  UpAxis upOf(const Model& model) const { return up.value_or(model.upright.up); }
  DVec3 frontFor(const Model& model) const {
    const UpAxis shown = upOf(model);
    return front && glm::dot(*front, directionOf(shown)) == 0 ? *front : model.upright.frontFor(shown);
  }
  LengthUnit unitOf(const Model& model) const { return unit.value_or(unitSaidIn(model.cloud.storedAs.comments)); }
  /// A length in the hand as text: in the model's unit, or as a part of the model where that is unknown.
  std::string lengthText(double mm, const WindowSession& session) const {
    const ShownLength shown = shownLength(session);
    return palpate::lengthText(shown.perMm * mm, kFewLengthDigits) + ' ' + shown.unit;
  }
  /// How lengths in the hand are shown, also in the panels.
  struct ShownLength {
    double perMm = 1;
    std::string unit;
  };
  ShownLength shownLength(const WindowSession& session) const {
    constexpr double kPercent = 100;
    const LengthUnit known = unitOf(session.model());
    const double perMm = session.model().scale.toUnits(1);
    if (known != LengthUnit::unknown || !(session.longestSide() > 0)) return {perMm, std::string(nameOf(known))};
    return {kPercent * perMm / session.longestSide(), "% of the model"};
  }
};

/// The sections of the panel, with the keys F2 and following.
inline constexpr std::array<std::string_view, 9> kSections{"Tool",    "Clean",           "Colours", "Feel",  "Look",
                                                           "Measure", "Save and record", "Models",  "Device"};

/// What the mouse does: it is the stylus while Space is held, selects points, or only moves the view.
enum class WindowTool : std::uint8_t { sculpt, select, look };
inline constexpr std::array<std::pair<std::string_view, WindowTool>, 3> kWindowTools{
    {{"sculpting", WindowTool::sculpt}, {"selecting", WindowTool::select}, {"looking", WindowTool::look}}};

/// How points are selected: drawn, by one that is clicked, or by a volume in the model. `label` gives the points under
/// the ball a value in place of selecting them, `lock` locks them; `move` is the box by which the selected points are
/// moved.
enum class SelectShape : std::uint8_t {
  rectangle,
  lasso,
  polygon,
  brush,
  flood,
  same,
  label,
  lock,
  box,
  ball,
  plane,
  move
};
inline constexpr std::array<std::pair<std::string_view, SelectShape>, 12> kSelectShapes{
    {{"rectangle", SelectShape::rectangle},
     {"lasso", SelectShape::lasso},
     {"polygon", SelectShape::polygon},
     {"brush ball", SelectShape::brush},
     {"flood", SelectShape::flood},
     {"same", SelectShape::same},
     {"label", SelectShape::label},
     {"lock", SelectShape::lock},
     {"box", SelectShape::box},
     {"ball", SelectShape::ball},
     {"plane", SelectShape::plane},
     {"move", SelectShape::move}}};
constexpr bool isBall(SelectShape shape) {
  return shape == SelectShape::brush || shape == SelectShape::label || shape == SelectShape::lock;
}
/// How the effect of a ball decreases towards its rim: (1 - r^2) to that power.
inline constexpr std::array<std::pair<std::string_view, std::uint32_t>, 4> kFalloffs{
    {{"flat", 0}, {"sphere", 1}, {"smooth", 2}, {"sharp", 5}}};
struct SelectSettings {
  SelectShape shape = SelectShape::rectangle;
  bool through = false;        ///< also points behind the first surface
  double brush_mm = 5;         ///< radius, also of the label brush
  std::uint32_t falloff = 0;   ///< of kFalloffs: of the ball that locks
  double rim_mm = 0;           ///< width of the soft rim around what is locked, mm in the hand
  bool floodsByColor = false;  ///< else by the direction of the normals
  double angle_deg = 15;       ///< largest angle to the normal of the clicked point
  int colorStep = 24;          ///< largest difference in red, green and blue each, of 255
  /// What `label` and the button Set value set, as typed.
  std::array<char, 512> field{"classification"}, value{};
  bool opensBeside = false;  ///< exported points in a window of their own
};

/// The numbers of the steps that clean a model; each is done alone.
struct CleanSettings : Preparation {
  CleanSettings() {
    outlierNeighbours = 8, radiusNeighbours = 4;
    fillHoles_mm = 5;
    subsample_mm = 1, random = 100'000;
    upright = UpAxis::z;
  }
};

/// All settings.
struct WindowSettings {
  WindowTool tool = WindowTool::sculpt;
  SelectSettings select;
  CleanSettings clean;
  ViewSettings view;
  BrushSettings brush;
  FeelSettings feel;
  bool forcesOn = true;

  /// Chooses what the mouse does, in place of measuring.
  void use(WindowTool chosen) {
    tool = chosen;
    view.measures = false;
  }
};

}  // namespace palpate
