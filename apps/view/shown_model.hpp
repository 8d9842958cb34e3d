// The model in the window: its discs or triangles, how they follow an edit, and how it is drawn.
#pragma once

#include "apps/view/model_picture.hpp"
#include "apps/view/settings.hpp"
#include "apps/view/shown_lines.hpp"
#include "apps/view/shown_mesh.hpp"

namespace palpate {

class Messages;

class ShownModel {
 public:
  explicit ShownModel(Device& sight) : picture_(sight), mesh_(sight) {}

  /// Another model comes. While the GPU draws nothing.
  void forget();
  /// Once for each picture: what was done to the points since the last one.
  void follow(WindowSession& session, ViewSettings& view, const Measure& measure, Messages& messages);

  /// Takes in what the last picture had under the cursor, once it is done.
  void takePick();
  /// ModelPicture::keepFound().
  void keepFound(bool on) { picture_.keepFound(on); }
  /// Before each picture, at that time: drawn smaller while that is slow and something moves (`moves`: what is not the
  /// points), unless it is wanted in full.
  void choosePace(bool moves, double clock_s, bool inFull);
  /// As large as the window asks for.
  void fit(const UVec2& window_px, const ViewSettings& view);
  /// Draws the model; `touched`: with the stylus at its surface.
  void record(CommandList& list, WindowSession& session, const Camera& camera, const ViewSettings& view, bool touched);

  ModelPicture& picture() { return picture_; }
  const ModelPicture& picture() const { return picture_; }
  const ShownMesh& mesh() const { return mesh_; }
  const ShownLines& lines() const { return lines_; }

 private:
  ModelPicture picture_;
  ShownMesh mesh_;
  ShownLines lines_;
  EditBatch edited_;    // since the last picture
  double moved_s_ = 0;  // when something did last
};

}  // namespace palpate
