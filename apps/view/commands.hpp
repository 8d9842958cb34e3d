// Commands of the user, which keys, panels and scripts post and the window carries out in order; questions to the user.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/render/camera_motion.hpp"
#include "engine/select/preparation.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/session/unsaved_strokes.hpp"

namespace palpate {

/// Holding the stylus with mouse, gamepad or 3D mouse: while a key is down (hold, letGo), without a key (lockOrUnlock),
/// or not at all (putAway).
enum class StylusCommand { hold, letGo, lockOrUnlock, putAway };

/// What is done with the brush, or its stroke. cancelStroke: takes the stroke in progress back; the other commands of
/// its key are then left out.
enum class BrushCommand { dragSize, dragStrength, cancelStroke };

/// Commands to the window; the last four do nothing without a model. stopReading: also ends cleaning.
enum class WindowCommand {
  quit,
  stopReading,
  closeErrors,
  switchForces,
  endMeasure,
  saveMeasures,
  copyPlaces,
  resetView,
  turnModel,
  screenshot
};

/// Commands to the open model. pause and step: the frames of a depth camera, or a simulation.
enum class ModelCommand { undo, redo, save, exportTicks, endRecording, endPlaying, restart, pause, step };

/// Commands about the selected points, and about the outline that selects.
enum class SelectCommand {
  all,
  none,
  invert,
  grow,
  shrink,
  connected,
  hide,
  isolate,
  showAll,
  lock,
  unlockAll,
  invertLock,
  softenLock,
  sharpenLock,
  within,
  everywhere,
  remove,
  paint,
  closeOutline,
  takeBack,
  cancelOutline,
  holdOutline,
  letOutlineGo
};

/// How points that were found change the selection.
enum class Combine { set, add, remove, intersect };
constexpr Combine combineBy(bool shift, bool control) {
  if (control) return shift ? Combine::intersect : Combine::remove;
  return shift ? Combine::add : Combine::set;
}
/// Selects what is in the box, in the ball, or on the side of the plane.
struct SelectVolume {
  Combine how = Combine::set;
};
/// Places that volume by numbers, as VolumeTool::set().
struct SetVolume {
  std::string numbers;
};
/// Turns the plane to its other side.
struct FlipPlane {};
/// Brushes are mirrored at that plane.
struct MirrorAtPlane {};
/// Numbers of moveSelection().
struct MoveSelection {
  std::string way, angles_deg, factor;
};

/// Answers: about unsaved changes, how to save, memory, and about strokes of an earlier program; `cancel` is of the
/// first three.
enum class Answer { saveFirst, discard, cancel, saveBeside, saveOver, readAnyway, goOnWithLeft, discardLeft, keepLeft };

/// Purpose of a file; the file dialogue is for all but the last two. separate: exports the selected points and removes
/// them.
enum class FileTask { open, saveAs, exportMesh, exportSelection, separate, record, play };
struct FileCommand {
  FileTask task;
  std::string file;
};
/// Opens the file dialogue.
struct BrowseCommand {
  FileTask task;
};

/// Of a walk, as the viewer sees it; up is along Camera::up.
enum class WalkDirection : std::uint8_t { forward, back, left, right, up, down };
inline constexpr std::size_t kWalkDirections = 6;
/// Walks in that direction from now on, or no longer.
struct WalkCommand {
  WalkDirection direction = WalkDirection::forward;
  bool on = false;
};

struct LookAlong {
  int axis;
  bool fromBehind;
};
/// Keeps the present view under a name, shows a kept one, or removes it.
struct NamedViewCommand {
  enum class What { remember, show, forget } what;
  std::string name;  ///< empty: view 1, view 2 and so on
};
/// Chooses a measured distance and looks at it, gives it another name, or removes it.
struct MeasureCommand {
  enum class What { show, rename, forget } what;
  std::string name, to = {};
};
/// Sets a parameter of the simulation.
struct SetParameter {
  std::string name;
  double value;
};
/// Gives the selected points a value of a field, by its name; the value as typed.
struct SetValue {
  std::string field, value;
};
/// Layers of strokes. add: a new one, into which strokes go; addOrClose: or none, if they go into one; slideFurther: as
/// slide, in the same entry of the history.
struct LayerCommand {
  enum class What { add, addOrClose, open, close, slide, slideFurther, hide, show, merge } what;
  std::string name;  ///< of a new one empty: layer 1, layer 2 and so on
  double strength = 1;
};
/// Keeps the selection as a field: 1 of the selected points, 0 of all others.
struct KeepSelection {
  std::string field;
};
/// Selects the points for which an expression of their fields holds; without one, those in the range of the colours.
/// With both flags it keeps those that were selected before.
struct SelectWhere {
  std::optional<std::string> condition;
  bool adds = false, removes = false;
};
/// Cleans the model: one step of a preparation, or its normals. Points that the step would drop are selected: added to,
/// or removed from, those that are; with both flags it keeps what was selected before.
struct CleanModel {
  Preparation step;
  std::optional<NormalSource> normals = {};
  bool adds = false, removes = false;
};
/// Range of the colours, as typed.
struct SetColorRange {
  std::string text;
};
/// True length of the measure in mm, as typed.
struct SetTrueLength {
  std::string text;
};

/// Commands about the device in the hand.
enum class DeviceCommand { look, test, endTest, useStiffness, useAxes, closeResult, forget };
/// Holds another device, as in --device, or the mouse.
struct ChooseDevice {
  std::string device;
};
/// Axes of the device, as typed.
struct SetDeviceAxes {
  std::string text;
};
/// Opens a made model, and chooses the tool for it: feel, the brush carve, or the measure.
enum class TryExample { press, carve, measure };
/// Copies a text to the clipboard.
struct CopyText {
  std::string text;
};

using ViewCommand =
    std::variant<WindowCommand, ModelCommand, StylusCommand, BrushCommand, SelectCommand, Answer, FileCommand,
                 BrowseCommand, ModelSide, LookAlong, WalkCommand, NamedViewCommand, MeasureCommand, SetParameter,
                 SetValue, SelectVolume, SetVolume, FlipPlane, MirrorAtPlane, MoveSelection, KeepSelection, SelectWhere,
                 CleanModel, SetColorRange, SetTrueLength, DeviceCommand, ChooseDevice, SetDeviceAxes, TryExample,
                 CopyText, LayerCommand>;
using ViewCommands = std::vector<ViewCommand>;

/// Whether to save beside a file or over it.
struct SaveQuestion {
  std::string loses;         ///< text that says what the file would lose
  std::string beside, kept;  ///< name of a copy beside it, and the name that the original would be kept under
};

/// Whether to continue with unsaved strokes of an earlier program.
struct LeftQuestion {
  std::string file;
  StrokesSince strokes;
  std::filesystem::file_time_type made;
  std::size_t waiting = 0;  ///< number of further programs whose strokes are asked about next
};

}  // namespace palpate
