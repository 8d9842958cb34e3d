// The device behind the fake driver libraries: a simulated Touch in a hand that follows a script, with scripted faults,
// and a record of events that survives a crash.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/devices/simulated_touch.hpp"

namespace palpate {

/// Lines of a script, which the environment variable PALPATE_FAKE_DEVICE names (PALPATE_FAKE_SECOND_DEVICE for the
/// second stylus of a driver); # begins a comment:
///   hand FILE.csv        path of the hand (t_s,x,y,z), model units; default: at rest at the origin
///   map SCALE X Y Z      position of the model in the device's space
///   lead S               delay before the hand starts, seconds
///   skip N               the clock is stopped for the first N frames
///   hurry                the hand follows the wall clock once frames are late, as a person does; without it,
///                        the hand follows the number of frames
///   button BIT AT_S FOR_S
///   turn W X Y Z         orientation of the stylus
///   note FILE            file of events, as a FakeNote
///   fault NAME [NUMBER] [AT_S] [FOR_S]
struct FakeFault {
  std::string name;
  double number = 0, at_s = 0, for_s = 1e9;
  bool isOn(double time_s) const { return time_s >= at_s && time_s < at_s + for_s; }
};

/// In a file mapped into memory, so that the last force can be read after a crash.
struct FakeNote {
  std::uint64_t frames = 0;
  double position_mm[3]{}, force_N[3]{};
  double mostForce_N = 0;
  std::uint64_t threadFaults = 0;  ///< calls from a thread that had not made the device current
  std::uint64_t frameFaults = 0;   ///< frames begun twice, or ended without a begin
  std::uint64_t lateForces = 0;    ///< forces other than zero during a fault that disables forces
  std::uint32_t opened = 0, closed = 0, enabled = 0;
};

/// Zero at first, shared by all processes that map the file; nullptr if the file cannot be mapped.
FakeNote* mappedNote(const std::filesystem::path& file);

class FakeDevice {
 public:
  static constexpr const char *kFirst = "PALPATE_FAKE_DEVICE", *kSecond = "PALPATE_FAKE_SECOND_DEVICE";
  /// Reads the script named by an environment variable; without one the hand is at rest. Aborts with a message if the
  /// script cannot be parsed, which is a bug in a test.
  explicit FakeDevice(const char* variable = kFirst);

  const FakeFault* fault(const std::string& name) const;
  /// The fault if it is active now.
  const FakeFault* faultNow(const std::string& name) const;

  /// Advances to the next frame, `dt_s` after the last.
  void advance(double dt_s);
  double time_s() const { return time_s_; }
  DVec3 position_mm() const { return position_mm_; }
  std::uint32_t buttons() const;
  DQuat turn() const { return turn_; }
  void push(const DVec3& force_N);

  FakeNote& note() { return *note_; }

 private:
  void read(const std::filesystem::path& script);

  struct Press {
    std::uint32_t bit;
    double at_s, for_s;
  };
  std::optional<SimulatedTouch> touch_;
  std::vector<FakeFault> faults_;
  std::vector<Press> presses_;
  std::uint64_t skip_ = 0;
  bool hurries_ = false;
  std::optional<Stopwatch> sinceFirst_;  // since the first frame that is neither skipped nor read on opening
  DQuat turn_{1, 0, 0, 0};
  std::atomic<double> time_s_ = 0;  // also read by the scheduler thread
  DVec3 position_mm_{0};
  FakeNote own_;
  FakeNote* note_ = &own_;
};

}  // namespace palpate
