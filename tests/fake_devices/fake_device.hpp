// What stands behind the fake driver libraries: a simulated Touch in a hand that follows a script, faults that come
// when the script says, and a note of what happened that outlives a crash.
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

/// Lines of a script, which the variable PALPATE_FAKE_DEVICE names (PALPATE_FAKE_SECOND_DEVICE: of the second stylus of
/// a driver); # begins a comment:
///   hand FILE.csv        the way of the hand (t_s,x,y,z), model units; at rest in the origin unless given
///   map SCALE X Y Z      where the model lies in the device's space
///   lead S               the hand waits so long
///   skip N               the clock stands still for the first N frames
///   hurry                the hand goes by the wall clock once frames have fallen behind that, as a person's does; else
///                        it is as slow as they are
///   button BIT AT_S FOR_S
///   turn W X Y Z         how the stylus is held
///   note FILE            what happened, as a FakeNote
///   fault NAME [NUMBER] [AT_S] [FOR_S]
struct FakeFault {
  std::string name;
  double number = 0, at_s = 0, for_s = 1e9;
  bool isOn(double time_s) const { return time_s >= at_s && time_s < at_s + for_s; }
};

/// Lies in a file that is mapped into memory, so that whoever looks sees the last force also after a crash.
struct FakeNote {
  std::uint64_t frames = 0;
  double position_mm[3]{}, force_N[3]{};
  double mostForce_N = 0;
  std::uint64_t threadFaults = 0;  ///< calls from a thread that had not made the device current
  std::uint64_t frameFaults = 0;   ///< frames begun twice or ended that were not begun
  std::uint64_t lateForces = 0;    ///< other than zero while the device had a fault that takes forces away
  std::uint32_t opened = 0, closed = 0, enabled = 0;
};

/// Zero at first, and there for everybody as long as the file is; nothing where it cannot be.
FakeNote* mappedNote(const std::filesystem::path& file);

class FakeDevice {
 public:
  static constexpr const char *kFirst = "PALPATE_FAKE_DEVICE", *kSecond = "PALPATE_FAKE_SECOND_DEVICE";
  /// Reads the script that a variable of the environment names; a hand at rest where it names none. Stops the program,
  /// with words, for a script that it does not understand: that is a bug of a test.
  explicit FakeDevice(const char* variable = kFirst);

  const FakeFault* fault(const std::string& name) const;
  /// One that is on now.
  const FakeFault* faultNow(const std::string& name) const;

  /// The next frame, `dt_s` after the last.
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
  std::optional<Stopwatch> sinceFirst_;  // frame after those that are skipped, and the one that may be read at opening
  DQuat turn_{1, 0, 0, 0};
  std::atomic<double> time_s_ = 0;  // the scheduler looks, too
  DVec3 position_mm_{0};
  FakeNote own_;
  FakeNote* note_ = &own_;
};

}  // namespace palpate
