// The open model: how another model replaces it, where it is saved, and the questions to the user before changes are
// lost.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/view/commands.hpp"
#include "apps/view/loader.hpp"
#include "apps/view/recent_files.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

class Messages;
class Window;

/// Objects that a document uses; all outlive it.
struct DocumentParts {
  Context& context;
  Window& window;
  Device& sight;
  const WindowSettings& settings;
  Messages& messages;
};

class Document {
 public:
  /// `asks`: ask about unsaved changes and how to save; off for a script, unless it contains `ask`.
  Document(const DocumentParts& parts, WindowOptions options, bool asks);

  /// Null: no model is open, or it is parked.
  WindowSession* session() const { return session_.get(); }
  /// The model that is shown: also while it is parked, because another one is built in its place.
  const WindowSession* shown() const { return session_ ? session_.get() : parked_.get(); }
  /// Models that were opened, and models that were named or dropped.
  const RecentFiles& recent() const { return recent_; }
  const std::vector<std::string>& offered() const { return offered_; }
  void offer(const std::vector<std::string>& files);

  /// Opens a file. The question about unsaved changes follows once the file has been read; none if that fails.
  void open(const std::string& file);
  /// Opens the present model again at another scale, likewise. Throws Error for a live camera.
  void openAtScale(double mm_per_unit);
  /// Calls `then` now, or after a question about changes that it would lose. `what`: text that follows "Before".
  void leave(const std::string& what, std::function<void()> then);
  /// Result of load(): the same model is its camera's, with the frames paused or resumed.
  enum class Opened { nothing, sameModel, anotherModel };
  /// Called once per frame: advances the opening of a model. `rest` is called before the present model is parked, as
  /// the GPU is needed to build the next one; the model returns if that fails. `letGo`: before another one replaces it.
  Opened load(const std::function<void()>& rest, const std::function<void()>& letGo);
  /// Stops reading a file.
  void stopReading();
  /// A camera's stream leaves its session for the next one, and cannot return.
  bool isStoppable() const { return loader_.isLoading() && !loader_.isStopped() && handedOn_ == HandedOn::no; }
  /// Whether saving would write something that is in no file.
  bool mayBeSaved() const { return session_ && !session_->isSaving() && (isChanged() || !isOfFile()); }
  const Loader& loader() const { return loader_; }
  /// Whether the present model is parked while another one is built in its place.
  bool isGivingWay() const { return loader_.isRead() && agreed_ == Agreed::yes; }
  /// Why a stroke or command is refused meanwhile.
  std::string whyWaiting() const;
  /// Whether the points differ from what was loaded or saved last.
  bool isChanged() const { return session_ && (session_->isChanged() || mapIsChanged_); }

  /// The device that the person holds, or null: of the present model and of later ones. Not while one is opened.
  void setDevice(const std::shared_ptr<TurnedDevice>& device, const HapticDeviceFacts& facts);
  /// Called once per frame: reports the results of saving and recording, and the state of a camera's frames.
  void follow();
  /// Does nothing without a model. Throws its failure.
  void carryOut(ModelCommand command);
  void answer(Answer answer);
  /// Saves the points; that file then becomes the document's file.
  void saveTo(const std::string& file);
  /// Records the hand to a session log, or plays it.
  void record(const std::string& log);
  void play(const std::string& log);
  /// "MODEL<what>-1.<ending>" in the working folder, or the first number without an existing file.
  std::string freeName(const std::string& what, const std::string& ending) const;

