// The selected points of the open model, and what is done with them.
#pragma once

#include <array>
#include <string>

#include "apps/view/commands.hpp"
#include "apps/view/settings.hpp"
#include "engine/select/point_bits.hpp"

namespace palpate {

/// Numbers of existing points.
struct SelectionCounts {
  std::uint64_t selected = 0;  ///< that are shown
  std::uint64_t hidden = 0, locked = 0, within = 0;
};

// All throw Error where the model refuses it. Commands act on the selected points that exist and are shown; those that
// change points, not on locked ones.

/// The points that can be selected: those that exist and are not hidden.
PointBits selectable(const WindowSession& session);
void select(WindowSession& session, const PointBits& found, Combine how);
/// The selected points that a command may change; none without a selection.
PointBits changeable(const WindowSession& session);
/// Moves those.
void moveChangeable(WindowSession& session, const MovePoints& move);
/// Carries out what does not concern the outline. Returns a remark for the user, or an empty text.
std::string carryOut(SelectCommand command, WindowSession& session, const BrushSettings& brush);
/// A field of that name is made if it is missing. Returns a remark. Throws Error also for a value that the
/// field's type cannot have.
std::string carryOut(const SetValue& command, WindowSession& session);
/// Writes the selected points with all that the model has of them, and with `separates` removes them then. Returns a
/// remark. Throws Error also for the model's own file, which is `document` if it was saved to another one, and
/// FileError.
std::string exportSelection(WindowSession& session, const std::string& document, const std::string& file,
                            bool separates);

/// Counts again only when masks or points have changed.
class CountedSelection {
 public:
  const SelectionCounts& of(const WindowSession& session);

 private:
  SelectionCounts counts_;
  std::array<PointSet, kMaskRoles> masks_;
  std::uint64_t version_ = 0;
  const WindowSession* session_ = nullptr;
};

}  // namespace palpate
