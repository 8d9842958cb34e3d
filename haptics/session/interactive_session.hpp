// A session for a person: with a guided stylus or a held device, saving, unsaved strokes and recordings.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/saving.hpp"
#include "haptics/devices/guided_touch.hpp"
#include "haptics/devices/turned_device.hpp"
#include "haptics/session/pointer_stroke.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/tick_feed.hpp"
#include "haptics/session/unsaved_strokes.hpp"

namespace palpate {

struct InteractiveOptions {
  /// The device that a person holds; it replaces the guided stylus and is passed on from model to model.
  std::shared_ptr<TurnedDevice> device;
  HapticDeviceFacts deviceFacts;
  /// Clock of the ticks; it replaces the machine's and is passed on from model to model.
  std::shared_ptr<SteppedClock> clock;
  /// Folder in which unsaved strokes are kept for the next program, in case this one ends; empty: they are not kept.
  std::filesystem::path unsavedIn;
  /// Unsaved strokes of an earlier program on this model, with which the session continues; null: none.
  std::shared_ptr<const LeftStrokes> left;
  /// Masks and fields of the session whose points this one continues with, and what of them can be undone (handOn());
  /// null, or where none can be set: none.
  std::shared_ptr<const EditBatch> attributes;
};

/// Throws FileError where the model contains no points.
void requirePoints(const Model& model, const std::string& file);

/// Owns a live Session that a person feels, sees and sculpts. All but the constructor is for one thread, the one that
/// shows the model; the constructor may run on another thread.
class InteractiveSession {
 public:
  /// Builds everything and starts. Without a brush in the configuration the surface is only felt until setBrush().
  /// Throws Error.
  InteractiveSession(const SessionConfig& config, Model model, SessionParts parts, const InteractiveOptions& options);
  ~InteractiveSession();
  InteractiveSession(const InteractiveSession&) = delete;
  InteractiveSession& operator=(const InteractiveSession&) = delete;

  /// To be read; commands pass through this class, which does nothing after a failure.
  const Session& session() const { return session_; }
  const SessionConfig& config() const { return session_.config(); }
  const Model& model() const { return session_.model(); }
  const std::string& file() const { return config().model.file; }
  /// Bounds of the model as loaded, model units relative to its origin.
  const Bounds& bounds() const { return bounds_; }
  /// Of Model::shownBounds(), model units.
  double longestSide() const { return longestSide_; }

  /// Called once per frame: takes in the ticks and the edits of the servo thread. Returns what failed since the last
  /// call; the session ends with a failure.
  std::optional<std::string> follow();
  /// With InteractiveOptions::clock: runs the ticks up to that time, and follows.
  std::optional<std::string> tickUntil(double clock_s);
  const RecentTicks& recentTicks() const { return recentTicks_; }
  /// All changes of points, masks and fields since the last call (edits, undo, others' edits), without marks, for a
  /// caller with a copy of its own.
  EditBatch takeBatch() { return std::exchange(batch_, {}); }
  std::uint64_t edits() const { return edits_; }  ///< number of point states so far
  /// Number of changes of masks and fields so far.
  std::uint64_t attributeChanges() const { return attributeChanges_; }
  /// Has not failed.
  bool isTouching() const { return !failed_; }
  /// Session::pause(), and resume() unless it has failed.
  void pause() { session_.pause(); }
  void resume() {
    if (!failed_) session_.resume();
  }

  /// From now on another device is held, or with null the stylus is guided. Ends a recording and a playback. Goes on
  /// after the loss of the device before. Throws query failures.
  void setDevice(std::shared_ptr<TurnedDevice> device, const HapticDeviceFacts& facts);
  /// Whether the session has failed because its device did.
  bool hasLostDevice() const { return failed_ && options_.device && session_.live()->deviceFailed(); }

  // The guided stylus; positions in file coordinates. No effect where a person holds a device.
  void aim(const DVec3& place, bool sculpts = true) {
    if (stylus_.aim(place, sculpts)) session_.live()->wake();
  }
  void lift() {
    stylus_.lift();
    session_.live()->wake();
  }
  /// How a stroke of this session's pointer presses, `press_mm` deep.
  StrokeOptions strokeOptions(double press_mm) const;
  /// The stylus follows that stroke, in place of aims, until it is over. No effect while a stroke is in progress.
  void press(PointerStroke stroke);
  /// The stroke whose button is down; null: none is.
  PointerStroke* stroke() { return stroke_ && !stroke_->isReleased() ? &*stroke_ : nullptr; }
  /// Whether a stroke is in progress: its button is down, or the stylus is still on its path.
  bool isDrawing() const { return stroke_ || stylus_.isDrawing(); }
  /// All events of the pointer before `known_s` were given to stroke().
  void drawUntil(double known_s);
  /// Also resumes a device that a signal has stopped.
  void setForces(bool on);
  bool forcesOn() const { return forcesOn_; }

