// A service of Haply devices in this process, with a simulated hand behind it and faults on demand. It answers on ports
// of its own, which the program finds through PALPATE_HAPLY_CONFIG.
//
// With a SteppedClock time passes by its answers: each lets the session do the ticks until then, and comes after them.
// So a test of faults does the same on a machine that stalls. Where a fault keeps it from answering, time passes by the
// machine's clock, but never faster than the session ticks.
#pragma once

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/vec.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/path.hpp"
#include "haptics/session_clock.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/surroundings.hpp"

namespace palpate {

struct FakeHaplyOptions {
  std::vector<PathKey> hand{{0, DVec3(0)}};  ///< about kMiddle_mm, in palpate's axes; time since the first command
  SimulatedTouchOptions arm{};               ///< and its damping
  std::string begins;     ///< if not empty: a file of folder(); the hand begins its path once that exists
  bool restarts = false;  ///< each connection of a device puts the hand back to the start of its path
  std::string version = "3.5.0", permutation = "XYZ", handedness = "right";
  std::vector<std::string> ids{"049D"};
  bool inUse = false, calibrated = true, wireless = true, grips = true, pressed = false;
  SteppedClock* clock = nullptr;  ///< of the session and the device; must outlive the service
  double rate_Hz = 4000;          ///< of its answers by that clock; without one they come at once
  double step_s = 0;              ///< if not 0, the cursor steps by kStep_mm each time
  bool tellsForce = true;         ///< false: it reports no force, whatever it applies
  bool hangsUp = false;           ///< it closes each connection before its first message
  /// Begins once a force of kFelt_N was felt in 30 commands in a row: mute, merged (mute, then one answer to all that
  /// came), half, closed, nan, null, uncalibrated, unpowered, safety, jump, gone, second (a program that adds
  /// kSecond_N).
  std::string fault;
  double fault_s = 0.2;
};

class FakeHaply {
 public:
  static constexpr DVec3 kMiddle_mm{0, 150, 120};
  static constexpr DVec3 kSecond_N{0.6, 0, 0};
  static constexpr double kFelt_N = 0.2, kStep_mm = 0.5;

  explicit FakeHaply(FakeHaplyOptions options);
  ~FakeHaply();

  /// A command that came.
  struct Command {
    double time_s = 0;     ///< since the service began
    std::string id;        ///< of the device
    bool values = false;   ///< spelling of the force
    bool profile = false;  ///< it names the program
    DVec3 force_N{0};      ///< in palpate's axes
    DVec3 position_mm{0};  ///< of the state before it, about kMiddle_mm
    bool afterFault = false;
  };
  std::vector<Command> commands() const;
  /// Returns when no device has a connection any more, so that no further command comes. Throws Error after half a
  /// minute.
  void waitUntilLeft() const;
  /// Whatever came that was neither a force, nor the program's name, nor a question for the version: a request that
  /// could change a setting of a device.
  std::vector<std::string> otherRequests() const;
  /// When the first faulty state was sent, or not sent; negative if none was.
  double faultBegan_s() const;
  /// Commands with a force that came after the first faulty state.
  int forcesAfterFault() const;
  /// From the first state with a new position to the first force that answers it, microseconds (step_s).
  std::vector<double> latencies_us() const;
  /// The file "path_end" is in it once the hand has reached the end of its path, "fault" once the fault has begun.
  const ScratchFolder& folder() const { return folder_; }

 private:
  struct Service;
  ScratchFolder folder_;
  std::unique_ptr<Service> service_;
  Variable config_;
  std::jthread thread_;
};

}  // namespace palpate
