#include "apps/view/pointing_devices.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/view/messages.hpp"
#include "apps/view/place_info.hpp"
#include "apps/view/window.hpp"

namespace palpate {

namespace {

constexpr double kZoomPerNotch = 0.85;  // factor of the distance
constexpr double kZoom_per_s = 1.5;     // with the cap of a 3D mouse
constexpr double kDepthPerNotch_mm = 0.5;
constexpr double kStickDead = 0.15, kStick_px_per_s = 700, kStick_mm_per_s = 20;

PointerStroke* strokeOf(const Pointed& at) { return at.session ? at.session->stroke() : nullptr; }

}  // namespace

PointingDevices::PointingDevices(Window& window, bool listens) : window_(window) {
  if (listens) spaceMouse_.emplace();
}

void PointingDevices::setDevice(std::shared_ptr<TurnedDevice> device, const Pointed& at) {
  letGo(at);
  device_ = std::move(device);
}

bool PointingDevices::mayMove() const {
  return isTouching() || (spaceMouse_ && spaceMouse_->isThere()) || window_.gamepad();
}

void PointingDevices::moveMouse(const DVec2& place_px, const Pointed& at) {
  const DVec2 way_px = place_px - std::exchange(cursor_px_, place_px);
  hand_.giveToPad(false);
  if (PointerStroke* stroke = strokeOf(at)) stroke->moveTo(place_px, at.time_s);
  at.viewpoint.set(drag_.moved(at.viewpoint.camera(), way_px, at.size_px));
}

std::optional<DVec3> PointingDevices::placeUnderCursor(const Pointed& at) const {
  return at.viewpoint.placeAt(cursor_px_, at.picked.depth, at.size_px);
}

void PointingDevices::release(MouseButton button, const Pointed& at) {
  drag_.end();
  constexpr double kStill_px = 3;  // less motion than this is a click, more rotates the view
  if (const auto missed = std::exchange(missed_px_, std::nullopt))
    hasMissed_ = glm::distance(*missed, cursor_px_) <= kStill_px;
  if (PointerStroke* stroke = strokeOf(at); stroke && button == MouseButton::left) stroke->release(at.time_s);
}

// Along the surface as the picture shows it now, before the stroke changes it.
void PointingDevices::beginStroke(const ViewSettings& view, const Pointed& at) {
  ++presses_;
  drag_.beginOther();
  StrokeOptions options = at.session->strokeOptions(view.press_mm);
  options.inPlane = !view.followsSurface;
  options.string_px = view.string_px;
  at.session->press(PointerStroke(at.surface(), options, cursor_px_, at.time_s));
}

void PointingDevices::press(MouseButton button, bool shift, const ViewSettings& view, const Pointed& at) {
  const bool left = button == MouseButton::left;
  if (hand_.isHeld() && left) return beginStroke(view, at);
  const auto place = placeUnderCursor(at);
  if (at.measure && left && !shift && place) {
    const Camera& camera = at.viewpoint.camera();
    const double pixel = camera.pixelSize(at.picked.depth, at.size_px.y);
    at.measure->take(pickedAt(*at.session, *place, pixel));
    drag_.beginOther();
    return;
  }
  if (at.measure && left && !shift) missed_px_ = cursor_px_;
  const bool again = left && drag_.isDoubleClick(at.time_s, cursor_px_);
  drag_.noteClick(at.time_s, cursor_px_);
  if (again && place) return at.viewpoint.lookAt(*place);
  const Camera& camera = at.viewpoint.camera();
  drag_.begin(camera, place.value_or(camera.target), button == MouseButton::middle || (left && shift));
}

void PointingDevices::turnWheel(const WheelEvent& event, const Pointed& at) {
  if (PointerStroke* stroke = strokeOf(at))
    return stroke->deepen(at.session->model().scale.toUnits(kDepthPerNotch_mm * event.away), at.time_s);
  if (hand_.isHeld()) return hand_.lower(kDepthPerNotch_mm * event.away);
  constexpr double kScroll_px = 20;
  if (event.right != 0) at.viewpoint.move({-kScroll_px * event.right, 0}, at.size_px);
  at.viewpoint.zoom(placeUnderCursor(at), std::pow(kZoomPerNotch, event.away), at.session->longestSide());
}

std::optional<PushEvent> PointingDevices::takePush(Messages& messages) {
  if (!spaceMouse_) return std::nullopt;
  for (const std::string& remark : spaceMouse_->takeRemarks()) messages.say(remark);
  const auto push = spaceMouse_->changed();
  return device_ ? std::nullopt : push;
}

ViewCommands PointingDevices::push(const PushEvent& event, const Pointed& at) {
  constexpr std::uint32_t kHold = 1, kFit = 2;
  const std::uint32_t pressed = event.buttons & ~std::exchange(push_, event).buttons;
  if (!at.session) return {};
  if (pressed & kHold) {
    hand_.lock(!hand_.isHeld());
    hold(hand_.isLocked(), at);
  }
  if (pressed & kFit) return {WindowCommand::resetView};
  return {};
}

void PointingDevices::carryOut(StylusCommand command, const Pointed& at) {
  if (command == StylusCommand::lockOrUnlock) hand_.lock(!hand_.isLocked());
  if (command == StylusCommand::putAway) hand_.lock(false);
  hold(command == StylusCommand::hold || hand_.isLocked(), at);
}

void PointingDevices::endStroke(const Pointed& at) {
  drag_.end();
  if (PointerStroke* stroke = strokeOf(at)) stroke->release(at.time_s);
}

void PointingDevices::letGo(const Pointed& at) {
  hand_.lock(false);
  hold(false, at);
  drag_.end();
}

void PointingDevices::hold(bool on, const Pointed& at) {
  on = on && (at.session ? at.session->isTouching() : at.waits) && !device_;
  if (on == hand_.isHeld()) return;
  hand_.hold(on);
  endStroke(at);
  if (!on && at.session) at.session->lift();
  window_.showCursor(!on);
}

void PointingDevices::moveCursor(const DVec2& way_px, const Pointed& at) {
  hand_.giveToPad(true);
  cursor_px_ = glm::clamp(cursor_px_ + way_px, DVec2(0), at.size_px - 1.0);
  if (PointerStroke* stroke = strokeOf(at)) stroke->moveTo(cursor_px_, at.time_s);
}

void PointingDevices::moveByPad(double dt_s, const Pointed& at) {
  const auto pad = window_.gamepad();
  if (!pad || !at.session) return;
  const auto beyondDead = [](const DVec2& stick) { return glm::length(stick) > kStickDead ? stick : DVec2(0); };
  const DVec2 move = beyondDead(pad->left), depth = beyondDead(pad->right);
  const DVec2 way_px = kStick_px_per_s * dt_s * DVec2(move.x, -move.y);
  if (pad->a && !hand_.isHeld()) hold(true, at);
  if (pad->b && hand_.isHeld() && hand_.isByPad()) hold(hand_.isLocked(), at);
  if (!hand_.isHeld()) {
    if (move != DVec2(0)) at.viewpoint.turn(way_px, at.size_px);
    return;
  }
  if (move == DVec2(0) && depth == DVec2(0) && pad->rightTrigger + pad->leftTrigger < kStickDead && !hand_.isByPad())
    return;
  moveCursor(way_px, at);
  hand_.lower(kStick_mm_per_s * dt_s * depth.y);
  hand_.pressByTrigger(pad->rightTrigger - pad->leftTrigger);
}

// The cap moves the model, or the stylus while it is held.
void PointingDevices::moveByCap(double dt_s, const Pointed& at) {
  if (!at.session || (push_.push == DVec3(0) && push_.turn == DVec3(0))) return;
  const DVec2 way_px = kStick_px_per_s * dt_s * DVec2(push_.push.x, -push_.push.y);
  if (hand_.isHeld()) {
    moveCursor(way_px, at);
    hand_.lift(kStick_mm_per_s * dt_s * push_.push.z);
    return;
  }
  at.viewpoint.move(way_px, at.size_px);
  at.viewpoint.zoom({}, std::exp(-kZoom_per_s * dt_s * push_.push.z), at.session->longestSide());
  at.viewpoint.turn(kStick_px_per_s * dt_s * DVec2(push_.turn.y, push_.turn.x), at.size_px);
}

void PointingDevices::move(double dt_s, const ViewSettings& view, const Pointed& at) {
  const Camera& camera = at.viewpoint.camera();
  if (device_) {
    const auto axes = camera.axes();
    device_->setAxes({axes.right, axes.up, -axes.forward});
    return;
  }
  moveByPad(dt_s, at);
  moveByCap(dt_s, at);
  if (!hand_.isHeld() || !at.session || at.session->isPlaying()) return;
  if (at.session->isDrawing()) {  // it is put down at the first aim after the stroke
    hand_.putDownAgain();
    return at.session->lift();
  }
  const double beside = glm::dot(camera.target - camera.eye, camera.axes().forward);
  const auto depth = hand_.depthAt(cursor_px_, at.picked, view.followsSurface, beside);
  if (depth) aimAt(camera.unproject(cursor_px_, *depth, at.size_px), view, at);
}

// A stylus that sculpts aims at its press depth below the surface, along the normal, plus the displacement of its
// spring and hand.
void PointingDevices::aimAt(const DVec3& place, const ViewSettings& view, const Pointed& at) {
  const Model& model = at.session->model();
  const double inward_mm = hand_.takeInward_mm(view.press_mm);
  const double given_mm = at.session->givenWay_mm();
  DVec3 way = -model.scale.toUnits(inward_mm) * at.viewpoint.camera().towardsViewer(place);
  if (inward_mm > 0 && given_mm > 0)
    way = -model.scale.toUnits(inward_mm + given_mm) * normalAt(at.picked, at.viewpoint.camera(), at.size_px);
  at.session->aim(model.cloud.origin + place + way, hand_.sculpts());
}

}  // namespace palpate
