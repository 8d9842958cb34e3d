// The part of Panels about the device in the hand: which one, its state, the guided test, and the choice of another.
#include <imgui.h>

#include <algorithm>

#include "apps/cli/doctor_device.hpp"
#include "apps/view/held_device.hpp"
#include "apps/view/panels.hpp"

namespace palpate {

namespace {

void line(const std::string& text) { ImGui::TextWrapped("%s", text.c_str()); }

void faintLine(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  line(text);
  ImGui::PopStyleColor();
}

std::string orUnknown(const std::string& text) { return text.empty() ? "unknown" : text; }

}  // namespace

void Panels::drawDevice(const ViewStatus& status) {
  if (!header("Device")) return;
  const HeldDevice& held = *status.held;
  if (held.stage() == HeldDevice::Stage::opening) line(held.name() + " is being opened...");
  if (held.stage() == HeldDevice::Stage::mouse) line("The mouse moves the stylus (hold Space).");
  // A device that gives forces needs no explanation.
  if (const auto now = held.state(); !held.said().empty() && !(now && now->rendersForce)) line(held.said());
  if (const OpenedDevice* const opened = held.opened()) {
    drawDeviceFacts(*opened);
    if (held.stage() == HeldDevice::Stage::held) drawDeviceState(held);
    drawDeviceTest(held);
    if (held.stage() == HeldDevice::Stage::held) drawDeviceSettings(*opened);
  }
  if (held.stage() == HeldDevice::Stage::held || held.stage() == HeldDevice::Stage::mouse) drawDeviceOffers(held);
}

void Panels::drawDeviceFacts(const OpenedDevice& opened) {
  const HapticDeviceFacts& facts = opened.facts;
  const DVec3 size_mm = facts.workspaceMax_mm - facts.workspaceMin_mm;
  line(facts.model);
  faintLine(fmt::format("serial number {}", orUnknown(facts.serial)));
  if (!facts.driver.empty()) faintLine(facts.driver);
  faintLine(fmt::format("workspace {:.0f} x {:.0f} x {:.0f} mm", size_mm.x, size_mm.y, size_mm.z));
  help("right, up, and towards you; the model is placed in its middle");
  faintLine(fmt::format("force at most {:.3g} N, {:.2g} N for long", opened.limits.peakForce_N,
                        opened.limits.continuousForce_N));
  if (!facts.grip.empty())
    faintLine(facts.grip + (facts.battery ? fmt::format(", battery {:.0f} %", 100 * *facts.battery) : ""));
  if (!facts.handedness.empty()) faintLine(fmt::format("set up for the {} hand", facts.handedness));
  help("if this is not your hand, change it in the vendor's software; if directions are wrong, Test offers other axes");
  if (!facts.lights.empty() && noted("lights", ImGui::TreeNode("lights"))) {
    line(facts.lights);
    ImGui::TreePop();
  }
}

void Panels::drawDeviceState(const HeldDevice& held) {
  const std::optional<DeviceState> now = held.state();
  if (now) seenDevice_ = *now;  // else it is just being written
  if (!now && seenDevice_.position == DVec3(0)) return faintLine("open a model to feel it");
  const DVec3& at_mm = seenDevice_.position;
  std::string buttons;
  for (int k = 0; k < held.opened()->limits.buttons; ++k)
    buttons += fmt::format("{}{} {}", k == 0 ? "" : ", ", k + 1, seenDevice_.buttons & (1u << k) ? "pressed" : "up");
  ImGui::Text("stylus at %.0f, %.0f, %.0f mm", at_mm.x, at_mm.y, at_mm.z);
  help("right, up, and towards you");
  if (!buttons.empty()) ImGui::Text("buttons: %s", buttons.c_str());
  help("1 sculpts, 2 is the clutch");
  line(!seenDevice_.ok ? "no pose" : seenDevice_.rendersForce ? "ready to give forces" : "gives no force now");
}

void Panels::drawDeviceTest(const HeldDevice& held) {
  if (const DeviceCheckQuery* const test = held.test()) {
    line(std::string(instructionOf(test->stage())));
    if (test->stage() == DeviceCheckStage::lean || test->stage() == DeviceCheckStage::leanAgain)
      line(fmt::format("wall: {:.2f} N/mm", test->stiffness_N_per_mm()));
    post(button("Stop##test"), DeviceCommand::endTest);
    help("ends the test with what it has found");
    return;
  }
  if (!held.found()) {
    ImGui::BeginDisabled(held.stage() != HeldDevice::Stage::held);
    post(button("Test..."), DeviceCommand::test);
    ImGui::EndDisabled();
    help("tests the device in your hand: free space, directions, and the stiffest wall that does not hum");
    return;
  }
  for (const auto& [name, text] : deviceCheckRows(*held.found())) faintLine(fmt::format("{}: {}", name, text));
  if (held.found()->offeredStiffness_N_per_mm()) {
    post(button("Use this stiffness"), DeviceCommand::useStiffness);
    help("remembers the recommended stiffness for the device; sessions with it are never stiffer");
  }
  if (held.found()->offeredAxes()) {
    post(button("Use these axes"), DeviceCommand::useAxes);
    help("remembers these axes for the device, so that the stylus moves as your hand does");
  }
  post(button("Close##result"), DeviceCommand::closeResult);
}

void Panels::drawDeviceSettings(const OpenedDevice& opened) {
  if (!opened.remembered.isEmpty()) {
    line("remembered: " + opened.remembered.inWords());
    post(button("Forget"), DeviceCommand::forget);
    help("forgets what is remembered for this device");
  }
  if (opened.key.empty()) return;
  ImGui::TextDisabled("axes %s", opened.axes.text().c_str());
  help("axes of the device that point right, up and towards you");
  ImGui::SameLine();
  ImGui::PushItemWidth(em(5));
  const bool entered = field("x,z,-y", axes_);
  ImGui::PopItemWidth();
  help("other axes, which are remembered for this device; Test finds them");
  ImGui::SameLine();
  post((button("Set##axes") || entered) && axes_[0], SetDeviceAxes{axes_.data()});
}

void Panels::drawDeviceOffers(const HeldDevice& held) {
  ImGui::Separator();
  ImGui::BeginDisabled(held.isLooking());
  post(button(held.isLooking() ? "Looking..." : "Look for devices"), DeviceCommand::look);
  ImGui::EndDisabled();
  help("lists the devices that are plugged in");
  if (held.stage() == HeldDevice::Stage::held) {
    ImGui::SameLine();
    post(button("Use the mouse"), ChooseDevice{HeldDevice::kMouse});
  }
  if (!held.offers()) return;
  if (held.offers()->empty())
    line("No device is plugged in, or its driver or service is missing: palpate doctor says more.");
  for (const DeviceOffer& offer : *held.offers()) {
    ImGui::PushID(offer.name.c_str());
    const bool isHeld = held.stage() == HeldDevice::Stage::held && held.name() == offer.device;
    post(noted(offer.device, ImGui::Button(offer.name.c_str())) && !isHeld, ChooseDevice{offer.device});
    help("--device " + offer.device);
    faintLine(offer.state);
    if (!offer.mend.empty()) {
      line(offer.mend);
      post(button("Copy command"), CopyText{offer.mend});
      help("run it in a terminal, then look again");
    }
    ImGui::PopID();
  }
}

}  // namespace palpate
