#include "haptics/devices/openhaptics_device.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <glm/gtc/quaternion.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {
namespace {

using namespace hdapi;
using namespace std::chrono_literals;

/// Per model: what it bears and still renders stably, whatever its driver reports; a name precedes those it contains.
struct HdModel {
  std::string_view name;
  double peak_N, stiffness_N_per_mm, damping_N_s_per_mm;
};
constexpr HdModel kHdModels[]{
    {"Touch X", 7.9, 1.0, 0.005}, {"Desktop", 7.9, 1.0, 0.005}, {"Premium", 8.5, 0.8, 0.005},
    {"Omni", 3.3, 0.7, 0.005},    {"", 3.3, 0.4, 0.005},
};

constexpr std::array<double, 3> kFrozen_mm{0, -110, -35};  // reported permanently by a driver without joint data
constexpr std::uint32_t kFrozenTicks = 100;
constexpr double kHot = 0.95, kCooled = 0.85;
constexpr std::uint32_t kTicksBetweenChecks = 100;
constexpr std::uint32_t kPausedTicks = 1000;  // after each error, if the driver does not report the temperature
constexpr std::uint32_t kUncalibratedTicks = 200;
constexpr int kMaxComplaints = 32;       // errors read at a time: the stack must not delay a tick
constexpr double kStall_s = 1;           // without a call; then the driver's scheduler is considered dead
constexpr double kZeroWait_us = 50'000;  // for a scheduler that a loaded system holds up; else one tick of it
constexpr std::size_t kMaxMotors = 8;
constexpr double kDriverRate_Hz = 1000;

VendorLibrary loadedHd() {
  VendorLibrary library(librarySearch());
  if (!library.isLoaded()) throw Error("openhaptics: {}", library.whyNot());
  return library;
}

/// The driver has one scheduler for all devices; they are opened and closed while it is stopped. `change` does that and
/// returns the change in the number of devices.
template <typename Change>
void whileSchedulerStands(const Api& hd, Change&& change) {
  static std::mutex guard;
  static int open = 0;
  const std::scoped_lock lock(guard);
  if (open > 0) hd.stopScheduler();
  try {
    open += change();
  } catch (...) {
    if (open > 0) hd.startScheduler();
    throw;
  }
  if (open > 0) hd.startScheduler();
}

std::string textOf(const char* text) { return text ? text : ""; }

std::uint32_t newestError(const Api& hd) {
  std::uint32_t newest = 0;
  for (int i = 0; i < kMaxComplaints; ++i) {
    const std::uint32_t code = hd.getError().code;
    if (code == 0) break;
    if (newest == 0) newest = code;
  }
  return newest;
}

/// The driver's value if it is valid, at most `most`.
double upTo(double most, double told) { return std::isfinite(told) && told > 0 ? std::min(told, most) : most; }

}  // namespace

OpenHapticsDevice::OpenHapticsDevice(const OpenHapticsOptions& options)
    : options_(options), library_(loadedHd()), hd_(library_), calls_(std::make_shared<Calls>()) {
  whileSchedulerStands(hd_, [this] {
    open();
    return 1;
  });
  try {
    demandSuccess("starting the driver's servo loop");
    learnFacts();
    learnLimits();
    calibrate();
    testPosition();
  } catch (...) {
    close();
    throw;
  }
}

OpenHapticsDevice::~OpenHapticsDevice() { close(); }

void OpenHapticsDevice::close() noexcept {
  hd_.makeCurrentDevice(device_);
  sendInFrame(DVec3(0));
  hd_.disable(kForceOutput);
  whileSchedulerStands(hd_, [this] {
    hd_.disableDevice(device_);
    return -1;
  });
  newestError(hd_);
}

