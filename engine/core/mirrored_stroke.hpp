// A hand's strokes and, with symmetry, their mirror images.
#pragma once

#include "engine/core/brush_stroke.hpp"

namespace palpate {

/// As BrushStroke, which it is without BrushOptions::symmetry. With symmetry a second tool does what the hand's does,
/// mirrored at the plane, and edits alternate between both: after each edit of the hand's tool follows one of its image
/// at the same position of the path, in the same stroke. Each takes its effect of the time since its own last edit, so
/// that an edit costs what it costs without symmetry. Each tool finds the surface on its side by itself, so that the
/// cloud need not be symmetric, and acts on that side only (isOnOwnSide()): a stroke across the plane is as deep as
/// without symmetry. Allocates nothing.
class MirroredStroke {
 public:
  using Tool = BrushStroke::Tool;

  /// `support`: support radius, model units.
  explicit MirroredStroke(double support) : hand_(support), image_(support) {}

  void setBrush(const BrushOptions& brush);
  void feel(const Contact& contact, const DVec3& hip, const DVec3& spring, Press press, double time_s);
  bool hasWay() const { return hand_.hasWay() || owesImage_; }
  void end();
  void awaitRelease();
  void restart();
  void lift();

  bool isGoingOn() const { return hand_.isGoingOn() || owesImage_; }
  bool acts() const { return hand_.acts() || owesImage_; }
  const Tool& next(double time_s, const Backlog& backlog = {});
  const Tool& tool() const { return tool_; }
  void note(const SurfaceMeasure& measure) { (isImage_ ? image_ : hand_).note(measure); }

  /// Of the stroke to which the last tool belongs.
  std::uint32_t number() const { return tool_.stroke; }

 private:
  BrushStroke hand_, image_;
  BrushOptions brush_;
  Tool tool_{}, imageTool_{};
  bool owesImage_ = false;  // the hand's tool has edited, and its image has not
  bool isImage_ = false;    // tool_ is the image's
};

}  // namespace palpate
