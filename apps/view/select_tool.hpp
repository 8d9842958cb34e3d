// The outline that the mouse draws in the picture to select points.
#pragma once

#include "apps/view/volume_tool.hpp"

namespace palpate {

/// An outline as the window shows it.
struct DrawnOutline {
  std::vector<DVec2> corners_px;
  bool isClosed = true;
  double ball_px = 0;  ///< radius of a brush along the corners; 0: they are an outline
};

/// Draws outlines and balls, and selects what they show once they are closed, or labels it. Volumes have a tool of
/// their own.
///
///   stage     press of the left button       release           Enter, right button   Backspace, Alt   Esc
///   idle      dragging; corners (polygon);   -                 -                     -                -
///             selects (flood, same)
///   dragging  -                              selects -> idle   -                     -                idle
///   corners   one more corner                -                 selects -> idle       one less; idle   idle
class SelectTool {
 public:
  enum class Stage { idle, dragging, corners };
  bool isDrawing() const { return stage_ != Stage::idle || volume_.isDragging(); }

  struct Keys {
    bool shift = false, control = false, alt = false;
  };
  /// Whether the button is for this tool; the others move the view. Throws Error where the model refuses selections.
  bool press(MouseButton button, const Keys& keys, const SelectSettings& settings, const Pointed& at);
  void moveTo(const DVec2& place_px);
  /// Returns a remark, or an empty text.
  std::string release(MouseButton button, const SelectSettings& settings, const Pointed& at);
  /// What the last outline did, for the user; returned once.
  std::string takeRemark() { return std::exchange(remark_, {}); }
  /// Commands of the outline; others do nothing.
  void carryOut(SelectCommand command, const SelectSettings& settings, const Pointed& at);
  void cancel() {
    stage_ = Stage::idle;
    volume_.endDrag();
  }
  VolumeTool& volume() { return volume_; }

  /// What is drawn now; with a brush, also while it is not drawn, the ball under the cursor.
  DrawnOutline drawn(const SelectSettings& settings, const Pointed& at) const;

 private:
  void begin(Stage stage, const Keys& keys, const SelectSettings& settings);
  void close(const SelectSettings& settings, const Pointed& at);
  void lockBrushed(const SelectSettings& settings, const Pointed& at) const;
  void takeBack();
  PointBits found(const SelectSettings& settings, const Pointed& at) const;
  std::vector<DVec2> corners() const;

  VolumeTool volume_;
  Stage stage_ = Stage::idle;
  Combine how_ = Combine::set;
  SelectShape shape_ = SelectShape::rectangle;  // of the outline that is drawn
  std::vector<DVec2> path_px_;
  DVec2 cursor_px_{0};
  bool moves_ = false;  // the cursor moves the outline
  std::string remark_;
};

}  // namespace palpate
