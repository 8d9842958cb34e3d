// Picture of a session's points, which follows the edits.
#pragma once

#include <optional>

#include "engine/core/edit_batch.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "engine/render/image.hpp"
#include "haptics/session/picture_request.hpp"
#include "haptics/session/scene.hpp"

namespace palpate {

class History;

/// Draws the present points as discs on a GPU. Their copy there is made for the first picture, and follows the edits
/// afterwards. For one thread, the one that takes the session's edits.
class SessionPicture {
 public:
  /// The device must outlive this object; nothing else uses its throughput queue meanwhile.
  explicit SessionPicture(Device& sight) : sight_(sight) {}

  /// Applies the edits since the last call or picture.
  void follow(const EditBatch& batch);
  /// `history`: of the session, whose edits include all that follow() has received; null if nothing is edited. Throws
  /// UsageError for an invalid picture, or a field that the points do not have, OutOfGpuMemory.
  Image draw(const Layer& layer, const History* history, const PictureRequest& request);

 private:
  /// The field that is asked for, whose numbers colour the points from now on; empty: another colour is.
  std::optional<ColoredField> shownField(const Layer& layer, const History* history, const ColorConfig& color);

  Device& sight_;
  std::optional<DrawnCloud> drawn_;
};

}  // namespace palpate