void OpenHapticsDevice::open() {
  std::vector<const char*> names{nullptr, "Default Device", "Default PHANToM"};
  if (!options_.deviceName.empty()) names = {options_.deviceName.c_str()};
  newestError(hd_);
  std::uint32_t code = 0;
  for (const char* name : names) {
    device_ = hd_.initDevice(name);
    const std::uint32_t error = newestError(hd_);
    if (device_ != kNoDevice && meaningOf(error).severity != Severity::end) break;
    if (device_ != kNoDevice) hd_.disableDevice(device_);
    device_ = kNoDevice;
    // The error of the first name counts, since that name should have worked, unless it is merely unknown.
    if (code == 0) code = error;
  }
  if (device_ == kNoDevice) {
    const std::string which =
        options_.deviceName.empty() ? "the default device" : fmt::format("the device '{}'", options_.deviceName);
    const ErrorMeaning& meaning = meaningOf(code);
    throw Error("openhaptics: {} cannot be opened: {} (the driver says: {}, 0x{:04x}); {}", which,
                code == 0 ? "the driver does not say why" : meaning.words, textOf(hd_.getErrorString(code)), code,
                code == 0 ? "run the vendor's setup program (Touch_Setup), and palpate doctor" : meaning.advice);
  }
  hd_.makeCurrentDevice(device_);
  hd_.enable(kForceOutput);
  hd_.enable(kMaxForceClamping);
  if (hd_.setSchedulerRate && options_.rate_Hz != kDriverRate_Hz && options_.scheduler == Scheduler::device) {
    hd_.setSchedulerRate(static_cast<unsigned long>(std::lround(options_.rate_Hz)));
    if (newestError(hd_) != 0) {
      hd_.disableDevice(device_);
      throw Error(
          "openhaptics: the driver's servo loop does not run at {} Hz; use a rate of 1000 Hz, or palpate's own "
          "scheduler",
          options_.rate_Hz);
    }
  }
}

void OpenHapticsDevice::keepForDriver(std::shared_ptr<Calls> calls) {
  static std::mutex guard;
  static auto& kept = *new std::vector<std::shared_ptr<Calls>>;  // never destroyed
  const std::scoped_lock hold(guard);
  kept.push_back(std::move(calls));
}

void OpenHapticsDevice::demandSuccess(const std::string& doing) {
  const std::uint32_t code = newestError(hd_);
  const ErrorMeaning& meaning = meaningOf(code);
  if (meaning.severity != Severity::end) return;
  throw Error("openhaptics: {} failed: {} (the driver says: {}, 0x{:04x}); {}", doing, meaning.words,
              textOf(hd_.getErrorString(code)), code, meaning.advice);
}

void OpenHapticsDevice::learnFacts() {
  facts_ = {.model = textOf(hd_.getString(kModelType)),
            .serial = textOf(hd_.getString(kSerialNumber)),
            .driver = textOf(hd_.getString(kDriverVersion))};
  if (facts_.model.empty()) facts_.model = "OpenHaptics device";
  double sides[6]{};
  hd_.getDoublev(kUsableWorkspace, sides);
  facts_.workspaceMin_mm = {sides[0], sides[1], sides[2]};
  facts_.workspaceMax_mm = {sides[3], sides[4], sides[5]};
  newestError(hd_);  // clears errors: an old driver does not know all values
  const DVec3 size_mm = facts_.workspaceMax_mm - facts_.workspaceMin_mm;
  if (isFinite(size_mm) && size_mm.x > 0 && size_mm.y > 0 && size_mm.z > 0) return;
  facts_.workspaceMin_mm = -0.5 * kTouchWorkspace_mm;
  facts_.workspaceMax_mm = 0.5 * kTouchWorkspace_mm;
}

