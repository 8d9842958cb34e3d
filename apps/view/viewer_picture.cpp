// The part of Viewer that makes pictures.
#include "apps/view/viewer.hpp"

namespace palpate {

void Viewer::applySettings() {
  gui_.setDark(settings_.view.dark);
  WindowSession* session = document_.session();
  if (!session) return;
  if (settings_.view.up != viewpoint_.fittedUp()) fitCamera();
  if (gui_.isBusy()) return;  // not in the middle of a drag
  session->setForces(settings_.forcesOn);
  messages_.tryTo([&] {
    const bool recorded = session->isRecording();
    // A device cannot be put away: behind a question its hand feels, and changes nothing.
    BrushSettings brush = settings_.brush;
    if (document_.asks() && pointing_.isTouching()) brush.kind.reset();
    session->setBrushSettings(brush);
    session->setFeel(settings_.feel);
    if (recorded && !session->isRecording()) messages_.say("the recording has ended: a log has one brush");
  });
  brushNotes_.noteSize(*session, pointing_.presses(), messages_);
}

// Of the panels, in a window that has another size now: curves that would lie on the model close.
void Viewer::keepClear(const UVec2& before_px, const UVec2& now_px) {
  const double roomy_px = panels_.roomyWidth_px();
  if (before_px.x >= roomy_px && now_px.x < roomy_px) settings_.view.plots = false;
  if (now_px.x > 0) viewpoint_.centerIn(panels_.freeWidth_px(settings_.view, now_px.x), now_px.x);
}

void Viewer::draw(double dt_s) {
  const UVec2 window_px = window_.size_px();
  if (window_px != screen_.size_px()) keepClear(screen_.size_px(), window_px);
  screen_.fit(window_px, settings_.view.waitsForDisplay);
  if (!screen_.isVisible()) return;

  gui_.begin(screen_.size_px(), dt_s);
  const ViewRequests requests = panels_.draw(status(), settings_);
  const PanelShapes panels = gui_.end();
  carryOut(requests);
  applySettings();
  // What the last picture was made of is written anew from here on.
  screen_.waitForLast();

  Screen::Layers layers{.panels = panels, .dark = settings_.view.dark};
  WindowSession* session = document_.session();
  shown_.choosePace(pointing_.isMoving() || (session && session->config().moves()), script_.clock_s(),
                    script_.hasOwnClock());
  if (session) {
    messages_.tryTo([&] { ownCamera_.follow(*session, viewpoint_.camera(), screen_.size_px()); });
    if (pace_.count() > 0) shown_.takePick();
    session->drawn().closeSurface();
    shown_.fit(screen_.size_px(), settings_.view);
    shown_.keepFound(pointing_.isPressing());
    layers.servoCore = session->servoCore();
    layers.model = &shown_.picture();
    layers.drawModel = [&](CommandList& list) {
      viewpoint_.setDepthRange(session->bounds());
      shown_.record(list, *session, viewpoint_.camera(), settings_.view,
                    pointing_.isTouching() || session->isPlaying());
      shown_.picture().recordPick(list, pointing_.cursor_px(), DVec2(screen_.size_px()));
    };
  }
  screen_.show(layers);
  screen_.writeKept(messages_);
}

}  // namespace palpate
