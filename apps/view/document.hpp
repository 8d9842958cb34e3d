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

  /// Null: no model is open.
  WindowSession* session() const { return session_.get(); }
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
  /// Called once per frame: advances the opening of a model. `letGo` is called before the present model is closed; that
  /// one returns if the next one fails to open. Returns whether another model is open now; the same model with its
  /// frames paused or resumed does not count.
  bool load(const std::function<void()>& letGo);
  const Loader& loader() const { return loader_; }
  /// Whether the present model is parked while another one is built in its place.
  bool isGivingWay() const { return loader_.isRead() && agreed_ == Agreed::yes; }

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
  /// Closes the model on purpose: no unsaved strokes are kept for the next program.
  void close();
  bool asksAboutChanges() const { return afterQuestion_ != nullptr && !isSavingForIt_; }
  /// Text of the question about unsaved changes; empty where no question is pending.
  std::string changesQuestion() const;
  const std::optional<SaveQuestion>& saveQuestion() const { return saveQuestion_; }
  /// The question about unsaved strokes of an earlier program.
  std::optional<LeftQuestion> leftQuestion() const;
  bool asks() const { return asksAboutChanges() || saveQuestion_ || leftQuestion(); }
  bool isLeaving() const { return afterQuestion_ != nullptr; }  ///< once the question is answered, or the model saved
  /// Whether a load or save is in progress that needs no answer.
  bool isBusy() const {
    return (loader_.isLoading() && agreed_ != Agreed::asked) || (isLeaving() && isSavingForIt_ && !saveQuestion_);
  }
  const std::string& saveFile() const { return saveFile_; }
  /// File name as shown to the user: the file that the model was opened from, or saved to last.
  const std::string& file() const { return file_; }

 private:
  // `what`: purpose of the read, as in leave().
  void read(WindowOptions options, const std::string& what);
  void giveWay(const std::function<void()>& letGo);
  bool isLive() const { return opened_.config.stream && opened_.config.stream->live; }
  // Whether the points are those of a file, so that a saved file can replace it as the document's file.
  bool isOfFile() const;
  bool makeRoom();
  void park(const std::function<void()>& letGo);
  void unpark();
  // `file`: name shown to the user.
  void install(std::unique_ptr<WindowSession> session, const std::string& file);
  void findLeft();
  void goOnWith(LeftStrokes left);
  // For a camera: pauses or resumes its frames; a paused frame is sculpted once a brush is chosen.
  void pause();
  void step();
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
  std::unique_ptr<WindowSession> session_, parked_;                   // parked while the next one is built
  WindowOptions opened_, opening_;                                    // options of the present model and the next one
  enum class HandedOn { no, held, toGoOn } handedOn_ = HandedOn::no;  // points are passed from session to session
  std::optional<WindowOptions> before_;  // of the model that was closed to free memory for the next one
  std::string file_, saveFile_;          // shown to the user; target of Ctrl+S
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
};

}  // namespace palpate
