// The part of Document for models that move: a camera's frames are paused, sculpted and resumed; simulations.
#include <cmath>

#include "apps/view/document.hpp"
#include "apps/view/messages.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

void Document::sayWhatFramesLack() {
  const auto counts = session_->session().playCounts();
  if (!counts) return;
  const bool hasLost = counts->lost > 0, isSilent = counts->silentSince_s.has_value();
  if (hasLost && !saidOfFrames_.lost) messages_.say("a frame was lost: " + counts->lastLoss);
  if (isSilent && !saidOfFrames_.silent)
    messages_.say(fmt::format("no frame received for {:.1f} s; the last one stays{}", *counts->silentSince_s,
                              std::isinf(counts->staysTrue_s) ? "" : fmt::format(" {:g} s", counts->staysTrue_s)));
  saidOfFrames_ = {.lost = hasLost, .silent = isSilent};
}

void Document::sayWhatSimulationLacks() {
  SimulationControl* const simulation = session_->session().simulation();
  if (!simulation) return;
  const std::string failure = simulation->failure();
  if (failure == saidOfSimulation_) return;
  saidOfSimulation_ = failure;
  if (!failure.empty()) messages_.sayError(fmt::format("the simulation {}; N restarts it", failure));
}

void Document::step() {
  if (session_->isHeldStill()) return messages_.say("only this frame is being sculpted; K continues the frames");
  session_->stepFrame();
}

void Document::restart() {
  SimulationControl* const simulation = session_->session().simulation();
  if (!simulation) return;
  simulation->reset();
  saidOfSimulation_.clear();
  messages_.say("the scene restarts");
}

void Document::pause() {
  if (SimulationControl* const simulation = session_->session().simulation()) {
    simulation->pause(!simulation->isPaused());
    return messages_.say(simulation->isPaused() ? "the scene is paused" : "the scene continues");
  }
  if (session_->isHeldStill()) return letFramesGoOn();
  if (const auto held = session_->holdFrames()) messages_.say(*held ? "frames are paused" : "frames continue");
}

void Document::sculptHeld() {
  if (!session_->holdsFrames() || !parts_.settings.brush.sculpts || !session_->isTouching() || loader_.isLoading())
    return;
  WindowOptions options = opened_;
  options.config.model.stream.reset();
  handOn(HandedOn::held, options);
}

void Document::letFramesGoOn() {
  const auto goOn = [this] { handOn(HandedOn::toGoOn, opened_); };
  // Without fusion the next frame replaces all points.
  if (opened_.config.model.stream->fuse) return goOn();
  leave("the frames continue", goOn);
}

void Document::handOn(HandedOn to, WindowOptions options) {
  WindowSession::HandedOn handed = session_->handOn();
  handedOn_ = to;
  agreed_ = Agreed::yes;
  const bool keepsStrokes = opened_.config.model.stream->fuse || to == HandedOn::held;
  mapIsChanged_ = keepsStrokes && isChanged();
  options.live.attributes = std::move(handed.attributes);
  loader_.open(std::move(options), parts_.settings.brush, parts_.settings.feel, std::move(handed.model));
}

}  // namespace palpate
