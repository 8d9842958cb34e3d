#include "apps/view/brush_notes.hpp"

#include <utility>

#include "apps/cli/touch.hpp"
#include "apps/view/messages.hpp"

namespace palpate {

void BrushNotes::noteSize(const WindowSession& session, const ViewSettings& view, std::uint64_t presses,
                          Messages& messages) {
  const BrushSettings& brush = session.brushSettings();
  const Model& model = session.model();
  if (std::exchange(presses_, presses) != presses) tooSmall_.clear();
  const std::string tooSmall =
      brush.sculpts && !session.config().moves()
          ? remarkOnSmallBrush(brush.radius_mm, model.scale.toMm(model.spacing), "its radius (key ])",
                               [&](double mm) { return view.lengthText(mm, session); })
          : std::string();
  if (tooSmall != std::exchange(tooSmall_, tooSmall) && !tooSmall.empty()) messages.say(tooSmall);
}

void BrushNotes::notePaint(const WindowSession& session, ViewSettings& view, Messages& messages) {
  const bool begins = session.history().inStroke() && !inStroke_;
  inStroke_ = session.history().inStroke();
  if (!begins || !brushHas(session.brushSettings().kind, shared::kPaintsPoints) ||
      view.color.source() == ColorSource::rgb)
    return;
  view.color = {};
  messages.say("colours: the points' own, so that the paint is visible");
}

void BrushNotes::noteBlocked(const WindowSession& session, double now_s) {
  constexpr double kShown_s = 0.25;  // bridges frames without an edit
  const std::uint64_t edits = session.session().blocked().edits;
  if (std::exchange(blockedEdits_, edits) != edits) blockedUntil_s_ = now_s + kShown_s;
  // What is raised or held meets another surface; what is moved inwards the far side of a thin part.
  const bool meets = brushHas(session.brushSettings().kind, shared::kRaisesSurface | shared::kHoldsPoints);
  blocked_ = now_s < blockedUntil_s_ ? meets ? "no room here" : "too thin here" : "";
}

void BrushNotes::noteGain(double gain, bool hasDevice, Messages& messages) {
  if (std::exchange(gain_, gain) == gain) return;
  messages.say(
      fmt::format("hand gain {:.2f}{}", gain,
                  hasDevice ? "" : ": for a device in the hand; the mouse moves the stylus as far as the cursor"));
}

void BrushNotes::noteBack(const WindowSession& session, Messages& messages) {
  // A stroke at a rim may meet nothing in a few edits.
  constexpr std::uint64_t kSurely = 20;
  if (knowsBack_ || session.session().blocked().fromBehind < kSurely) return;
  knowsBack_ = true;
  messages.say(
      "the hand is behind the surface, where brushes do nothing: come from its front, or turn it with Flip (under "
      "Clean)");
}

}  // namespace palpate
