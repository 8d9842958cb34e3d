// The header of a session log: how to run the session again.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/edit_stream.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/passivity.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// A session as its log describes it.
struct RecordedSession {
  SessionConfig config;        ///< with the path of the model's file at that time
  SessionConfig built;         ///< with which the back end was made
  bool paintable = false;      ///< and kept colours for a later brush
  std::uint64_t points = 0;    ///< of the model
  std::uint64_t checksum = 0;  ///< of the model as it was loaded, normals included
  std::string document;        ///< the file that the user opened, if the model is another one; empty: the model's
  std::string machine, palpate;
  DeviceLimits limits;
  WorkspaceMap map;
  std::optional<PassivityMode> passivity;
};

/// Text of a header.
std::string headerText(const RecordedSession& session);
/// Reads a header. Throws FileError for a text that it does not understand, such as that of an older palpate.
RecordedSession parseHeader(const std::filesystem::path& log, const std::string& text);

/// Passes on each tick in the form of a session log, with the back end's part of it.
class TickTap final : public TickRecorder {
 public:
  /// `edits`: those of the points; null: there are none. `sink` runs on the servo thread, as part of the tick.
  TickTap(const EditStream* edits, std::function<void(const LoggedTick&)> sink)
      : edits_(edits), sink_(std::move(sink)) {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override;

  // For the thread that ticks, between two ticks.
  /// While the points are lent to another thread, their progress stays as at the last tick.
  void hold(bool on) noexcept { isHeld_ = on; }
  /// The next tick comes after a command.
  void noteCommand() noexcept { isCommanded_ = true; }

 private:
  const EditStream* edits_;
  std::function<void(const LoggedTick&)> sink_;
  EditProgress progress_;
  bool isHeld_ = false, isCommanded_ = false;
};

}  // namespace palpate
