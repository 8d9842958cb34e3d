// Boxes, balls and planes that select, and the box by which selected points are moved.
#pragma once

#include <optional>
#include <string>

#include "apps/view/pointing_devices.hpp"
#include "apps/view/selection.hpp"
#include "engine/select/volume_handles.hpp"

namespace palpate {

/// A volume as the window shows it.
struct DrawnVolume {
  struct Line {
    DVec2 from_px{0}, to_px{0};
  };
  struct Knob {
    DVec2 place_px{0};
    VolumeHandle handle;
    bool isHot = false;  ///< under the cursor, or dragged
  };
  std::vector<Line> lines;
  std::vector<Knob> knobs;
  std::string numbers;  ///< as VolumeTool::set() takes them; empty: of a volume that is rotated, or of none
};

bool isVolume(SelectShape shape);

/// Holds a volume of the model, which the mouse places and drags by its handles. The first press on the model places
/// it, and a drag makes it larger; a press elsewhere is not for this tool.
class VolumeTool {
 public:
  bool isDragging() const { return dragged_ || isPlacing_; }
  /// Whether the left button is for this tool.
  bool press(SelectShape shape, const DVec2& cursor_px, const Pointed& at);
  /// The button is up: the volume stays as it is dragged, and points that move with it move. Throws Error where the
  /// model refuses that. Returns a remark, or an empty text.
  std::string release(const Pointed& at);
  void moveTo(const DVec2& cursor_px) { cursor_px_ = cursor_px; }
  /// Ends a drag, as if it had not begun.
  void endDrag();
  /// Ends a drag, or else removes the volume.
  void cancel();
  /// Selects what is in the volume. Throws Error without one.
  void select(SelectShape shape, Combine how, const Pointed& at);
  /// To a plane: the other side.
  void flip();
  /// Places the volume by numbers in coordinates of the file: of a box two corners "x,y,z:x,y,z", of a ball centre and
  /// radius "x,y,z:r", of a plane a position and a direction "x,y,z:x,y,z". Throws UsageError, and Error for another
  /// shape.
  void set(SelectShape shape, const std::string& typed, const Pointed& at);

  DrawnVolume drawn(SelectShape shape, const Pointed& at);

 private:
  void follow(SelectShape shape, const Pointed& at);
  HandledVolume handled() const { return {*volume_, shape_ == SelectShape::move}; }
  Volume present(const Pointed& at) const;

  SelectShape shape_ = SelectShape::box;
  std::optional<Volume> volume_;         // before the drag
  std::optional<VolumeHandle> dragged_;  // with the mouse
  bool isPlacing_ = false;
  DVec2 pressed_px_{0}, cursor_px_{0};
  const WindowSession* session_ = nullptr;  // of the volume
  PointSet moved_;                          // the selected points of the box, with the version of the points
  std::uint64_t version_ = 0;
};

/// Moves the selected points by numbers as typed, about the middle of their box: a way "x,y,z", angles about the
/// model's axes "x,y,z" in degrees, in this order, and a factor; an empty text leaves that out. Returns a remark.
/// Throws UsageError, and Error where the model refuses it.
std::string moveSelection(WindowSession& session, const MoveSelection& numbers);

}  // namespace palpate