void OpenHapticsDevice::learnLimits() {
  const auto model = std::ranges::find_if(
      kHdModels, [&](const HdModel& limits) { return facts_.model.find(limits.name) != std::string::npos; });
  double peak_N = 0, continuous_N = 0, heat[kMaxMotors]{};
  hd_.getDoublev(kMaxForce, &peak_N);
  hd_.getDoublev(kMaxContinuousForce, &continuous_N);
  newestError(hd_);
  hd_.getDoublev(kMotorTemperature, heat);
  tellsHeat_ = newestError(hd_) == 0;
  limits_ = {.peakForce_N = upTo(model->peak_N, peak_N), .forceDelay_ticks = 1, .buttons = 2};
  limits_.continuousForce_N = upTo(std::min(limits_.continuousForce_N, limits_.peakForce_N), continuous_N);
  limits_.mostStiffness_N_per_mm = model->stiffness_N_per_mm;
  limits_.mostDamping_N_s_per_mm = model->damping_N_s_per_mm;
}

void OpenHapticsDevice::calibrate() {
  const Stopwatch watch;
  bool told = false;
  const Enum style = hd_.checkCalibrationStyle ? hd_.checkCalibrationStyle() : kByInkwell;
  newestError(hd_);
  while (true) {
    const Enum state = hd_.checkCalibration();
    demandSuccess("calibrating");
    if (state == kCalibrated) break;
    if (state == kNeedsUpdate) {
      hd_.updateCalibration(style);
      demandSuccess("calibrating");
    }
    const bool byHand = state == kNeedsManualInput;
    const char* what =
        style & kByInkwell ? "put the stylus into the inkwell" : "move the stylus through its whole range";
    if (byHand && !told && options_.say) options_.say(fmt::format("{}: to calibrate, {}", calledName(), what));
    told = told || byHand;
    if (options_.stop && options_.stop->load(std::memory_order_relaxed))
      throw Error("openhaptics: interrupted while {} was waiting to be calibrated", facts_.model);
    if (watch.elapsed_s() > options_.calibrationPatience_s)
      throw Error("openhaptics: {} was not calibrated within {} s; {}, and start again", facts_.model,
                  options_.calibrationPatience_s, what);
    std::this_thread::sleep_for(20ms);
  }
  if (told && options_.say) options_.say(fmt::format("{}: calibrated", calledName()));
}

void OpenHapticsDevice::tendCalibration() {
  const Enum state = calibration_.load(std::memory_order_relaxed);
  if (state == kNeedsUpdate) {
    hd_.makeCurrentDevice(device_);
    hd_.updateCalibration(hd_.checkCalibrationStyle ? hd_.checkCalibrationStyle() : kByInkwell);
  }
  const bool isLost = state != kCalibrated;
  if (std::exchange(tellsLost_, isLost) == isLost || !options_.say) return;
  options_.say(isLost ? fmt::format("{}: the calibration is lost, so the pose is wrong and there is no force; put the "
                                    "stylus into the inkwell",
                                    calledName())
                      : fmt::format("{}: calibrated; the force returns in free space", calledName()));
}

void OpenHapticsDevice::testPosition() {
  // One of the driver's ticks with another position is enough; a stylus at rest is not frozen.
  for (std::uint32_t i = 0; i < kFrozenTicks; ++i) {
    std::array<double, 3> position_mm{};
    hd_.beginFrame(device_);
    hd_.getDoublev(kCurrentPosition, position_mm.data());
    demandSuccess("reading the position");
    turn();
    tellsTurn_ = newestError(hd_) == 0;
    hd_.endFrame(device_);
    demandSuccess("reading the position");
    if (!isFrozen(position_mm)) return;
    std::this_thread::sleep_for(1ms);
  }
  throw Error(
      "openhaptics: the driver always reports the position (0, -110, -35) mm: it has no joint data of {}; run the "
      "vendor's setup program (Touch_Setup), and note that LC_NUMERIC must have a decimal point",
      facts_.model);
}

DQuat OpenHapticsDevice::turn() noexcept {
  std::array<double, 16> m{};
  hd_.getDoublev(kCurrentTransform, m.data());
  const DQuat turn = glm::quat_cast(glm::dmat3(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]));
  const double size = glm::dot(turn, turn);
  return std::isfinite(size) && size > 0.5 ? turn / std::sqrt(size) : DQuat(1, 0, 0, 0);
}

