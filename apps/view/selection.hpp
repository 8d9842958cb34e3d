// The selected points of the open model, and what is done with them.
#pragma once

#include <string>

#include "apps/view/commands.hpp"
#include "apps/view/settings.hpp"
#include "engine/select/point_bits.hpp"

namespace palpate {

/// Numbers of existing points.
struct SelectionCounts {
  std::uint64_t selected = 0;  ///< that are shown
  std::uint64_t hidden = 0, locked = 0, within = 0;
  std::uint64_t inPart = 0;  ///< of the locked ones, those that are locked in part
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
/// The points for which an expression holds, of those that can be selected. `up`: of the field height. Throws
/// ExpressionError with the column.
PointBits pointsWhere(const WindowSession& session, const std::string& condition, UpAxis up);
/// Carries out what does not concern the outline. `rim_mm`: width of the rim of what it locks. Returns a remark for the
/// user, or an empty text.
std::string carryOut(SelectCommand command, WindowSession& session, const BrushSettings& brush, double rim_mm);
/// Set a field, which is made if it is missing, as one change. Return a remark. Throw Error also for a value that the
/// field's type cannot have, and for a field of that name which would lose its values.
std::string carryOut(const SetValue& command, WindowSession& session);
std::string carryOut(const KeepSelection& command, WindowSession& session);
/// The same of these points without those that brushes leave as they are.
std::string label(WindowSession& session, const PointBits& found, const SetValue& label);
/// Writes the selected points with all that the model has of them, and with `separates` removes them then. Returns a
/// remark. Throws Error also for the model's own file, which is `document` if it was saved to another one, and
/// FileError.
std::string exportSelection(WindowSession& session, const std::string& document, const std::string& file,
                            bool separates);

/// Opens a file in a window of another process of this program, and does not wait for it.
void openInAnotherWindow(const std::string& file);

/// Counts again only when masks or points have changed.
class CountedSelection {
 public:
  const SelectionCounts& of(const WindowSession& session);

 private:
  SelectionCounts counts_;
  std::uint64_t version_ = 0;
  const WindowSession* session_ = nullptr;
};

}  // namespace palpate
