#include "apps/view/document.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "apps/view/messages.hpp"
#include "apps/view/window.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/counted.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/io/saving.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

/// The model of that name. A joined session or a live camera is always the first model.
ModelConfig modelNamed(const std::string& file, const WindowOptions& options) {
  ModelConfig model = options.config.model;
  if (file == model.file) return model;
  model.file = file;
  model.join.reset();
  model.stream = isRgbdFolder(file) ? std::optional(options.stream) : std::nullopt;
  model.matter = model.stream ? SceneRef() : sceneNamed(file);
  return model;
}

/// Whether it is text with semicolons between columns, as programs in German write them; saved text has commas.
bool hasSemicolons(const std::string& file) {
  const auto start = startOf(file);
  return start && cloudFormats().toRead(file).isText &&
         start->bytes.substr(0, start->bytes.find('\n')).find(';') != std::string::npos;
}

std::string nameOf(const std::string& file) { return std::filesystem::path(file).filename().string(); }

// "Selection undone: 1204 points. Next, Ctrl+Z undoes: stroke, 312 points".
std::string inWords(const UndoneStrokes& strokes, std::string_view how) {
  const auto& [what, points] = strokes.last;
  std::string words = fmt::format("{} {}{}{}", what, how, points.empty() ? "" : ": ", points);
  words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  if (!strokes.next) return words + ". Nothing more can be undone";
  const auto& next = *strokes.next;
  return fmt::format("{}. Next, Ctrl+Z undoes: {}{}{}", words, next.what, next.points.empty() ? "" : ", ", next.points);
}

}  // namespace

Document::Document(const DocumentParts& parts, WindowOptions options, bool asks)
    : parts_(parts),
      options_(std::move(options)),
      messages_(parts.messages),
      loader_(parts.context, parts.sight),
      asks_(asks) {
  if (asks_) findLeft();
}

void Document::findLeft() {
  left_ = leftStrokes(options_.live.unsavedIn, [this](const std::string& what) { messages_.say(what); });
  std::erase_if(left_, [&](const LeftStrokes& left) { return putOff_.contains(left.folder->path()); });
  askFirstAbout(opening_.config.model.file);
}

// Strokes on the file that is being opened are asked about before all others.
void Document::askFirstAbout(const std::string& file) {
  std::stable_partition(left_.begin(), left_.end(), [&](const LeftStrokes& left) {
    std::error_code ignored;
    return left.document() == file || std::filesystem::equivalent(left.document(), file, ignored);
  });
}

std::optional<LeftQuestion> Document::leftQuestion() const {
  if (left_.empty() || loader_.isLoading()) return std::nullopt;
  return LeftQuestion{.file = left_.front().document(),
                      .strokes = left_.front().since,
                      .made = left_.front().made,
                      .waiting = left_.size() - 1};
}

// The other strokes are offered once these are saved, as only one model is open; until then any program can have them.
void Document::goOnWith(LeftStrokes left) {
  othersWait_ = left_.size() > 1;
  std::string others;
  if (othersWait_)
    others = counted(left_.size() - 1, "more set") +
             " of unsaved strokes: offered once these are saved, or at the next start";
  left_.clear();
  WindowOptions options = options_;
  options.config.model = left.model();
  const std::string what = "opening " + nameOf(left.document());
  const std::vector<std::string> lacks = left.lacks;
  options.live.left = std::make_shared<const LeftStrokes>(std::move(left));
  read(std::move(options), what);
  for (const std::string& lack : lacks) messages_.say(lack);
  if (!others.empty()) messages_.say(others);
}

void Document::askFromNowOn() {
  asks_ = true;
  findLeft();
}

void Document::close(bool keepsStrokes) {
  if (!session_) return;
  if (!keepsStrokes) session_->leaveStrokes();
  session_->endRecording();
}

void Document::offer(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    if (!std::ranges::count(offered_, file)) offered_.push_back(file);
}

void Document::open(const std::string& file) {
  WindowOptions options = options_;
  options.config.model = modelNamed(file, options_);
  askFirstAbout(file);
  read(std::move(options), "opening " + nameOf(file));
}

void Document::read(WindowOptions options, const std::string& what) {
  handedOn_ = HandedOn::no;
  agreed_ = Agreed::no;
  reading_ = what;
  afterQuestion_ = nullptr;
  memoryQuestion_.reset();
  opening_ = std::move(options);
  messages_.forget();
  loader_.open(opening_, parts_.settings.brush, parts_.settings.feel);
}

