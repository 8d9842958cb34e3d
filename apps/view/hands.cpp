#include "apps/view/hands.hpp"

#include <GLFW/glfw3.h>

#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

std::vector<TimedEvent> Hands::takeEvents(const std::vector<WindowEvent>& events, double clock_s) {
  const double from_s = std::exchange(polled_s_, clock_s);
  events_.add(events, from_s, polled_s_);
  if (!isFinishing()) return events_.takeForPicture();
  events_.forgetSeen();  // the next press begins on the surface that this stroke leaves
  return {};
}

bool Hands::isFinishing() const {
  WindowSession* session = parts_.document.session();
  return session && !parts_.document.isGivingWay() && session->isDrawing() && !session->stroke();
}

ViewCommands Hands::handle(const WindowEvent& event) {
  if (std::holds_alternative<ExposeEvent>(event)) parts_.screen.forget();
  if (parts_.gui.feed(event)) return {};
  const auto* key = std::get_if<KeyEvent>(&event);
  const bool repeats = key && keyboard_.note(*key);
  if (dragBrush(event, repeats)) return {};
  if (key && !parts_.gui.wantsKeys() && !parts_.document.asks() && !parts_.panels.areFilesOpen())
    return keyboard_.commandsOf(*key, repeats, parts_.settings);
  if (const auto* mouse = std::get_if<MouseEvent>(&event)) {
    pointing_.moveMouse(mouse->place_px, pointed());
    select_.moveTo(mouse->place_px);
  }
  if (std::holds_alternative<MouseEvent>(event) || std::holds_alternative<WheelEvent>(event)) events_.forgetSeen();
  const bool meansModel = parts_.document.session() && !parts_.gui.wantsMouse() && !parts_.document.asks();
  if (const auto* button = std::get_if<ButtonEvent>(&event)) handle(*button, meansModel);
  if (const auto* wheel = std::get_if<WheelEvent>(&event); wheel && meansModel && !select_.isDrawing())
    pointing_.turnWheel(*wheel, pointed());
  if (const auto* drop = std::get_if<DropEvent>(&event); drop && !drop->files.empty()) {
    parts_.document.offer(drop->files);
    parts_.document.open(drop->files.front());
  }
  if (const auto* push = std::get_if<PushEvent>(&event)) return pointing_.push(*push, pointed());
  if (std::holds_alternative<CloseEvent>(event)) return {WindowCommand::quit};
  return {};
}

void Hands::handle(const ButtonEvent& button, bool meansModel) {
  if (!button.down) pointing_.release(button.button, pointed());
  if (!button.down)
    parts_.messages.tryTo([&] {
      const std::string remark = select_.release(button.button, parts_.settings.select, pointed());
      if (!remark.empty()) parts_.messages.say(remark);
    });
  if (const std::string remark = select_.takeRemark(); !remark.empty()) parts_.messages.say(remark);
  if (pointing_.takeMiss()) parts_.messages.say("nothing is measured: the model is not under the cursor");
  if (button.down && parts_.document.isGivingWay() && pointing_.holdsStylus() && !parts_.gui.wantsMouse())
    parts_.messages.say("no stroke: " + parts_.document.whyWaiting());
  if (button.down && meansModel) parts_.messages.tryTo([&] { press(button.button); });
}

void Hands::press(MouseButton button) {
  const SelectTool::Keys keys{
      .shift = keyboard_.isShiftDown(), .control = keyboard_.isControlDown(), .alt = keyboard_.isAltDown()};
  if (parts_.settings.tool == WindowTool::select && select_.press(button, keys, parts_.settings.select, pointed()))
    return;
  if (parts_.settings.tool == WindowTool::look && button == MouseButton::right) return pointing_.beginTurn();
  pointing_.press(button, keys.shift, parts_.settings.view, pointed());
}

void Hands::walk(double dt_s) {
  if (parts_.document.asks() || parts_.gui.wantsKeys()) walk_.stop();
  if (const WindowSession* const session = parts_.document.session())
    walk_.advance(dt_s, keyboard_.isShiftDown(), session->longestSide(), parts_.viewpoint);
}

void Hands::followTool() {
  if (parts_.settings.tool != WindowTool::sculpt && pointing_.holdsStylus()) pointing_.letGo(pointed());
  if (parts_.settings.tool == WindowTool::select && parts_.document.session() && !parts_.document.asks())
    parts_.settings.view.measures = false;
  else
    select_.cancel();
}

Pointed Hands::pointed() {
  return {.session = parts_.document.session(),
          .viewpoint = parts_.viewpoint,
          .picked = parts_.shown.picture().picked(),
          .size_px = DVec2(parts_.screen.size_px()),
          .time_s = now_s_,
          .surface =
              [this] {
                parts_.screen.waitForLast();
                return parts_.shown.picture().surface(DVec2(parts_.screen.size_px()));
              },
          .measure = parts_.settings.view.measures ? &measure_ : nullptr,
          .waits = parts_.document.isGivingWay()};
}