bool OpenHapticsDevice::isFrozen(const std::array<double, 3>& position_mm) noexcept {
  return position_mm == kFrozen_mm;
}

bool OpenHapticsDevice::pace(double /*rate_Hz*/, const std::function<bool()>& tick) {
  calls_ = std::make_shared<Calls>();
  calls_->tick = &tick;
  const Callback call = [](void* data) -> std::uint32_t {
    Calls& calls = *static_cast<Calls*>(data);
    calls.busy.store(true);
    calls.beats.fetch_add(1, std::memory_order_relaxed);
    const bool goesOn = !calls.abandoned.load() && (*calls.tick)();
    if (!goesOn) calls.ended.store(true);
    calls.busy.store(false);
    return goesOn ? kCallbackContinue : kCallbackDone;
  };
  newestError(hd_);
  const SchedulerHandle handle = hd_.scheduleAsynchronous(call, calls_.get(), kDefaultPriority);
  if (const std::uint32_t code = newestError(hd_); meaningOf(code).severity == Severity::end) {
    fail(meaningOf(code).words, meaningOf(code).advice, code);
    return false;
  }
  std::uint64_t beats = 0;
  Stopwatch since;
  while (!calls_->ended.load()) {
    std::this_thread::sleep_for(2ms);
    tendCalibration();
    if (std::exchange(beats, calls_->beats.load(std::memory_order_relaxed)) != beats || calls_->busy.load())
      since = Stopwatch();
    if (since.elapsed_s() < kStall_s) continue;
    calls_->abandoned.store(true);
    keepForDriver(calls_);
    while (calls_->busy.load()) std::this_thread::sleep_for(1ms);
    hd_.unschedule(handle);
    fail("the driver's servo loop has stopped calling", "check cable and power of the device, and start again");
    return false;
  }
  hd_.waitForCompletion(handle, kWaitCompletion);
  hd_.makeCurrentDevice(device_);  // for the thread that continues
  return true;
}

DeviceState OpenHapticsDevice::read(double /*time_s*/) noexcept {
  if (failed_.load()) return {};
  servoThread_.store(std::this_thread::get_id(), std::memory_order_relaxed);
  hd_.makeCurrentDevice(device_);
  hd_.beginFrame(device_);
  inFrame_ = true;
  std::array<double, 3> position_mm{};
  std::int32_t buttons = 0;
  hd_.getDoublev(kCurrentPosition, position_mm.data());
  hd_.getIntegerv(kCurrentButtons, &buttons);
  const DQuat held = tellsTurn_ ? turn() : DQuat(1, 0, 0, 0);
  watchMotors();
  const Enum calibration = hd_.checkCalibration();
  calibration_.store(calibration, std::memory_order_relaxed);
  const Severity worst = std::max(complaints(), std::exchange(pending_, Severity::none));
  frozenTicks_ = isFrozen(position_mm) ? frozenTicks_ + 1 : 0;
  if (frozenTicks_ >= kFrozenTicks)
    fail("the position is frozen at (0, -110, -35) mm: the driver has lost the joint data",
         "run the vendor's setup program (Touch_Setup)");
  if (!isFinite(DVec3(position_mm[0], position_mm[1], position_mm[2])))
    fail("the driver reports a position that is not a number", "calibrate the device with the vendor's setup program");
  if (failed_.load()) {
    sendInFrame(DVec3(0));
    return {};
  }
  if (calibration != kCalibrated) {
    // The gate waits for free space after that long, since the pose jumps when it is calibrated.
    uncalibratedTicks_ = kUncalibratedTicks;
  } else if (uncalibratedTicks_ > 0) {
    --uncalibratedTicks_;
  }
  if (worst == Severity::pause) pausedTicks_ = kPausedTicks;
  if (pausedTicks_ > 0) --pausedTicks_;
  const bool renders =
      worst == Severity::none && !hot_ && pausedTicks_ == 0 && frozenTicks_ == 0 && uncalibratedTicks_ == 0;
  return {.position = {position_mm[0], position_mm[1], position_mm[2]},
          .turn = held,
          .buttons = static_cast<std::uint32_t>(buttons),
          .rendersForce = renders,
          .ok = true};
}