bool Document::isOfFile() const {
  const SessionConfig& config = opened_.config;
  return modelKindOf(config) == ModelKind::cloud && !isRosModel(config.model.file);
}

void Document::openAtScale(double mm_per_unit) {
  if (isLive()) throw Error("a live camera measures in metres; its scale is given with --mm-per-unit");
  WindowOptions options = opened_;
  options.config.model.file = file_;
  options.config.model.mm_per_unit = mm_per_unit;
  read(std::move(options), fmt::format("reopening it at {:.6g} mm per unit", mm_per_unit));
}

void Document::leave(const std::string& what, std::function<void()> then) {
  if (!isChanged() || !asks_) return then();
  saveQuestion_.reset();
  beforeWhat_ = what;
  afterQuestion_ = std::move(then);
  isSavingForIt_ = session_->isSaving();  // changes that this save does not contain are asked about afterwards
  if (parts_.window.isMinimised()) parts_.window.minimise(false);
}

Document::Opened Document::load(const std::function<void()>& rest, const std::function<void()>& letGo) {
  if (!loader_.isLoading()) return Opened::nothing;
  for (const std::string& remark : loader_.takeRemarks()) messages_.add(remark);
  if (loader_.isRead() && !loader_.isStopped()) giveWay(rest);
  auto result = loader_.take();
  if (!result) return Opened::nothing;
  if (!result->session) {
    endLoad(*result);
    return Opened::nothing;
  }
  const bool isAnother = handedOn_ == HandedOn::no;
  if (isAnother) opened_ = opening_;
  const auto left = std::exchange(opened_.live.left, nullptr);
  before_.reset();
  isAnother ? letGo() : rest();
  install(std::move(result->session), left ? left->document() : opened_.config.model.file);
  if (!isLive() && !opened_.config.model.join && !isRosModel(file_)) recent_.add(file_);
  return isAnother ? Opened::anotherModel : Opened::sameModel;
}

// No session came of the load: the present model returns.
void Document::endLoad(const Loader::Result& result) {
  if (result.lacksMemory && makeRoom()) return;
  if (result.need && asks_)
    memoryQuestion_ = result.need;
  else if (result.need)
    messages_.sayError(fmt::format("{}: {}; --force reads it nevertheless", loader_.file(), result.need->sentence()));
  if (!result.failure.empty()) {
    // Removed from the lists, unless it is the open model.
    if (!parked_ || parked_->file() != loader_.file()) {
      std::erase(offered_, loader_.file());
      recent_.forget(loader_.file());
    }
    messages_.sayError(result.failure);
  }
  if (loader_.isStopped()) messages_.say(nameOf(loader_.file()) + " was not opened: stopped");
  handedOn_ = HandedOn::no;
  unpark();
  if (before_) read(*std::exchange(before_, std::nullopt), reading_);
}

void Document::stopReading() {
  if (!isStoppable()) return;
  if (agreed_ == Agreed::asked) afterQuestion_ = nullptr;
  loader_.stop();
}

std::string Document::whyWaiting() const {
  return handedOn_ == HandedOn::no     ? nameOf(loader_.file()) + " is being opened"
         : handedOn_ == HandedOn::held ? "the paused frame is being prepared for the brush"
                                       : "the frames are about to continue";
}

// The next model has been read: closes the present one once the user agrees to lose its changes, or has saved them.
void Document::giveWay(const std::function<void()>& rest) {
  if (agreed_ == Agreed::no) {
    agreed_ = Agreed::asked;
    leave(reading_, [this] { agreed_ = Agreed::yes; });
  }
  if (agreed_ != Agreed::yes) return;
  if (session_) park(rest);
  loader_.build();
}

std::string Document::changesQuestion() const {
  if (!asksAboutChanges()) return {};
  return fmt::format("Before {}: {} has changes that are not saved. Without saving they are lost.", beforeWhat_,
                     nameOf(file_));
}

// If the memory does not suffice for two models, the parked one is closed first, and opened again if the next one still
// fails. A model with unsaved changes stays.
bool Document::makeRoom() {
  if (!parked_ || handedOn_ != HandedOn::no) return false;
  if (parked_->isChanged() || mapIsChanged_) {
    messages_.say("not enough memory for another model beside this one, which stays open: it has unsaved changes");
    return false;
  }
  before_ = opened_;
  before_->config.model.file = file_;
  parked_->leaveStrokes();
  parked_.reset();
  loader_.open(opening_, parts_.settings.brush, parts_.settings.feel);
  return true;
}

