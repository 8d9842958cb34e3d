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

// What a person needs now comes first: an instruction, a question, or the state. A small window shows no more.
void Panels::drawDevice(const ViewStatus& status) {
  if (!header("Device")) return;
  const HeldDevice& held = *status.held;
  const bool isHeld = held.stage() == HeldDevice::Stage::held;
  if (held.stage() == HeldDevice::Stage::opening) line(held.name() + " is being opened...");
  if (held.stage() == HeldDevice::Stage::mouse) line("The mouse moves the stylus (hold Space).");
  const OpenedDevice* const opened = held.opened();
  if (!opened && !held.said().empty()) line(held.said());
  if (opened) {
    line(opened->facts.model);
    if (held.test()) drawDeviceTest(*held.test());
    if (held.found()) drawDeviceFindings(*held.found(), *opened);
    if (isHeld) drawDeviceState(held);
  }
  if (isHeld || held.stage() == HeldDevice::Stage::mouse) drawDeviceOffers(held);
  if (!opened) return;
  ImGui::Separator();
  // Below the buttons, which stay where they are. A device that gives forces needs no explanation.
  if (const auto now = held.state(); !held.said().empty() && !(now && now->rendersForce)) line(held.said());
  drawDeviceFacts(*opened);
  if (isHeld) drawDeviceSettings(*opened);
}

void Panels::drawDeviceFacts(const OpenedDevice& opened) {
  const HapticDeviceFacts& facts = opened.facts;
  const DVec3 size_mm = facts.workspaceMax_mm - facts.workspaceMin_mm;
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
  line(!seenDevice_.ok ? "no pose" : seenDevice_.rendersForce ? "ready to give forces" : "gives no force now");
  const DVec3& at_mm = seenDevice_.position;
  std::string buttons;
  for (int k = 0; k < held.opened()->limits.buttons; ++k)
    buttons += fmt::format("{}{} {}", k == 0 ? "" : ", ", k + 1, seenDevice_.buttons & (1u << k) ? "pressed" : "up");
  ImGui::Text("stylus at %.0f, %.0f, %.0f mm", at_mm.x, at_mm.y, at_mm.z);
  help("right, up, and towards you");
  if (!buttons.empty()) ImGui::Text("buttons: %s", buttons.c_str());
  help("1 sculpts, 2 is the clutch");
}

void Panels::drawDeviceTest(const DeviceCheckQuery& test) {
  post(letterButton("Stop##test", 'S'), DeviceCommand::endTest);
  help("ends the test with what it has found");
  line(std::string(instructionOf(test.stage())));
  if (test.stage() == DeviceCheckStage::lean || test.stage() == DeviceCheckStage::leanAgain)
    line(fmt::format("wall: {:.2f} N/mm", test.stiffness_N_per_mm()));
}

void Panels::drawDeviceFindings(const DeviceCheckResult& found, const OpenedDevice& opened) {
  const auto stiffness = found.offeredStiffness_N_per_mm();
  const auto axes = found.offeredAxes();
  if ((stiffness || axes) && opened.key.empty()) {
    line("The device reports no serial number, so nothing can be remembered for it.");
  } else {
    if (stiffness) {
      line(fmt::format("Never stiffer than {:.2f} N/mm with this device from now on?", *stiffness));
      post(letterButton("Use this stiffness", 's'), DeviceCommand::useStiffness);
      help("remembers it for the device");
    }
    if (axes) {
      line(fmt::format("Axes {} with this device from now on?", axes->after(opened.axes).text()));
      post(letterButton("Use these axes", 'a'), DeviceCommand::useAxes);
      help("remembers them for the device, so that the stylus moves as your hand does");
    }
  }
  post(letterButton("Close##result", 'o'), DeviceCommand::closeResult);
  help("leaves what is remembered as it is");
  ImGui::SameLine();
  if (noted("result", ImGui::TreeNode("result"))) {
    for (const auto& [name, text] : deviceCheckRows(found)) faintLine(fmt::format("{}: {}", name, text));
    ImGui::TreePop();
  }
  ImGui::Separator();
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
  ImGui::SetNextItemWidth(roomBeside("Set##axes"));
  const bool entered = field("x,z,-y", axes_);
  help("other axes, which are remembered for this device; Test finds them");
  ImGui::SameLine();
  post((button("Set##axes") || entered) && axes_[0], SetDeviceAxes{axes_.data()});
}

void Panels::drawDeviceOffers(const HeldDevice& held) {
  if (held.stage() == HeldDevice::Stage::held) {
    post(button("Test..."), DeviceCommand::test);
    help("tests the device in your hand: free space, directions, and the stiffest wall that does not hum");
    ImGui::SameLine();
    post(button("Use the mouse"), ChooseDevice{HeldDevice::kMouse});
  }
  ImGui::BeginDisabled(held.isLooking());
  post(button(held.isLooking() ? "Looking..." : "Look for devices"), DeviceCommand::look);
  ImGui::EndDisabled();
  help("lists the devices that are plugged in");
  if (!held.around()) return;
  std::vector<DeviceOffer> offers;
  std::vector<std::string> missing;
  for (const DeviceSurvey& kind : *held.around()) {
    offers.insert(offers.end(), kind.offers.begin(), kind.offers.end());
    if (!kind.missing.empty()) missing.push_back(kind.missing);
  }
  for (const DeviceOffer& offer : offers) {
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
  const bool isAnswer = offers.empty();
  if (isAnswer) line("No device was found.");
  if (missing.empty() || (!isAnswer && !noted("not found", ImGui::TreeNode("not found")))) return;
  for (const std::string& reason : missing) faintLine(reason);
  if (!isAnswer) ImGui::TreePop();
}

}  // namespace palpate
