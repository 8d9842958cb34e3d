// The part of Viewer that draws a frame.
#include <utility>

#include "apps/view/viewer.hpp"

namespace palpate {

void Viewer::applySettings() {
  gui_.setLook(settings_.view.dark, settings_.view.text_percent);
  WindowSession* session = document_.session();
  if (!session) return;
  if (settings_.view.up != viewpoint_.fittedUp()) commands_.fitCamera();
  if (gui_.isBusy()) return;  // not in the middle of a drag
  session->setForces(settings_.forcesOn);
  brushNotes_.noteGain(settings_.feel.handGain, held_.device() != nullptr, messages_);
  messages_.tryTo([&] {
    const bool recorded = session->isRecording();
    // A held device cannot be put away: behind a question it feels, but does not sculpt.
    BrushSettings brush = hands_.brushInHand();
    if (document_.asks() && hands_.pointing().isTouching()) brush.sculpts = false;
    session->setBrushSettings(brush);
    FeelSettings feel = settings_.feel;
    if (!held_.device()) feel.handGain = 1;  // the mouse says where the stylus is
    session->setFeel(feel);
    if (recorded && !session->isRecording())
      messages_.say("the recording has ended: a log cannot contain a change of settings");
  });
  brushNotes_.noteSize(*session, settings_.view, hands_.pointing().presses(), messages_);
}

// After a change of the window's width: closes panels that would cover the model.
void Viewer::keepClear(double before_px, double now_px) {
  const double roomy_px = panels_.roomyWidth_px();
  if (before_px >= roomy_px && now_px < roomy_px) settings_.view.plots = false;
  if (document_.session() && panels_.hasRoomBeside(before_px) != panels_.hasRoomBeside(now_px))
    settings_.view.panels = panels_.hasRoomBeside(now_px);
}

bool Viewer::draw(double dt_s) {
  const UVec2 window_px = window_.size_px();
  if (window_px.x != screen_.size_px().x && screen_.isVisible() && window_px.x > 0)
    keepClear(screen_.size_px().x, window_px.x);
  const DVec2 free_px = panels_.freeWidth_px(settings_.view, window_px.x);
  if (window_px.x > 0 && (std::exchange(free_px_, free_px) != free_px || window_px.x != screen_.size_px().x))
    viewpoint_.centerIn(free_px, window_px.x);
  screen_.fit(window_px, settings_.view.waitsForDisplay);
  if (!screen_.isVisible()) return false;

  gui_.begin(screen_.size_px(), dt_s);
  const ViewCommands commands = panels_.draw(report_.status(), settings_);
  const PanelShapes panels = gui_.end();
  commands_.carryOut(commands);
  applySettings();
  // From here on the resources of the last frame are overwritten.
  screen_.waitForLast();

  Screen::Layers layers{.panels = panels, .dark = settings_.view.dark};
  WindowSession* session = document_.session();
  // While the model is parked, its last picture stays.
  if (document_.isGivingWay() && shown_.picture().hasSize(screen_.size_px())) layers.model = &shown_.picture();
  if (session) {
    messages_.tryTo([&] { ownCamera_.follow(*session, viewpoint_.camera(), screen_.size_px()); });
    if (pace_.count() > 0) shown_.takePick();
    session->drawn().closeSurface();
    layers.servoCore = session->session().live()->core();
    layers.model = &shown_.picture();
    viewpoint_.project(settings_.view.orthographic);
    viewpoint_.setDepthRange(session->bounds(), session->longestSide());
    shown_.aim(*session, viewpoint_.camera(), settings_.view, hands_.pointing().isTouching() || session->isPlaying(),
               screen_.size_px(), hands_.pointing().cursor_px());
    shown_.choosePace(script_.clock_s(), script_.hasOwnClock() || screen_.isKeeping());
    shown_.fit(screen_.size_px(), settings_.view);
    layers.modelDiffers = shown_.picture().differs();
    layers.drawModel = [&](CommandList& list) { shown_.record(list, *session, screen_.size_px()); };
  }
  const bool isShown = screen_.show(layers);
  screen_.writeKept(messages_);
  return isShown;
}

}  // namespace palpate
