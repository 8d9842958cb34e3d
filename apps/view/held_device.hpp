// The device that a person holds before the window: chosen, opened, tested and remembered while the window is open.
#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/log.hpp"
#include "haptics/device_check.hpp"
#include "haptics/devices/turned_device.hpp"
#include "haptics/session/devices.hpp"

namespace palpate {

class Messages;

struct HeldDeviceOptions {
  double rate_Hz = 1000;
  bool ownScheduler = false, rumbles = false;
  bool realtime = true;  ///< false: a script has a clock of its own, with which no device can be held
  bool quiet = false;
  std::string axes;  ///< DeviceAxes::text(), in place of those that are remembered
};

/// For the window's thread. Opening, the test and the survey of devices run on threads of their own; follow() takes
/// their results.
class HeldDevice final : private LogListener {
 public:
  static constexpr const char* kMouse = "mouse";

  explicit HeldDevice(const HeldDeviceOptions& options);
  ~HeldDevice() override;
  HeldDevice(const HeldDevice&) = delete;
  HeldDevice& operator=(const HeldDevice&) = delete;

  /// Opens the device before the window does, and waits for it. Throws Error.
  void open(const std::string& device);
  /// Holds another device, or with kMouse none, from one of the next follow() on, and remembers that choice once it
  /// works. Throws UsageError where no device can be held.
  void choose(const std::string& device);
  /// The same for the device that was chosen last, if there was one. Without it the mouse moves the stylus.
  void chooseLast();
  /// The device is lost: the mouse moves the stylus.
  void lose();
  void lookAround();

  /// Begins the guided test, with the held device; the mouse moves the stylus meanwhile.
  void beginTest();
  void endTest() { stopTest_ = true; }
  /// What the test found is remembered for the device, and used from now on. Throws Error.
  void useStiffness();
  void useAxes();
  /// Closes the result of the test.
  void closeResult() { found_.reset(); }
  /// Remembers axes, as in x,z,-y, and uses them. Throws UsageError if they are not a permutation.
  void setAxes(const std::string& axes);
  void forget();

  /// Once per frame. True if device() is another one now: it must be given to the session before the next call.
  /// `mayChange`: false while the session cannot take another one.
  bool follow(Messages& messages, bool mayChange);

  enum class Stage { mouse, opening, held, tested };
  Stage stage() const { return stage_; }
  /// The device that moves the stylus; null: the mouse does.
  std::shared_ptr<TurnedDevice> device() const { return stage_ == Stage::held ? device_ : nullptr; }
  /// Name of the device, as in --device; kMouse without one.
  const std::string& name() const { return name_; }
  /// Facts of the open device, held or tested; null if none is open.
  const OpenedDevice* opened() const { return device_ ? &opened_ : nullptr; }
  /// Facts of the device for its session: the middle of its workspace is the origin.
  HapticDeviceFacts centredFacts() const;
  /// State of the device at the last tick.
  std::optional<DeviceState> state() const { return device_ ? device_->seen() : std::nullopt; }
  /// The newest sentence about the device; empty: none.
  const std::string& said() const { return said_; }
  bool isLooking() const { return looking_.valid(); }
  /// Empty: not looked yet.
  const std::optional<std::vector<DeviceSurvey>>& around() const { return around_; }
  /// The running test; null if none runs.
  const DeviceCheckQuery* test() const { return stage_ == Stage::tested ? query_.get() : nullptr; }
  const std::optional<DeviceCheckResult>& found() const { return found_; }

 private:
  void said(std::string_view line) override;
  void progressed(std::string_view, double) override {}
  OpenedDevice opening(const std::string& device);
  void hold(OpenedDevice opened);
  void letGo();
  void takeOpened(Messages& messages);
  void takeTested(Messages& messages);
  void remember(const RememberedDevice& wanted);
  void rememberChoice();
  void again();

  HeldDeviceOptions options_;
  DeviceMemory memory_;
  Log log_;
  std::mutex guard_;                // of heard_
  std::vector<std::string> heard_;  // sentences of the device, from any thread
  std::string said_;

  Stage stage_ = Stage::mouse;
  std::string name_ = kMouse;
  bool isRemembered_ = false;  // the choice of name_
  bool hasChanged_ = false;    // device(), since the last follow()
  OpenedDevice opened_;        // without its device
  std::shared_ptr<TurnedDevice> device_;
  std::optional<std::vector<DeviceSurvey>> around_;
  std::unique_ptr<DeviceCheckQuery> query_;
  std::optional<DeviceCheckResult> found_;
  std::atomic<bool> stopOpening_ = false, stopTest_ = false;

  // Destroyed first.
  std::future<OpenedDevice> opens_;
  std::future<DeviceCheckResult> tests_;
  std::future<std::vector<DeviceSurvey>> looking_;
};

}  // namespace palpate
