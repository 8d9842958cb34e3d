#include "apps/cli/hand_options.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "apps/cli/setting_options.hpp"
#include "engine/core/contact_query.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/hand_source.hpp"

namespace palpate {

HandConfig HandChoices::config(const std::string& path, double penetration_mm) const {
  HandConfig config = hand;
  config.device = device;
  config.path = path;
  config.penetration_mm = penetration_mm;
  config.ownScheduler = scheduler == "own";
  return config;
}

Check deviceValidator() { return {deviceComplaint, "DEVICE"}; }

void addHandOptions(Options& sub, HandChoices& options) {
  addSettingFor<HandConfig>(sub, options.device, "device")
      .describe(fmt::format("{}: {}. Button 1 of a stylus sculpts, button 2 is a clutch",
                            settingNamed<HandConfig>("device").help, heldDevicesHelp()))
      .check(deviceValidator())
      .offers(heldDeviceNames({"path", "sim", "replay:"}))
      .showDefault();
  addSettingFor<HandConfig>(sub, options.scheduler, "own_scheduler").check(oneOf({"device", "own"})).showDefault();
  addSetting(sub, options.hand, "fit").showDefault();
  addSetting(sub, options.hand, "stiffness_N_per_mm");
  addSetting(sub, options.hand, "damping_N_s_per_mm");
  addSetting(sub, options.hand, "passivity");
  addSetting(sub, options.hand, "rumbles");
  addSetting(sub, options.hand, "axes").typeName("RIGHT,UP,TOWARDS");
}

void checkHandOptions(const HandChoices& options, bool realtime) {
  const bool held = isHeldDevice(options.device);
  if (options.hand.rumbles && !realtime) throw UsageError("--rumble requires --realtime");
  if (options.device != "sim" && (options.hand.stiffness_N_per_mm > 0 || options.hand.damping_N_s_per_mm > 0))
    throw UsageError("--hand-stiffness and --hand-damping require --device sim");
  if (options.hand.fit != WorkspaceFit::fit && options.device != "sim" && !held)
    throw UsageError("--map requires a device or sim: a path is in model units, and a recording has its own map");
  if (!options.hand.axes.empty() && !held) throw UsageError("--axes requires a device in a hand");
  if (!held) return;
  if (!realtime) throw UsageError("{}{} requires --realtime", options.option, options.device);
  if (!(options.duration_s > 0)) throw UsageError("{}{} requires --duration", options.option, options.device);
}

namespace {

constexpr std::array<std::string_view, 3> kHandKeys{"device", "path", "trace"};

/// The parts of "device=sim,path=a.csv,trace=b.csv" by key. A comma ends a value only if a key follows it, so that
/// files may have commas in their names.
std::vector<std::pair<std::string_view, std::string>> partsOf(std::string_view text) {
  const auto keyAt = [&](std::size_t at) {
    const auto found = std::ranges::find_if(kHandKeys, [&](std::string_view key) {
      return text.substr(at).starts_with(key) && text.substr(at + key.size()).starts_with('=');
    });
    return found == kHandKeys.end() ? std::string_view() : *found;
  };
  std::vector<std::pair<std::string_view, std::string>> parts;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view key = keyAt(at);
    if (key.empty())
      throw UsageError("--hand {}: '{}' is not device=..., path=... or trace=...", text, text.substr(at));
    const std::size_t begin = at + key.size() + 1;
    std::size_t end = begin;
    while (end < text.size() && !(text[end] == ',' && !keyAt(end + 1).empty())) ++end;
    parts.emplace_back(key, text.substr(begin, end - begin));
    at = end + 1;
  }
  return parts;
}

FurtherHand furtherHand(const std::string& text) {
  FurtherHand hand;
  std::string* const values[]{&hand.device, &hand.path, &hand.traceFile};
  std::array<bool, kHandKeys.size()> given{};
  for (const auto& [key, value] : partsOf(text)) {
    const auto index = static_cast<std::size_t>(std::ranges::find(kHandKeys, key) - kHandKeys.begin());
    if (std::exchange(given[index], true)) throw UsageError("--hand {}: {} is given twice", text, key);
    if (value.empty()) throw UsageError("--hand {}: {} has no value", text, key);
    *values[index] = value;
  }
  if (const std::string complaint = deviceComplaint(hand.device); !complaint.empty())
    throw UsageError("--hand {}: {}", text, complaint);
  const bool followsPath = hand.device == "path" || hand.device == "sim";
  if (followsPath && hand.path.empty())
    throw UsageError("--hand {}: device={} requires path=FILE.csv or path=builtin:NAME", text, hand.device);
  if (!followsPath && !hand.path.empty())
    throw UsageError("--hand {}: device={} does not follow a path; path= is for path and sim", text, hand.device);
  return hand;
}

}  // namespace

void addFurtherHandOption(Options& command, std::vector<std::string>& hands) {
  command
      .add("--hand", hands,
           fmt::format("a further hand, as in \"device=sim,path=builtin:slide,trace=b.csv\": its device (values as for "
                       "--device; default path), its path (of path and sim; values as for --path) and the file of its "
                       "trace. It feels the same model and does not sculpt (vulkan with the method fused, or cpu). May "
                       "be repeated: a session has up to {} hands",
                       kMaxHands))
      .typeName("HAND")
      .repeatable()
      .offers({"device=", "path=", "trace="})
      .writes(Writes::replacing, "trace=");
}

std::vector<FurtherHand> furtherHands(const std::vector<std::string>& hands, const HandChoices& first, bool realtime) {
  if (hands.size() >= kMaxHands)
    throw UsageError("--hand: {} hands after the first are given; a session has {} hands at most", hands.size(),
                     kMaxHands);
  std::vector<FurtherHand> all;
  std::vector<std::string> devices{first.device};
  for (const std::string& text : hands) {
    const FurtherHand hand = furtherHand(text);
    checkHandOptions(choicesFor(first, hand), realtime);
    if (isHeldDevice(hand.device) && std::ranges::find(devices, hand.device) != devices.end())
      throw UsageError("--hand {}: {} is already used by another hand; name another device, as in openhaptics:NAME",
                       text, hand.device);
    devices.push_back(hand.device);
    all.push_back(hand);
  }
  return all;
}

HandChoices choicesFor(HandChoices first, const FurtherHand& hand) {
  first.option = "--hand device=";
  first.device = hand.device;
  first.hand.rumbles = false;
  first.hand.axes.clear();  // of that device
  first.scheduler = "own";  // only the first hand's device may run the ticks
  if (hand.device == "sim") return first;
  first.hand.stiffness_N_per_mm = first.hand.damping_N_s_per_mm = 0;
  if (isHeldDevice(hand.device)) return first;
  first.hand.fit = WorkspaceFit::fit;
  if (first.hand.passivity == PassivityMode::on) first.hand.passivity.reset();  // a script cannot be braked
  return first;
}

}  // namespace palpate
