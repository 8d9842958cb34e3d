// What the header of a session log says: how to run the session again.
#pragma once

#include "apps/touch.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// A session as its log describes it.
struct RecordedSession {
  TouchCommandOptions options;  ///< without the files that it wrote
  std::string modelFile;
  std::uint64_t points = 0;    ///< of the model
  std::uint64_t checksum = 0;  ///< of the model as it was loaded, normals included
  std::string machine, palpate;
  DeviceLimits limits;
  WorkspaceMap map;
  std::optional<PassivityMode> passivity;
};

/// The checksum of a model as it was loaded.
std::uint64_t checksumOf(const Model& model);

/// `command`: with the options as they were given. `session.options` is not looked at.
std::string sessionText(const CLI::App& command, const RecordedSession& session);
/// Throws FileError for a text that it does not understand.
RecordedSession parseSessionText(const std::filesystem::path& log, const std::string& text);

/// Passes on each tick as a session log keeps it, with what the back end knows of it.
class TickTap final : public TickRecorder {
 public:
  /// `sink` runs on the servo thread, as part of the tick.
  TickTap(const TouchBackend& backend, std::function<void(const LoggedTick&)> sink)
      : backend_(backend), sink_(std::move(sink)) {}
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override;

 private:
  const TouchBackend& backend_;
  std::function<void(const LoggedTick&)> sink_;
  std::uint64_t leftOut_ = 0;
};

}  // namespace palpate