bool OpenHapticsDevice::write(const DVec3& force_N) noexcept {
  const bool sane = isFinite(force_N);
  const double size_N = sane ? glm::length(force_N) : 0;
  const bool stopped = stopped_.load(), failed = failed_.load();
  hd_.makeCurrentDevice(device_);
  sendInFrame(!sane || stopped || failed     ? DVec3(0)
              : size_N > limits_.peakForce_N ? force_N * (limits_.peakForce_N / size_N)
                                             : force_N);
  if (stopped) zeroSent_.store(true);
  if (failed) return false;
  pending_ = complaints();
  return sane && pending_ != Severity::end;
}

void OpenHapticsDevice::sendInFrame(const DVec3& force_N) noexcept {
  if (!inFrame_) hd_.beginFrame(device_);
  const double force[3]{force_N.x, force_N.y, force_N.z};
  hd_.setDoublev(kCurrentForce, force);
  hd_.endFrame(device_);
  inFrame_ = false;
}

Severity OpenHapticsDevice::complaints() noexcept {
  Severity worst = Severity::none;
  for (int i = 0; i < kMaxComplaints; ++i) {
    const std::uint32_t code = hd_.getError().code;
    if (code == 0) break;
    const ErrorMeaning& meaning = meaningOf(code);
    worst = std::max(worst, meaning.severity);
    if (meaning.severity == Severity::end) fail(meaning.words, meaning.advice, code);
  }
  return worst;
}

void OpenHapticsDevice::watchMotors() noexcept {
  if (!tellsHeat_ || ticksToCheck_-- > 0) return;
  ticksToCheck_ = kTicksBetweenChecks;
  double heat[kMaxMotors]{};
  hd_.getDoublev(kMotorTemperature, heat);
  const double warmest = *std::ranges::max_element(heat);
  temperature_.store(warmest, std::memory_order_relaxed);
  hot_ = warmest >= (hot_ ? kCooled : kHot);
  if (warmest < kCooled) pausedTicks_ = 0;
}

void OpenHapticsDevice::fail(const char* what, const char* advice, std::uint32_t code) noexcept {
  if (failed_.load()) return;
  first_ = {what, advice, code};
  failed_.store(true);
}

void OpenHapticsDevice::resume() noexcept {
  stopped_.store(false);
  zeroSent_.store(false);
}

void OpenHapticsDevice::emergencyStop() noexcept {
  stopped_.store(true);
  const std::thread::id servo = servoThread_.load(std::memory_order_relaxed);
  if (servo == std::thread::id() || servo == std::this_thread::get_id()) return;
  // Measured by the clock: a system without such short sleeps does not sleep at all.
  const Stopwatch since;
  while (since.elapsed_us() < kZeroWait_us && !zeroSent_.load()) {
    const timespec nap{.tv_sec = 0, .tv_nsec = 100'000};
    ::nanosleep(&nap, nullptr);
  }
}

const std::string& OpenHapticsDevice::calledName() const {
  return options_.deviceName.empty() ? facts_.model : options_.deviceName;
}

std::string OpenHapticsDevice::faultText() const {
  if (!failed_.load()) return {};
  if (first_.code == 0) return fmt::format("{}: {}; {}", calledName(), first_.what, first_.advice);
  return fmt::format("{}: {} (0x{:04x}); {}", calledName(), first_.what, first_.code, first_.advice);
}

}  // namespace palpate
