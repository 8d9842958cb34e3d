// The edits of a session log, of points, masks and fields: checked against a model, and made again.
#pragma once

#include <filesystem>

#include "engine/edit/history.hpp"
#include "engine/edit/layer_attributes.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// Throws FileError if the edits of a log do not belong to a model with that number of points. Behind a gap a change of
/// a field may be of one whose making is missing.
void requireEditsOf(const std::filesystem::path& log, std::size_t points, const SessionRecord& record);

/// Applies recorded edits to a history of the model, and to its masks and fields: undone and redone ones, too, as far
/// as the history keeps what they undo and redo. Leaves out changes that do not fit (LayerAttributes::fits()).
void followAgain(History& history, LayerAttributes& attributes, const EditBatch& edits);

}  // namespace palpate