void Hands::followDevice() {
  const bool mayChange = !parts_.document.loader().isLoading() && !parts_.document.isGivingWay();
  if (!parts_.held.follow(parts_.messages, mayChange)) return;
  parts_.messages.tryTo([&] {
    parts_.document.setDevice(parts_.held.device(), parts_.held.centredFacts());
    pointing_.setDevice(parts_.held.device(), pointed());
  });
  followStiffness(parts_.held.device() ? parts_.held.opened()->remembered.stiffness_N_per_mm : std::nullopt);
}

// A stiffness that is remembered for a device applies while the device is held.
void Hands::followStiffness(std::optional<double> ofDevice_N_per_mm) {
  double& stiffness_N_per_mm = parts_.settings.feel.stiffness_N_per_mm;
  if (!ofDevice_N_per_mm && !ownStiffness_N_per_mm_) return;
  if (!ofDevice_N_per_mm) {
    stiffness_N_per_mm = *std::exchange(ownStiffness_N_per_mm_, {});
    return;
  }
  if (!ownStiffness_N_per_mm_) ownStiffness_N_per_mm_ = stiffness_N_per_mm;
  stiffness_N_per_mm = *ofDevice_N_per_mm;
}

bool Hands::isSculpting() {
  const WindowSession* session = parts_.document.session();
  if (!session || parts_.document.isGivingWay()) return false;
  const auto& ticks = session->recentTicks().rows();
  return session->isDrawing() || (pointing_.isTouching() && !ticks.empty() && ticks.back().contact);
}

// A stroke keeps the brush, and the keys, with which it began: another brush would end it. To feel ends it at once.
BrushSettings Hands::brushInHand() {
  if (!isSculpting()) {
    const bool isHeld = pointing_.isTouching() && parts_.settings.tool == WindowTool::sculpt && !parts_.gui.wantsKeys();
    inHand_.follow({isHeld && keyboard_.isShiftDown(), isHeld && keyboard_.isControlDown()});
  }
  const WindowSession* session = parts_.document.session();
  const bool isInStroke =
      parts_.settings.brush.sculpts && isSculpting() && (session->isDrawing() || session->history().inStroke());
  return isInStroke ? session->brushSettings() : inHand_.brushFrom(parts_.settings.brush);
}

BrushHint Hands::brushHint() {
  if (parts_.settings.tool != WindowTool::sculpt || parts_.document.asks() || !parts_.document.session()) return {};
  return inHand_.hint(parts_.settings.brush, parts_.settings.view, pointing_.cursor_px(),
                      !parts_.gui.wantsMouse() && !isSculpting(), pointed());
}

bool Hands::dragBrush(const WindowEvent& event, bool repeats) {
  if (!inHand_.isDragging()) return false;
  if (const auto* mouse = std::get_if<MouseEvent>(&event)) inHand_.moveTo(mouse->place_px, parts_.settings.brush);
  const auto* key = std::get_if<KeyEvent>(&event);
  const auto* button = std::get_if<ButtonEvent>(&event);
  const bool isPressed = (key && key->down && !repeats) || (button && button->down);
  if (!isPressed) return button || key;
  if ((key && key->key == GLFW_KEY_ESCAPE) || (button && button->button == MouseButton::right))
    inHand_.giveUp(parts_.settings.brush);
  else if (button || key->key == GLFW_KEY_F || key->key == GLFW_KEY_ENTER || key->key == GLFW_KEY_KP_ENTER)
    inHand_.accept();
  return true;
}

bool Hands::carryOut(BrushCommand command) {
  WindowSession* session = parts_.document.session();
  if (!session || parts_.document.isGivingWay()) return false;
  if (command != BrushCommand::cancelStroke) {
    if (!parts_.settings.brush.sculpts) throw Error("choose a brush first (2 to {})", kBrushes.size() + 1);
    if (isSculpting()) return false;
    inHand_.begin(command == BrushCommand::dragSize ? BrushInHand::Drag::size : BrushInHand::Drag::strength,
                  pointing_.cursor_px(), parts_.settings.brush, pointed());
    return true;
  }
  if (!isSculpting() || !session->cancelStroke()) return false;
  pointing_.endStroke(pointed());
  parts_.messages.say("the stroke was taken back");
  return true;
}

DrawnVolume Hands::drawnVolume() {
  const SelectShape shape = parts_.settings.select.shape;
  if (parts_.settings.tool != WindowTool::select || !parts_.document.session() || !isVolume(shape)) return {};
  return select_.volume().drawn(shape, pointed());
}

}  // namespace palpate