  // As in Session; they do nothing after a failure.
  void setBrush(const std::optional<BrushConfig>& brush);
  void setContact(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method);
  void setParameter(std::string_view name, double value);
  void setMask(MaskRole role, const PointSet& points) {
    if (!failed_) session_.setMask(role, points);
  }
  void setLockWeights(std::span<const std::uint8_t> weights) {
    if (!failed_) session_.setLockWeights(weights);
  }
  void setField(std::uint32_t field, const PointSet& points, std::vector<std::byte> values) {
    if (!failed_) session_.setField(field, points, std::move(values));
  }
  void setField(std::string_view name, ScalarType type, const PointSet& points, std::vector<std::byte> values) {
    if (!failed_) session_.setField(name, type, points, std::move(values));
  }
  void setStrokeLayer(std::uint32_t number, StrokeLayer set, bool isOpen, bool continues = false) {
    if (!failed_) session_.setStrokeLayer(number, std::move(set), isOpen, continues);
  }
  void changePoints(const PointSet& points, const PointsAction& action) {
    if (!failed_) session_.changePoints(points, action);
  }
  /// Throws Error also after a failure.
  std::uint32_t fieldNamed(std::string_view name, ScalarType type = ScalarType::f32);
  /// Takes back the stroke of the pointer or of the device that is in progress, exactly (Session::cancelStroke()), and
  /// drops what the pointer has drawn. False where none is.
  bool cancelStroke();
  /// False where there is nothing to undo, or to redo.
  bool undo() { return undoStrokes(1, 0); }
  bool redo() { return session_.strokes().redoCount > 0 && undoStrokes(0, 1); }
  /// Result of the last undo() or redo().
  const UndoneStrokes& undone() const { return undone_; }

  const History& history() const { return *session_.history(); }
  const LayerAttributes& attributes() const { return session_.scene().layers[0].attributes; }
  /// Whether the points, or the rest shape of a soft body, differ from what was loaded or saved last.
  bool isChanged() const { return session_.strokes().version != saving_.saved; }

  /// Pauses or resumes the frames of a depth camera. Returns whether they are paused now; nothing where no frames are
  /// played.
  std::optional<bool> holdFrames();
  /// Goes to the next frame of a recorded camera while the frames are paused.
  void stepFrame();
  /// Whether frames are paused.
  bool holdsFrames() const { return held_; }
  /// Whether the points are a camera's frame that is paused while a person sculpts it (handOn()).
  bool isHeldStill() const { return !config().model.stream && model().stream() && model().stream()->player; }
  /// The present points as a model, with masks and fields for InteractiveOptions; a camera's with its stream, which is
  /// paused and leaves this session. A session without a configured stream sculpts the points; one with a stream
  /// continues from them. Strokes, and what was set before the last of them, cannot be undone there. Throws query
  /// failures.
  struct HandedOn {
    Model model;
    std::shared_ptr<const EditBatch> attributes;
  };
  HandedOn handOn();
  /// Session::releaseStream() at the time of the next tick.
  std::shared_ptr<PlayedStream> releaseStream();

  /// Writes the present points on another thread. A file that would lose data by this is kept under another name.
  void save(const std::string& file);
  bool isSaving() const { return saving_.running.valid(); }
  /// Result of save(): the file and the name that an older one is kept under, or the failure; SculptedCloud::remark,
  /// and what the format does not keep.
  struct Saved {
    std::string file, kept, failure, remark;
  };
  std::optional<Saved> takeSaved();

  /// Sets the file name that unsaved strokes are later offered under.
  void setDocument(const std::string& file);
  /// Removes the strokes that are kept for the next program, saved or not.
  void leaveStrokes();
  /// Why unsaved strokes cannot be kept; returned once.
  std::optional<std::string> takeUnsavedFault();

  /// Records a session log. A log starts from the model's file: it begins before the first edit. It may begin while the
  /// hand touches, and has all commands from then on. Returns where an older log of that name is kept; empty if there
  /// was none. Throws Error.
  std::filesystem::path record(const std::string& log);
  void endRecording() { session_.endRecording(); }
  bool isRecording() const { return session_.recording() != nullptr; }
  /// Why the recording cannot be written; returned once.
  std::optional<std::string> takeRecordingFault();
  /// Plays the hand of a recorded session; the guided stylus is ignored meanwhile. Returns the gaps of the log.
  std::vector<std::string> play(const std::string& log);
  bool isPlaying() const { return playing_.has_value(); }
  void endPlaying();

 private:
  class Follower;
  void take(const EditBatch& batch);
  void takeIn();
  OpenHand hand();
  void keepUnsaved(const SessionConfig& config);
  void goOnWith(const LeftStrokes& left);
  void dropStroke();
  StrokesSince strokesSince();
  // isChanged(), or a mask is set, which is in no file.
  bool isUnsaved() const;
  bool undoStrokes(std::size_t undo, std::size_t redo);

  Session session_;
  UndoneStrokes undone_;
  InteractiveOptions options_;
  Bounds bounds_;
  double longestSide_;
  GuidedTouch stylus_;
  std::optional<PointerStroke> stroke_;
  WorkspaceMap map_;
  std::atomic<bool> forcesOn_ = true;
  bool held_ = false, failed_ = false;
  double clock_s_ = 0;

  // Results of the servo thread, as taken in.
  RecentTicks recentTicks_;
  std::vector<TraceRow> rows_;
  EditBatch batch_;
  std::uint64_t edits_ = 0, attributeChanges_ = 0;
  std::exception_ptr takeFailure_;

  // The recorded hand that is being played.
  struct Playing {
    std::unique_ptr<HapticDevice> device;
    WorkspaceMap map;
    double end_s = 0;
  };
  std::optional<Playing> playing_;

  std::optional<UnsavedStrokes> unsaved_;
  struct Saving {
    std::future<Saved> running;
    std::uint64_t version = 0, saved = 0;  // of the strokes: being saved, saved last
    OwnSave own;
    std::size_t depth = 0;  // strokes that could be undone when the present save began
  } saving_;
  struct Since {
    StrokesSince before;             // in the points that this session began with
    std::size_t saved = 0, low = 0;  // strokes that could be undone: in the file saved last, fewest since then
  } since_;
};

}  // namespace palpate