void Document::park(const std::function<void()>& rest) {
  rest();
  messages_.tryTo([&] { session_->pause(); });
  parked_ = std::move(session_);
}

void Document::unpark() {
  if (!parked_) return;
  session_ = std::move(parked_);
  session_->resume();
}

void Document::install(std::unique_ptr<WindowSession> session, const std::string& file) {
  if (session_) parked_ = std::move(session_);
  messages_.tryTo([&] {
    if (!parked_) return;
    parked_->leaveStrokes();
    parked_->endRecording();
  });
  parked_.reset();
  session_ = std::move(session);
  saveQuestion_.reset();
  saidOfFrames_ = {};
  saidOfSimulation_.clear();
  const HandedOn handedOn = std::exchange(handedOn_, HandedOn::no);
  if (handedOn == HandedOn::held) messages_.say("the paused frame can be sculpted; K continues the frames");
  if (handedOn == HandedOn::toGoOn) pause();
  if (handedOn != HandedOn::no) return;
  mapIsChanged_ = false;
  file_ = file;
  hadSemicolons_ = hasSemicolons(file);
  session_->setDocument(file_);
  saveFile_ = isLive() ? "camera.ply"
              : session_->config().model.matter || session_->config().model.join || isRosModel(file_)
                  ? std::filesystem::path(file_).stem().string() + ".ply"
                  : whereToSave(file_).string();
}

void Document::setDevice(const std::shared_ptr<TurnedDevice>& device, const HapticDeviceFacts& facts) {
  for (WindowOptions* each : {&options_, &opened_, &opening_, before_ ? &*before_ : &options_}) {
    each->live.device = device;
    each->live.deviceFacts = facts;
  }
  if (session_) session_->setDevice(device, facts);
}

void Document::follow() {
  if (const auto fault = session_->takeRecordingFault()) messages_.sayError(*fault);
  if (const auto fault = session_->takeUnsavedFault()) messages_.sayError(*fault);
  if (const auto saved = session_->takeSaved()) finishSaving(*saved);
  if (SharedFollower* const shared = session_->session().shared())
    for (const std::string& said : shared->takeSaid()) messages_.add(said);
  if (FarCloud* const far = session_->session().far())
    for (const std::string& said : far->takeSaid()) messages_.add(said);
  sayWhatFramesLack();
  sayWhatSimulationLacks();
  messages_.tryTo([&] { sculptHeld(); });
}

void Document::finishSaving(const WindowSession::Saved& saved) {
  saving_.clear();
  const std::string kept = saved.kept.empty() ? "" : "; the old file is kept as " + saved.kept;
  if (saved.failure.empty()) {
    mapIsChanged_ = false;
    const bool isOther = hadSemicolons_ && std::filesystem::path(saved.file).extension() == ".csv";
    messages_.say(saved.file + " is saved" + (isOther ? ", with decimal points and commas between columns" : "") +
                  (saved.remark.empty() ? "" : ": " + saved.remark) + kept);
    becomeFile(saved.file);
    if (std::exchange(othersWait_, false)) findLeft();
  } else {
    messages_.sayError(saved.failure);
  }
  // Where the points have changed since, or could not be written, the question stays.
  if (!std::exchange(isSavingForIt_, false) || (saved.failure.empty() && isChanged())) return;
  const auto then = std::exchange(afterQuestion_, nullptr);
  if (saved.failure.empty() && then) then();
}

// A snapshot of a camera, a simulation or a shared session is saved to `file` from now on; the document stays the same.
void Document::becomeFile(const std::string& file) {
  saveFile_ = file;
  if (!isOfFile()) return;
  file_ = opened_.config.model.file = file;
  session_->setDocument(file);
  recent_.add(file);
}

void Document::saveTo(const std::string& file) {
  // A file of the same format keeps its name, whatever that is; a new name says the format.
  const std::filesystem::path path = file;
  std::error_code ignored;
  const bool isSameFormat = std::filesystem::exists(path, ignored) && whereToSave(path) == path;
  if (!isSameFormat && path.has_extension()) cloudFormats().toWrite(path, Written::points);
  session_->save(file);
  saving_ = file;
}