  void askFromNowOn();
  /// Closes the model and ends its recording. `keepsStrokes`: unsaved strokes are kept for the next program.
  void close(bool keepsStrokes);
  bool asksAboutChanges() const { return afterQuestion_ != nullptr && !isSavingForIt_; }
  /// Text of the question about unsaved changes; empty where no question is pending.
  std::string changesQuestion() const;
  const std::optional<SaveQuestion>& saveQuestion() const { return saveQuestion_; }
  /// A file that needs more memory than is free.
  const std::optional<MemoryNeed>& memoryQuestion() const { return memoryQuestion_; }
  /// The question about unsaved strokes of an earlier program.
  std::optional<LeftQuestion> leftQuestion() const;
  bool asks() const { return asksAboutChanges() || saveQuestion_ || memoryQuestion_ || leftQuestion(); }
  bool isLeaving() const { return afterQuestion_ != nullptr; }  ///< once the question is answered, or the model saved
  /// Whether a load or save is in progress that needs no answer.
  bool isBusy() const {
    return (loader_.isLoading() && agreed_ != Agreed::asked) || (isLeaving() && isSavingForIt_ && !saveQuestion_);
  }
  const std::string& saveFile() const { return saveFile_; }
  const std::string& saving() const { return saving_; }  ///< file that is being written; empty: none
  /// File name as shown to the user: the file that the model was opened from, or saved to last.
  const std::string& file() const { return file_; }

 private:
  enum class HandedOn { no, held, toGoOn };
  // `what`: purpose of the read, as in leave().
  void read(WindowOptions options, const std::string& what);
  void giveWay(const std::function<void()>& rest);
  bool isLive() const { return opened_.config.model.stream && opened_.config.model.stream->live; }
  // Whether the points are those of a file, so that a saved file can replace it as the document's file.
  bool isOfFile() const;
  bool makeRoom();
  void park(const std::function<void()>& rest);
  void unpark();
  // `file`: name shown to the user.
  void install(std::unique_ptr<WindowSession> session, const std::string& file);
  void endLoad(const Loader::Result& result);
  // Gives the points to a session of the same model.
  void handOn(HandedOn to, WindowOptions options);
  void findLeft();
  void askFirstAbout(const std::string& file);
  void goOnWith(LeftStrokes left);
  // For a camera: pauses or resumes its frames; a paused frame is sculpted once a brush is chosen.
  void pause();
  void step();
  void undo();
  void restart();
  void sayWhatSimulationLacks();
  void sculptHeld();
  void letFramesGoOn();
  // Saves to the file of Ctrl+S; asks first where that file would lose data.
  void save();
  void finishSaving(const WindowSession::Saved& saved);
  void becomeFile(const std::string& file);
  void writeTicks();
  void sayWhatFramesLack();

  DocumentParts parts_;
  WindowOptions options_;
  Messages& messages_;
  RecentFiles recent_;
  std::vector<std::string> offered_;
  Loader loader_;
  std::unique_ptr<WindowSession> session_, parked_;  // parked while the next one is built
  bool hadSemicolons_ = false;                       // the file that was opened
  WindowOptions opened_, opening_;                   // options of the present model and the next one
  HandedOn handedOn_ = HandedOn::no;                 // points are passed from session to session
  std::optional<WindowOptions> before_;              // of the model that was closed to free memory for the next one
  bool mapIsChanged_ = false;             // by strokes of sessions that gave it to this one; they are not saved
  std::string file_, saveFile_, saving_;  // shown to the user; target of Ctrl+S; being written
  struct {
    bool lost = false, silent = false;
  } saidOfFrames_;
  std::string saidOfSimulation_;

  std::vector<LeftStrokes> left_;           // pending questions, the first one is shown
  std::set<std::filesystem::path> putOff_;  // folders of strokes that are offered again at the next start
  bool othersWait_ = false;                 // to be offered once the restored strokes are saved
  bool asks_;
  std::string reading_;                                        // purpose of the read, as in leave()
  enum class Agreed { no, asked, yes } agreed_ = Agreed::yes;  // the user lets the next model replace this one
  std::string beforeWhat_;                                     // in the text of the question about changes
  std::function<void()> afterQuestion_;                        // called once that question is answered
  bool isSavingForIt_ = false;
  std::optional<SaveQuestion> saveQuestion_;  // pending
  std::optional<MemoryNeed> memoryQuestion_;
};

}  // namespace palpate
