#include "apps/view/held_device.hpp"

#include <utility>

#include "apps/view/messages.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

template <class Result>
bool isReady(const std::future<Result>& result) {
  return result.valid() && result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

DVec3 middleOf(const HapticDeviceFacts& facts) { return 0.5 * (facts.workspaceMin_mm + facts.workspaceMax_mm); }

}  // namespace

HeldDevice::HeldDevice(const HeldDeviceOptions& options) : options_(options), log_(options.quiet) { log_.listen(this); }

// The futures wait for their threads.
HeldDevice::~HeldDevice() { stopOpening_ = stopTest_ = true; }

void HeldDevice::said(std::string_view line) {
  const std::scoped_lock lock(guard_);
  heard_.emplace_back(line);
}

OpenedDevice HeldDevice::opening(const std::string& device) {
  OpenedDevice opened = openDevice(device, {.log = log_,
                                            .rate_Hz = options_.rate_Hz,
                                            .ownScheduler = options_.ownScheduler,
                                            .stop = &stopOpening_,
                                            .axes = options_.axes,
                                            .memory = memory_});
  if (options_.rumbles) opened.device = withRumble(std::move(opened.device), log_);
  return opened;
}

// The device's axes are rotated about the middle of its workspace, which becomes the origin.
void HeldDevice::hold(OpenedDevice opened) {
  device_ = std::make_shared<TurnedDevice>(std::move(opened.device), middleOf(opened.facts));
  opened_ = std::move(opened);
  stage_ = Stage::held;
  hasChanged_ = true;
}

void HeldDevice::letGo() {
  hasChanged_ = hasChanged_ || stage_ == Stage::held;
  stage_ = Stage::mouse;
  name_ = kMouse;
  found_.reset();
}

void HeldDevice::open(const std::string& device) {
  hold(opening(device));
  name_ = device;
  rememberChoice();
}

void HeldDevice::choose(const std::string& device) {
  if (stage_ == Stage::opening || stage_ == Stage::tested)
    throw Error("{}: the device is being {}; wait for it", name_, stage_ == Stage::opening ? "opened" : "tested");
  if (!options_.realtime && device != kMouse)
    throw UsageError("{}: a device requires the machine's clock; play the script with --realtime", device);
  letGo();
  said_.clear();
  isRemembered_ = false;
  if (device == kMouse) return rememberChoice();
  name_ = device;
  stage_ = Stage::opening;
}

// A choice that cannot be kept holds for this window.
void HeldDevice::rememberChoice() {
  try {
    memory_.choose(name_);
  } catch (const Error& error) {
    log_.warn("{}", error.what());
  }
}

void HeldDevice::chooseLast() {
  try {
    const std::string last = memory_.chosen();
    if (last.empty() || last == kMouse) return;
    choose(last);
    isRemembered_ = true;
  } catch (const Error& error) {
    log_.warn("{}", error.what());
  }
}

void HeldDevice::lose() {
  letGo();
  said_.clear();
}

void HeldDevice::lookAround() {
  if (looking_.valid()) return;
  looking_ = std::async(std::launch::async, [held = device_ ? name_ : std::string()] { return surveyDevices(held); });
}

void HeldDevice::beginTest() {
  if (stage_ != Stage::held) throw Error("hold a device first: choose it under Device");
  if (!opened_.limits.handHeld || isSteering(name_))
    throw Error("{} steers a simulated hand; the test requires a device with force feedback", name_);
  stopTest_ = false;
  found_.reset();
  query_ = std::make_unique<DeviceCheckQuery>(DeviceCheckOptions{.rate_Hz = options_.rate_Hz, .stop = &stopTest_},
                                              opened_.limits);
  stage_ = Stage::tested;
  hasChanged_ = true;
}

void HeldDevice::remember(const RememberedDevice& wanted) {
  memory_.remember(opened_.key, wanted);
  again();
}

// Opens the device again, with what is remembered for it now.
void HeldDevice::again() {
  const std::string device = name_;
  auto found = std::exchange(found_, {});
  options_.axes.clear();
  choose(device);
  isRemembered_ = true;
  found_ = std::move(found);
}

void HeldDevice::useStiffness() {
  if (!found_ || !found_->offeredStiffness_N_per_mm()) return;
  RememberedDevice wanted = opened_.remembered;
  wanted.model = opened_.facts.model;
  wanted.stiffness_N_per_mm = found_->offeredStiffness_N_per_mm();
  remember(wanted);
  found_->stableStiffness_N_per_mm.reset();  // no longer offered
}

void HeldDevice::useAxes() {
  if (!found_ || !found_->offeredAxes()) return;
  setAxes(found_->offeredAxes()->after(opened_.axes).text());
  found_->axes = DeviceAxes().numbers();
}

void HeldDevice::setAxes(const std::string& axes) {
  const auto wanted = DeviceAxes::named(axes);
  if (!wanted) throw UsageError("axes: {}", axesComplaint(axes.empty() ? "nothing" : axes));
  RememberedDevice device = opened_.remembered;
  device.model = opened_.facts.model;
  device.axes = wanted->isUnchanged() ? std::string() : wanted->text();
  remember(device);
}

void HeldDevice::forget() {
  memory_.forget(opened_.key);
  again();
}

HapticDeviceFacts HeldDevice::centredFacts() const {
  HapticDeviceFacts facts = opened_.facts;
  facts.workspaceMin_mm -= middleOf(opened_.facts);
  facts.workspaceMax_mm -= middleOf(opened_.facts);
  return facts;
}

void HeldDevice::takeOpened(Messages& messages) {
  if (!opens_.valid()) {  // the device before is closed first: it may be the same one
    device_.reset();
    stopOpening_ = false;
    opens_ = std::async(std::launch::async, [this, device = name_] { return opening(device); });
  }
  if (!isReady(opens_)) return;
  try {
    hold(opens_.get());
    if (!isRemembered_) rememberChoice();
  } catch (const Error& error) {
    if (isRemembered_)
      messages.say(fmt::format("{}, used last, cannot be used; the mouse moves the stylus: {}", name_, error.what()));
    else
      messages.sayError(error.what());
    letGo();
  }
}

void HeldDevice::takeTested(Messages& messages) {
  if (!tests_.valid()) {
    device_->setAxes(glm::dmat3(1));
    tests_ = std::async(std::launch::async, [this] { return checkDevice(*device_, *query_); });
  }
  if (!isReady(tests_)) return;
  stage_ = Stage::held;
  hasChanged_ = true;
  try {
    found_ = tests_.get();
    if (found_->fault.empty()) return;
    messages.sayError(found_->fault);
  } catch (const Error& error) {
    messages.sayError(error.what());
  }
  lose();
}

bool HeldDevice::follow(Messages& messages, bool mayChange) {
  std::vector<std::string> heard;
  {
    const std::scoped_lock lock(guard_);
    heard.swap(heard_);
  }
  if (!heard.empty()) messages.add(said_ = heard.back());  // the panel shows what was said before
  if (isReady(looking_)) around_ = looking_.get();
  if (stage_ == Stage::opening && !hasChanged_) takeOpened(messages);
  if (stage_ == Stage::tested && !hasChanged_) takeTested(messages);
  if (stage_ == Stage::mouse && !hasChanged_) device_.reset();
  return mayChange && std::exchange(hasChanged_, false);
}

}  // namespace palpate
