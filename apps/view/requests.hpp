// What a person asks of the window, and is asked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "engine/render/camera_motion.hpp"

namespace palpate {

/// Of the mouse, the pad or the cap, which may hold the stylus: to hold it while a key is down, to keep it without one,
/// or to have done with it.
enum class StylusRequest { hold, letGo, lockOrUnlock, putAway };

/// What a file is looked for.
enum class FileTask { open, saveAs, exportMesh };

/// What a person asks for.
struct ViewRequests {
  bool undo = false, redo = false, save = false, resetView = false, screenshot = false, exportTicks = false,
       endRecording = false, endPlaying = false, quit = false;
  bool saveFirst = false, discard = false, cancel = false;           ///< the answer about changes that are not saved
  bool saveBeside = false, saveOver = false;                         ///< the answer how to save, or cancel
  bool goOnWithLeft = false, discardLeft = false, keepLeft = false;  ///< the answer about strokes that are left
  bool closeErrors = false;                                          ///< they were seen
  bool forgetMeasure = false;                                        ///< its places are not shown any more
  bool switchForces = false;                                         ///< off, or on again
  bool holdFrames = false, stepFrame = false;  ///< of a depth camera, or of matter that moves by itself
  bool restart = false;                        ///< what moves by itself
  std::optional<int> axis;                     ///< to look along
  bool fromBehind = false;
  std::optional<ModelSide> side;  ///< to look from
  bool copyPlaces = false;        ///< that are picked
  std::optional<StylusRequest> stylus;
  std::optional<FileTask> browse;  ///< a file is to be looked for
  std::string open, saveAs, exportMesh, record, play;
  std::optional<std::pair<std::string, double>> parameter;  ///< of what moves by itself, and its value
  std::string trueLength;  ///< in mm, of what is measured, as it was typed; empty: none
};

/// Whether to save beside a file or over it.
struct SaveQuestion {
  std::string loses;         ///< what that file would lose, in words
  std::string beside, kept;  ///< the name beside it, and the one that it is kept under
};

/// Whether to go on with strokes that a program before has not saved.
struct LeftQuestion {
  std::string file;
  std::size_t strokes = 0;
  std::filesystem::file_time_type made;
};

}  // namespace palpate
