// Strokes that are in no file yet: a session log without ticks has them while they are made, so that the next program
// can go on with them where this one ends without having saved them.
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

class Journal;
struct Model;
struct ModelConfig;

/// A folder with the strokes on one model, which one program has at a time.
class StrokeFolder {
 public:
  /// A new one in `root`. Throws FileError.
  explicit StrokeFolder(const std::filesystem::path& root);
  /// One that is there; null where a program that runs has it.
  static std::unique_ptr<StrokeFolder> open(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return path_; }
  /// The log of that number; a later one has all that those before it have.
  std::filesystem::path log(unsigned number) const;
  /// Numbers of those that are there, in order.
  std::vector<unsigned> logs() const;
  void removeLogs(unsigned before);
  /// The model's file as it was when the strokes began; empty where it is where it was.
  std::filesystem::path keptModel() const;
  /// Whether the logs have nothing that the model's file has not, as where all strokes are undone.
  bool isUnchanged() const;
  void setUnchanged(bool on);
  /// Keeps that file, which is about to be replaced. Throws FileError.
  void keepModel(const std::filesystem::path& file);
  /// With all that is in it.
  void remove();
  /// Under another name, where nobody looks for strokes. Where it is then; it stays where it was if that is impossible.
  std::filesystem::path putAside();

 private:
  StrokeFolder() = default;

  std::filesystem::path path_;
  FileLock lock_;
};

/// What a program that has ended has left in such a folder.
struct LeftStrokes {
  std::shared_ptr<StrokeFolder> folder;
  RecordedSession session;
  EditBatch edits;
  std::size_t strokes = 0;
  std::filesystem::file_time_type made;
  std::vector<std::string> lacks;  ///< a sentence for each gap

  /// What their model was for the person.
  const std::string& document() const;
  /// The model, with its own file.
  ModelConfig model() const;
  /// Throws FileError where it is another one than the strokes were made on.
  void requireModel(const Model& model) const;
};
/// All that is left in `root`, the latest first. Folders with nothing in them are removed, and so are those whose
/// strokes were all undone. `say` hears of those that cannot be read, which are put aside, under another name.
std::vector<LeftStrokes> leftStrokes(const std::filesystem::path& root,
                                     const std::function<void(const std::string&)>& say);
/// Has a journal of the model follow what was done to it, strokes that were taken back or made again included.
void followAgain(Journal& journal, const EditBatch& edits);

/// Keeps the strokes of a session. Nobody waits for it: files are made and written on threads of their own. All but
/// keepModel() is for one thread.
class UnsavedStrokes {
 public:
  /// `model` outlives it.
  UnsavedStrokes(std::filesystem::path root, const Model& model) : root_(std::move(root)), model_(model) {}
  /// What it has stays for the next program, unless it was removed.
  ~UnsavedStrokes();
  UnsavedStrokes(const UnsavedStrokes&) = delete;
  UnsavedStrokes& operator=(const UnsavedStrokes&) = delete;

  /// What the session is, from which its model comes again.
  void describe(RecordedSession session) { session_ = std::move(session); }
  void setDocument(const std::string& file) { session_.document = file; }
  /// Goes on with what another program has left, in its folder.
  void adopt(const LeftStrokes& left);
  /// `fresh`: what was done since the last call, which the journal has. `isChanged`: whether the points are others than
  /// those of their file.
  void follow(const EditBatch& fresh, const Journal& journal, bool isChanged);
  /// The points are in a file as they are.
  void saved();
  /// The model's file is about to be replaced. For any thread.
  void keepModel();
  /// Nothing of them is wanted any more.
  void remove();
  /// What cannot be written, in words, once.
  std::optional<std::string> takeFault();

 private:
  bool isKept() const { return writer_ || making_.valid(); }
  void begin(EditBatch initial);
  void takeMade();
  void writePending();
  void noteUnchanged(bool on);
  StrokeFolder& folder();
  void fail(const std::string& what);
  EditBatch snapshot(const Journal& journal) const;

  std::filesystem::path root_;
  const Model& model_;
  RecordedSession session_;
  std::mutex folderLock_;  // of
  std::shared_ptr<StrokeFolder> folder_;
  unsigned number_ = 0;     // of the last log
  bool unchanged_ = false;  // as the folder has it
  bool wasKept_ = false;    // so that the points before the next stroke may be others than the model's
  std::future<std::unique_ptr<SessionWriter>> making_;
  std::unique_ptr<SessionWriter> writer_;
  EditBatch pending_;
  Stopwatch sinceWritten_;
  std::uint64_t states_ = 0;  // in the log
  std::mutex faultLock_;      // of
  std::optional<std::string> fault_;
  std::atomic<bool> failed_ = false;
};

}  // namespace palpate
