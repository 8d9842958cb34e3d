// Requests of the user to the window, and questions to the user.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "engine/render/camera_motion.hpp"

namespace palpate {

/// Holding the stylus with mouse, gamepad or 3D mouse: while a key is down (hold, letGo), without a key (lockOrUnlock),
/// or not at all (putAway).
enum class StylusRequest { hold, letGo, lockOrUnlock, putAway };

/// Purpose of the file dialogue.
enum class FileTask { open, saveAs, exportMesh };

/// Requests of the user.
struct ViewRequests {
  bool undo = false, redo = false, save = false, resetView = false, screenshot = false, exportTicks = false,
       endRecording = false, endPlaying = false, quit = false;
  bool saveFirst = false, discard = false, cancel = false;           ///< answer about unsaved changes
  bool saveBeside = false, saveOver = false;                         ///< answer how to save, or cancel
  bool goOnWithLeft = false, discardLeft = false, keepLeft = false;  ///< answer about strokes of an earlier program
  bool closeErrors = false;                                          ///< hide the errors
  bool forgetMeasure = false;                                        ///< remove the picked positions
  bool switchForces = false;                                         ///< toggle forces
  bool holdFrames = false, stepFrame = false;                        ///< pause or step a depth camera or a simulation
  bool restart = false;                                              ///< of a simulation
  std::optional<int> axis;                                           ///< look along this axis
  bool fromBehind = false;
  std::optional<ModelSide> side;  ///< look from this side
  bool copyPlaces = false;        ///< copy the picked positions
  std::optional<StylusRequest> stylus;
  std::optional<FileTask> browse;  ///< open the file dialogue
  std::string open, saveAs, exportMesh, record, play;
  std::optional<std::pair<std::string, double>> parameter;  ///< name and value of a simulation's parameter
  std::string trueLength;                                   ///< true length of the measure in mm, as typed; empty: none
};

/// Whether to save beside a file or over it.
struct SaveQuestion {
  std::string loses;         ///< text that says what the file would lose
  std::string beside, kept;  ///< name of a copy beside it, and the name that the original would be kept under
};

/// Whether to continue with unsaved strokes of an earlier program.
struct LeftQuestion {
  std::string file;
  std::size_t strokes = 0;
  std::filesystem::file_time_type made;
};

}  // namespace palpate