void Document::save() {
  if (session_->isSaving()) return saveTo(saveFile_);  // throws: a save is in progress
  std::error_code ignored;
  if (isOfFile() && !isChanged() && std::filesystem::exists(saveFile_, ignored))
    return messages_.say(saveFile_ + " already contains these points; there is nothing to save");
  const FileInTheWay inTheWay = fileInTheWay(saveFile_);
  if (!inTheWay.losesSomething()) return saveTo(saveFile_);
  saveQuestion_ = SaveQuestion{.loses = inTheWay.sentence(),
                               .beside = nameBeside(saveFile_).string(),
                               .kept = AtomicFile::nameToKeep(saveFile_).string()};
  if (!asks_) return answer(Answer::saveBeside);
  if (parts_.window.isMinimised()) parts_.window.minimise(false);
}

void Document::answer(Answer answer) {
  const bool isOfLeft = answer == Answer::goOnWithLeft || answer == Answer::discardLeft || answer == Answer::keepLeft;
  if (isOfLeft && !left_.empty()) {
    if (answer == Answer::goOnWithLeft) return goOnWith(std::move(left_.front()));
    if (answer == Answer::discardLeft) left_.front().folder->remove();
    if (answer == Answer::keepLeft) putOff_.insert(left_.front().folder->path());
    left_.erase(left_.begin());
  }
  if (answer == Answer::discard && afterQuestion_) std::exchange(afterQuestion_, nullptr)();
  if (answer == Answer::cancel) {
    afterQuestion_ = nullptr;
    saveQuestion_.reset();
    isSavingForIt_ = false;
    memoryQuestion_.reset();
    if (agreed_ == Agreed::asked) stopReading();
  }
  if (answer == Answer::readAnyway && memoryQuestion_) {
    WindowOptions options = opening_;
    options.exceedsMemory = true;
    read(std::move(options), reading_);
  }
  if (answer == Answer::saveFirst && session_) {
    isSavingForIt_ = true;
    if (!session_->isSaving()) save();
  }
  if ((answer == Answer::saveBeside || answer == Answer::saveOver) && saveQuestion_ && session_) {
    if (answer == Answer::saveBeside) saveFile_ = saveQuestion_->beside;
    saveQuestion_.reset();
    saveTo(saveFile_);
  }
}

void Document::carryOut(ModelCommand command) {
  if (isGivingWay()) return messages_.say(whyWaiting());
  if (!session_) return;
  if (command == ModelCommand::undo) undo();
  if (command == ModelCommand::redo && session_->redo()) messages_.sayNow(inWords(session_->undone(), "redone"));
  if (command == ModelCommand::save) save();
  if (command == ModelCommand::exportTicks) writeTicks();
  if (command == ModelCommand::endRecording) session_->endRecording();
  if (command == ModelCommand::endPlaying) session_->endPlaying();
  if (command == ModelCommand::restart) restart();
  if (command == ModelCommand::pause) pause();
  if (command == ModelCommand::step) step();
}

void Document::undo() {
  if (session_->undo()) return messages_.sayNow(inWords(session_->undone(), "undone"));
  messages_.sayNow(session_->session().strokes().dropped > 0
                       ? "nothing more can be undone: --undo-memory holds no further stroke"
                       : "nothing more can be undone");
}

void Document::record(const std::string& log) {
  const std::filesystem::path kept = session_->record(log);
  messages_.say("recording to " + log + (kept.empty() ? "" : "; the old log is kept as " + kept.string()));
}

void Document::play(const std::string& log) {
  for (const std::string& sentence : session_->play(log)) messages_.say(fmt::format("{}: {}", log, sentence));
}

std::string Document::freeName(const std::string& what, const std::string& ending) const {
  const std::string stem = session_ ? std::filesystem::path(file_).stem().string() : std::string("palpate");
  const std::filesystem::path folder = std::filesystem::current_path();
  for (int number = 1;; ++number) {
    const std::filesystem::path file = folder / fmt::format("{}{}-{}.{}", stem, what, number, ending);
    if (!std::filesystem::exists(file)) return file.string();
  }
}

void Document::writeTicks() {
  const auto& rows = session_->recentTicks().rows();
  const Trace trace{.rows = {rows.begin(), rows.end()}, .virtualTime = false};
  const std::string file = freeName("-ticks", "csv");
  writeTraceCsv(file, trace);
  messages_.say(fmt::format("{} ticks are in {}", rows.size(), file));
}

}  // namespace palpate
