// Unsaved strokes: they are written to a session log without ticks as they are made, so that the next program can
// continue with them if this one ends without saving.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/core/edit_batch.hpp"
#include "engine/core/system_file.hpp"
#include "haptics/session/session_header.hpp"
#include "haptics/session_writer.hpp"

namespace palpate {

class LayerAttributes;
class PointStates;
struct Model;
struct ModelConfig;

/// What the present points have that the file saved last does not have.
struct StrokesSince {
  std::size_t made = 0;    ///< strokes
  std::size_t undone = 0;  ///< undone strokes that the file contains

  bool operator==(const StrokesSince&) const = default;
};

/// A folder with the strokes on one model, locked by one program at a time.
class StrokeFolder {
 public:
  /// Makes a new folder in `root`. Throws FileError.
  explicit StrokeFolder(const std::filesystem::path& root);
  /// Opens an existing folder; null where a running program has locked it.
  static std::unique_ptr<StrokeFolder> open(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return path_; }
  /// The log of that number; each log contains everything of the logs before it.
  std::filesystem::path log(unsigned number) const;
  /// Numbers of the existing logs, ascending.
  std::vector<unsigned> logs() const;
  void removeLogs(unsigned before);
  /// The model's file as it was before it was replaced; empty where it was not replaced.
  std::filesystem::path keptModel() const;
  /// Whether the logs add nothing to the model's file, e.g. because all strokes are undone.
  bool isUnchanged() const;
  void setUnchanged(bool on);
  /// What the logs contain; empty where no file was saved, so that their strokes are all.
  std::optional<StrokesSince> since() const;
  void setSince(const StrokesSince& since);
  /// Keeps that file before it is replaced. Throws FileError.
  void keepModel(const std::filesystem::path& file);
  /// Removes the folder with its contents.
  void remove();
  /// Renames the folder so that it is no longer searched for strokes. Returns its path, unchanged if that fails.
  std::filesystem::path putAside();

 private:
  StrokeFolder() = default;

  std::filesystem::path path_;
  FileLock lock_;
};

/// Strokes that an earlier program left in such a folder.
struct LeftStrokes {
  std::shared_ptr<StrokeFolder> folder;
  RecordedSession session;
  EditBatch edits;
  StrokesSince since;
  std::filesystem::file_time_type made;
  std::vector<std::string> lacks;  ///< a sentence for each gap

  /// The file name under which the strokes are offered.
  const std::string& document() const;
  /// The model, read from the kept file if there is one.
  ModelConfig model() const;
  /// Throws FileError where `model` is not the one that the strokes were made on.
  void requireModel(const Model& model) const;
};
/// All strokes left in `root`, the latest first. Removes folders that are empty or whose strokes were all undone.
/// Folders that cannot be read are renamed and reported to `say`.
std::vector<LeftStrokes> leftStrokes(const std::filesystem::path& root,
                                     const std::function<void(const std::string&)>& say);
/// Keeps the strokes of a session. It does not delay the caller: files are made and written on other threads. All but
/// keepModel() is for one thread.
class UnsavedStrokes {
 public:
  /// `model` outlives it.
  UnsavedStrokes(std::filesystem::path root, const Model& model) : root_(std::move(root)), model_(model) {}
  /// The files stay for the next program, unless remove() was called.
  ~UnsavedStrokes();
  UnsavedStrokes(const UnsavedStrokes&) = delete;
  UnsavedStrokes& operator=(const UnsavedStrokes&) = delete;

  /// Sets the session's description, from which the next program reads the model again.
  void describe(RecordedSession session) { session_ = std::move(session); }
  void setDocument(const std::string& file) { session_.document = file; }
  /// Continues the strokes of an earlier program, in its folder.
  void adopt(const LeftStrokes& left);
  /// `fresh`: edits since the last call, already in `points` and their `attributes`. `isChanged`: whether those differ
  /// from the file, by the strokes `since`.
  void follow(const EditBatch& fresh, const PointStates& points, const LayerAttributes& attributes, bool isChanged,
              const StrokesSince& since);
  /// Called when these points, the present ones, have been saved.
  void saved(const PointStates& points, const LayerAttributes& attributes);
  /// Called before the model's file is replaced, from any thread.
  void keepModel();
  /// Removes all kept strokes.
  void remove();
  /// Why strokes cannot be written; returned once.
  std::optional<std::string> takeFault();

 private:
  bool isKept() const { return writer_ || making_.valid(); }
  void begin(EditBatch initial);
  void takeMade();
  void writePending();
  void noteUnchanged(bool on);
  StrokeFolder& folder();
  void fail(const std::string& what);
  EditBatch snapshot(const PointStates& points, const LayerAttributes& attributes) const;

  std::filesystem::path root_;
  const Model& model_;
  RecordedSession session_;
  std::mutex folderLock_;  // protects folder_
  std::shared_ptr<StrokeFolder> folder_;
  unsigned number_ = 0;     // of the last log
  bool unchanged_ = false;  // as noted in the folder
  StrokesSince since_;      // likewise
  // The points before the next stroke, once they were saved: they may differ from the model's.
  std::optional<EditBatch> saved_;
  std::future<std::unique_ptr<SessionWriter>> making_;
  std::unique_ptr<SessionWriter> writer_;
  EditBatch pending_;
  Stopwatch sinceWritten_;
  std::uint64_t states_ = 0;  // in the log
  std::mutex faultLock_;      // protects fault_
  std::optional<std::string> fault_;
  std::atomic<bool> failed_ = false;
};

}  // namespace palpate
