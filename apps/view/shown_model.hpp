// The model in the window: its discs or triangles, their updates after edits, and how they are drawn.
#pragma once

#include "apps/view/model_picture.hpp"
#include "apps/view/settings.hpp"
#include "apps/view/shown_field.hpp"
#include "apps/view/shown_guides.hpp"
#include "apps/view/shown_lines.hpp"
#include "apps/view/shown_mesh.hpp"

namespace palpate {

class Messages;

class ShownModel {
 public:
  explicit ShownModel(Device& sight) : sight_(sight), picture_(sight), mesh_(sight) {}

  /// Called when another model is opened, while the GPU draws nothing.
  void forget();
  /// Called once per frame: takes the edits since the last frame.
  void follow(WindowSession& session, ViewSettings& view, const Measure& measure, Messages& messages);

  /// Reads the depth under the cursor in the last picture, once the GPU has finished it.
  void takePick();
  /// Sets what the next picture shows, and the cursor; `touched`: with the stylus; `size_px`: of the window.
  void aim(const WindowSession& session, const Camera& camera, const ViewSettings& view, bool touched,
           const UVec2& size_px, const DVec2& cursor_px);
  /// Called then with the time: lowers the resolution while drawing is slow and the picture changes, unless `inFull`.
  void choosePace(double clock_s, bool inFull);
  /// Sets the picture's size for the window.
  void fit(const UVec2& window_px, const ViewSettings& view);
  /// Draws that, and notes the depth under the cursor.
  void record(CommandList& list, WindowSession& session, const UVec2& window_px);

  /// The picture that the settings ask for, for a file; the camera's target is in its middle. Nothing else uses the
  /// device's window queue meanwhile.
  Image picture(WindowSession& session, Camera camera, const ViewSettings& view, bool touched, const UVec2& size_px,
                const Measure& measure) const;

  ModelPicture& picture() { return picture_; }
  const ModelPicture& picture() const { return picture_; }
  const ShownMesh& mesh() const { return mesh_; }
  const ShownLines& lines() const { return lines_; }
  const PictureGuides& guides() const { return guides_.guides(); }
  /// Of the colours; empty: they need none.
  std::optional<Legend> legend(const WindowSession& session, const ViewSettings& view) const;
  /// Null if points are not coloured by a field.
  const ColoredField* field() const { return field_.field(); }

 private:
  Device& sight_;
  ModelPicture picture_;
  ShownMesh mesh_;
  ShownLines lines_;
  ShownGuides guides_;
  ShownField field_;
  void followLock(WindowSession& session);

  EditBatch edited_;              // since the last frame
  std::size_t lockedPoints_ = 0;  // for which the picture has weights of locks; 0: not yet
  bool saidOfGaussians_ = false, saidOfBacks_ = false;
  std::uint64_t madeBefore_ = 0;  // pictures of earlier models
  double moved_s_ = 0;            // time of the last frame that differed from the one before
};

}  // namespace palpate
