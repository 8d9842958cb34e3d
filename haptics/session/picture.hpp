// The picture of a session's points, which follows what is done to them.
#pragma once

#include <optional>

#include "engine/core/edit_batch.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/render/image.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/picture_request.hpp"

namespace palpate {

class Journal;

/// Draws the points as discs on a GPU, as they are now. The copy of them there is made for the first picture, and
/// follows the edits afterwards. For one thread, that which takes the session's edits in.
class SessionPicture {
 public:
  /// The device outlives this; nothing else uses its queue of throughput meanwhile.
  explicit SessionPicture(Device& sight) : sight_(sight) {}

  /// What was done since the last call or picture.
  void follow(const EditBatch& batch);
  /// `journal`: of the session, from which all that follow() was told comes, too; null where nothing is edited. Throws
  /// UsageError for what makes no picture, OutOfGpuMemory.
  Image draw(const Model& model, const Journal* journal, const PictureRequest& request);

 private:
  Device& sight_;
  std::optional<DrawnCloud> drawn_;
};

}  // namespace palpate
