// What is open in the window: how another model takes its place, where it is saved, and what a person is asked before
// something is lost.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/view/loader.hpp"
#include "apps/view/recent_files.hpp"
#include "apps/view/requests.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

class Messages;
class Window;

/// What a document lives among; all of it outlives it.
struct DocumentParts {
  Context& context;
  Window& window;
  Device& sight;
  const WindowSettings& settings;
  Messages& messages;
};

class Document {
 public:
  /// `asks`: about changes that are not saved, and how to save; a script does neither unless it says so.
  Document(const DocumentParts& parts, WindowOptions options, bool asks);

  /// Null: no model is open.
  WindowSession* session() const { return session_.get(); }
  /// Of models that were opened, and of those that were offered.
  const RecentFiles& recent() const { return recent_; }
  const std::vector<std::string>& offered() const { return offered_; }
  void offer(const std::vector<std::string>& files);

  /// Opens a file. A person who has changes is asked about them once it has been read, and is not where it cannot be.
  void open(const std::string& file);
  /// Opens what is open again, likewise, at another scale. Throws Error for what cannot come again.
  void openAtScale(double mm_per_unit);
  /// Does it now, or after the person was asked about changes that are lost with it. `what` it is follows "before".
  void leave(const std::string& what, std::function<void()> then);
  /// Once for each picture: goes on with what is being opened. `letGo` is called before what is open goes, which comes
  /// back where nothing can be opened in its place. Whether another model is open since, and not the same that is held
  /// or goes on.
  bool load(const std::function<void()>& letGo);
  const Loader& loader() const { return loader_; }
  /// The one that is open rests: another one is being built in its place.
  bool isGivingWay() const { return loader_.isRead() && agreed_ == Agreed::yes; }

  /// Once for each picture: what came of saving and recording, and of the frames of a camera.
  void follow();
  /// What of it concerns the model and its files. Throws what goes wrong.
  void carryOut(const ViewRequests& requests);
  void answer(const ViewRequests& requests);
  /// From then on that file is what is open.
  void saveTo(const std::string& file);
  /// Plays the hand of a session log.
  void play(const std::string& log);
  /// "MODEL<what>-1.<ending>" in the working folder, or the next number that is not there yet.
  std::string freeName(const std::string& what, const std::string& ending) const;

  void askFromNowOn();
  /// What is open is left on purpose: nothing of it is kept for the next program.
  void close();
  bool asksAboutChanges() const { return afterQuestion_ != nullptr && !isSavingForIt_; }
  /// What is about to happen, and what would be lost with it; empty where nothing is asked.
  std::string changesQuestion() const;
  const std::optional<SaveQuestion>& saveQuestion() const { return saveQuestion_; }
  /// Strokes of a program before, which has ended without having saved them.
  std::optional<LeftQuestion> leftQuestion() const;
  bool asks() const { return asksAboutChanges() || saveQuestion_ || leftQuestion(); }
  bool isLeaving() const { return afterQuestion_ != nullptr; }  ///< as soon as that is answered, or saved
  /// While something goes on that ends without the person.
  bool isBusy() const {
    return (loader_.isLoading() && agreed_ != Agreed::asked) || (isLeaving() && isSavingForIt_ && !saveQuestion_);
  }
  const std::string& saveFile() const { return saveFile_; }
  /// What the model is for the person: the file that it was opened from, or saved as last.
  const std::string& file() const { return file_; }

 private:
  // `what`: that it is read for, as leave() has it.
  void read(WindowOptions options, const std::string& what);
  void giveWay(const std::function<void()>& letGo);
  bool isLive() const { return opened_.config.stream && opened_.config.stream->live; }
  // Whether the points are those of a file, so that a file that they are saved in has all that there is.
  bool isOfFile() const;
  bool makeRoom();
  void park(const std::function<void()>& letGo);
  void unpark();
  // `file`: what it is for the person.
  void install(std::unique_ptr<WindowSession> session, const std::string& file);
  void findLeft();
  void goOnWith(LeftStrokes left);
  // Of a camera: frames are held or go on, and what is held is sculpted once there is a brush.
  void holdFrames();
  void restart();
  void sayWhatSimulationLacks();
  void sculptHeld();
  void letFramesGoOn();
  // To where Ctrl+S goes; asks first where a file would lose something.
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
  std::unique_ptr<WindowSession> session_, parked_;                   // while another one is being built
  WindowOptions opened_, opening_;                                    // that its file, and the next one, is opened with
  enum class HandedOn { no, held, toGoOn } handedOn_ = HandedOn::no;  // the points of the session before
  std::optional<WindowOptions> before_;  // of the model that has made room for the next one
  std::string file_, saveFile_;          // the model's own, or the one beside it
  struct {
    bool lost = false, silent = false;
  } saidOfFrames_;
  std::string saidOfSimulation_;

  std::vector<LeftStrokes> left_;  // which wait for an answer, the first one now
  bool asks_;
  std::string reading_;                                        // what for, as leave() has it
  enum class Agreed { no, asked, yes } agreed_ = Agreed::yes;  // that what is read takes the place of what is open
  std::string beforeWhat_;                                     // that is asked about
  std::function<void()> afterQuestion_;                        // waits for the answer about changes
  bool isSavingForIt_ = false;
  std::optional<SaveQuestion> saveQuestion_;  // waits for its answer
};

}  // namespace palpate
