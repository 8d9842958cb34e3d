// The part of Viewer that takes what a person does: camera, stylus, keys.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/view/viewer.hpp"
#include "engine/render/camera_motion.hpp"

namespace palpate {

namespace {

constexpr double kZoomPerNotch = 0.85;     // of the distance that is left
constexpr double kDepthPerNotch_mm = 0.5;  // of the stylus
constexpr double kHover_mm = 4;            // before the surface
constexpr double kDoubleClick_s = 0.35, kDoubleClick_px = 6;
constexpr double kRadiusStep = 1.1;                           // of the tool, for one press of [ or ]
constexpr double kNearest = 1e-3, kFarthest = 50;             // of the eye from what it goes to, longest sides
constexpr double kZoom_per_s = 1.5;                           // with the cap of a 3D mouse
constexpr double kDeepestPush_mm = 6, kFarthestPush_mm = 60;  // of the stylus behind and before the surface
constexpr double kStickDead = 0.15, kStick_px_per_s = 700, kStick_mm_per_s = 20;

}  // namespace

void Viewer::handle(const WindowEvent& event) {
  gui_.feed(event);
  if (const auto* key = std::get_if<KeyEvent>(&event)) handleKey(*key);
  if (const auto* mouse = std::get_if<MouseEvent>(&event)) handleMouse(mouse->place_px);
  if (const auto* button = std::get_if<ButtonEvent>(&event)) handleButton(*button);
  if (const auto* wheel = std::get_if<WheelEvent>(&event)) handleWheel(*wheel);
  if (const auto* drop = std::get_if<DropEvent>(&event); drop && !drop->files.empty()) {
    for (const std::string& file : drop->files)
      if (!std::ranges::count(options_.models, file)) options_.models.push_back(file);
    open(drop->files.front());
  }
  if (const auto* push = std::get_if<PushEvent>(&event)) handlePush(*push);
  if (std::holds_alternative<CloseEvent>(event)) closes_ = true;
}

bool Viewer::isDown(int left, int right) const {
  return keys_[static_cast<std::size_t>(left)] || keys_[static_cast<std::size_t>(right)];
}

void Viewer::handleKey(const KeyEvent& event) {
  if (event.key < 0 || static_cast<std::size_t>(event.key) >= keys_.size()) return;
  const bool repeats = std::exchange(keys_[static_cast<std::size_t>(event.key)], event.down) == event.down;
  if (gui_.wantsKeys() || asksAboutChanges() || saveQuestion_) return;
  if (event.key == GLFW_KEY_SPACE) {
    if (!repeats) holdStylus(event.down || stylusLocked_);
    return;
  }
  if (!event.down) return;
  const bool ctrl = isDown(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
  const bool shift = isDown(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
  ViewWishes wishes;
  if (ctrl) {
    wishes.undo = event.key == GLFW_KEY_Z && !shift;
    wishes.redo = (event.key == GLFW_KEY_Z && shift) || event.key == GLFW_KEY_Y;
    wishes.save = event.key == GLFW_KEY_S;
    wishes.quit = event.key == GLFW_KEY_Q;
    return obey(wishes);
  }
  switch (event.key) {
    case GLFW_KEY_X:
    case GLFW_KEY_Y:
    case GLFW_KEY_Z:
      camera_ = alongAxis(camera_, event.key - GLFW_KEY_X, !shift, up());
      break;
    case GLFW_KEY_R:
      fitCamera();
      break;
    case GLFW_KEY_H:
      view_.help = !view_.help;
      break;
    case GLFW_KEY_TAB:
      view_.panels = !view_.panels;
      break;
    case GLFW_KEY_C:
      view_.plots = !view_.plots;
      break;
    case GLFW_KEY_M:
      view_.mesh = !view_.mesh && session_ != nullptr;
      break;
    case GLFW_KEY_T:
      stylusLocked_ = !stylusLocked_;
      holdStylus(stylusLocked_);
      break;
    case GLFW_KEY_P:
      wishes.screenshot = true;
      break;
    case GLFW_KEY_Q:
      wishes.quit = true;
      break;
    case GLFW_KEY_BACKSPACE:
      forcesOn_ = !forcesOn_;
      say(forcesOn_ ? "forces on" : "forces off");
      break;
    case GLFW_KEY_LEFT_BRACKET:
    case GLFW_KEY_RIGHT_BRACKET: {
      constexpr double kLeast_mm = 0.5, kMost_mm = 30;
      const double factor = event.key == GLFW_KEY_RIGHT_BRACKET ? kRadiusStep : 1 / kRadiusStep;
      tool_.radius_mm = std::clamp(tool_.radius_mm * factor, kLeast_mm, kMost_mm);
      break;
    }
    case GLFW_KEY_ESCAPE:
      view_.help = false;
      stylusLocked_ = false;
      holdStylus(false);
      break;
    default:
      if (event.key == GLFW_KEY_1) tool_.brush.reset();
      if (event.key > GLFW_KEY_1 && event.key <= GLFW_KEY_1 + static_cast<int>(kBrushKinds.size()))
        tool_.brush = kBrushKinds[static_cast<std::size_t>(event.key - GLFW_KEY_1 - 1)].second;
  }
  obey(wishes);
}

void Viewer::handleMouse(const DVec2& place_px) {
  const DVec2 way_px = place_px - std::exchange(cursor_px_, place_px);
  byGamepad_ = false;
  if (drag_ == Drag::orbit) camera_ = orbited(camera_, pivot_, way_px, size());
  if (drag_ == Drag::pan) camera_ = panned(camera_, dragDepth_, way_px, size());
}

std::optional<DVec3> Viewer::placeUnderCursor() const {
  if (!(picked_.depth > 0)) return std::nullopt;
  return camera_.unproject(cursor_px_, picked_.depth, size());
}

void Viewer::handleButton(const ButtonEvent& event) {
  if (!event.down) {
    drag_ = Drag::none;
    if (event.button == MouseButton::left) pressing_ = false;
    return;
  }
  if (!session_ || gui_.wantsMouse()) return;
  const bool left = event.button == MouseButton::left;
  if (stylus_ && left) {
    pressing_ = true;
    toolRemark_.clear();
    extraPress_mm_ = 0;
    drag_ = Drag::press;
    return;
  }
  const auto place = placeUnderCursor();
  const bool again =
      left && clock_s() - clicked_s_ < kDoubleClick_s && glm::distance(clicked_px_, cursor_px_) < kDoubleClick_px;
  clicked_px_ = cursor_px_;
  clicked_s_ = clock_s();
  if (again && place) {
    camera_ = recentred(camera_, *place);
    return;
  }
  pivot_ = place.value_or(camera_.target);
  dragDepth_ = std::max(glm::dot(pivot_ - camera_.eye, camera_.axes().forward), camera_.nearDepth);
  const bool pans = event.button == MouseButton::middle || (left && isDown(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT));
  drag_ = pans ? Drag::pan : Drag::orbit;
}

void Viewer::handleWheel(const WheelEvent& event) {
  if (!session_ || gui_.wantsMouse()) return;
  if (stylus_) {
    double& depth_mm = pressing_ ? extraPress_mm_ : hover_mm_;
    depth_mm += (pressing_ ? 1 : -1) * kDepthPerNotch_mm * event.away;
    return;
  }
  if (event.right != 0)
    camera_ = panned(camera_, glm::distance(camera_.eye, camera_.target), {-20 * event.right, 0}, size());
  const double side = session_->longestSide();
  camera_ = zoomed(camera_, placeUnderCursor().value_or(camera_.target), std::pow(kZoomPerNotch, event.away),
                   kNearest * side, kFarthest * side);
}

void Viewer::holdStylus(bool on) {
  on = on && session_ && session_->isTouching() && !options_.session.device;
  if (on == stylus_) return;
  stylus_ = on;
  pressing_ = false;
  drag_ = Drag::none;
  hover_mm_ = kHover_mm;
  extraPress_mm_ = padPress_ = 0;
  planeDepth_ = 0;
  putDown_ = false;
  if (!on && session_) session_->lift();
  window_.showCursor(!on);
}

void Viewer::useGamepad(double dt_s) {
  const auto pad = window_.gamepad();
  if (!pad || !session_) return;
  const auto beyondDead = [](const DVec2& stick) { return glm::length(stick) > kStickDead ? stick : DVec2(0); };
  const DVec2 move = beyondDead(pad->left), depth = beyondDead(pad->right);
  if (pad->a && !stylus_) holdStylus(true);
  if (pad->b && stylus_ && byGamepad_) holdStylus(stylusLocked_);
  if (!stylus_) {
    if (move != DVec2(0))
      camera_ = orbited(camera_, camera_.target, kStick_px_per_s * dt_s * DVec2(move.x, -move.y), size());
    return;
  }
  if (move == DVec2(0) && depth == DVec2(0) && pad->rightTrigger + pad->leftTrigger < kStickDead && !byGamepad_) return;
  byGamepad_ = true;
  cursor_px_ = glm::clamp(cursor_px_ + kStick_px_per_s * dt_s * DVec2(move.x, -move.y), DVec2(0), size() - 1.0);
  hover_mm_ -= kStick_mm_per_s * dt_s * depth.y;
  padPress_ = pad->rightTrigger - pad->leftTrigger;
}

void Viewer::listenToSpaceMouse() {
  if (!spaceMouse_) return;
  for (const std::string& remark : spaceMouse_->takeRemarks()) say(remark);
  if (const auto event = spaceMouse_->changed()) handle(*event);
}

void Viewer::handlePush(const PushEvent& event) {
  constexpr std::uint32_t kHold = 1, kFit = 2;
  const std::uint32_t pressed = event.buttons & ~std::exchange(push_, event).buttons;
  if (!session_) return;
  if (pressed & kHold) {
    stylusLocked_ = !stylus_;
    holdStylus(stylusLocked_);
  }
  if (pressed & kFit) fitCamera();
}

// The cap is the model, or the stylus while that is held.
void Viewer::usePush(double dt_s) {
  if (!session_ || (push_.push == DVec3(0) && push_.turn == DVec3(0))) return;
  const DVec2 way_px = kStick_px_per_s * dt_s * DVec2(push_.push.x, -push_.push.y);
  if (stylus_) {
    byGamepad_ = true;
    cursor_px_ = glm::clamp(cursor_px_ + way_px, DVec2(0), size() - 1.0);
    hover_mm_ = std::clamp(hover_mm_ + kStick_mm_per_s * dt_s * push_.push.z, -kDeepestPush_mm, kFarthestPush_mm);
    return;
  }
  const double side = session_->longestSide();
  camera_ = panned(camera_, glm::distance(camera_.eye, camera_.target), way_px, size());
  camera_ =
      zoomed(camera_, camera_.target, std::exp(-kZoom_per_s * dt_s * push_.push.z), kNearest * side, kFarthest * side);
  camera_ = orbited(camera_, camera_.target, kStick_px_per_s * dt_s * DVec2(push_.turn.y, push_.turn.x), size());
}

void Viewer::moveStylus(double dt_s) {
  if (options_.session.device) {
    const auto axes = camera_.axes();
    options_.session.device->look({axes.right, axes.up, -axes.forward});
    return;
  }
  useGamepad(dt_s);
  usePush(dt_s);
  if (!stylus_ || !session_ || session_->isPlaying()) return;
  const ModelScale& scale = session_->model().scale;
  // The surface that is seen, where the last picture was looked at close to here; else the stylus keeps its depth.
  constexpr double kClose_px = 3;
  const bool looked = glm::distance(picked_.place_px, cursor_px_) < kClose_px;
  const bool seen = looked && picked_.depth > 0;
  // A hand that presses in one place goes no deeper because the surface gives way.
  const bool rests =
      (pressing_ || padPress_ != 0 || hover_mm_ < 0) && glm::distance(picked_.place_px, planePlace_px_) < kClose_px;
  if (seen && (planeDepth_ == 0 || (view_.followsSurface && !rests))) {
    planeDepth_ = picked_.depth;
    planePlace_px_ = picked_.place_px;
  }
  // Until then a guess, which must not hold the stylus back from the surface once that is seen.
  double depth = planeDepth_ > 0 ? planeDepth_ : picked_.depth;
  if (!(depth > 0)) {
    // Where nothing is known yet the stylus waits for the next picture: it must not begin inside the model, which it
    // would never feel from there.
    if (!looked) return;
    depth = glm::dot(camera_.target - camera_.eye, camera_.axes().forward);
  }
  double inward_mm = -hover_mm_;
  if (pressing_) inward_mm = view_.press_mm + extraPress_mm_;
  if (padPress_ != 0) inward_mm = -hover_mm_ + padPress_ * (hover_mm_ + view_.press_mm);
  // Put down before the surface, also by a hand that presses already: from behind it nothing would be felt.
  if (!std::exchange(putDown_, true)) inward_mm = -kHover_mm;
  const DVec3 place = camera_.unproject(cursor_px_, depth, size());
  const DVec3 along = glm::normalize(place - camera_.eye);
  session_->aim(session_->model().cloud.origin + place + scale.toUnits(inward_mm) * along);
}

}  // namespace palpate
