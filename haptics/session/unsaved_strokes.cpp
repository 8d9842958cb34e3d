#include "haptics/session/unsaved_strokes.hpp"

#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/edit/layer_attributes.hpp"
#include "haptics/pending_edits.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

namespace {

constexpr double kBetweenWrites_s = 0.1;
// Limit of a log's growth: a log with more states than kMaxStates and than kMaxClouds times the cloud is replaced by a
// new one that begins with the present points.
constexpr std::uint64_t kMaxStates = 1 << 24, kMaxClouds = 4;

}  // namespace

StrokeFolder::StrokeFolder(const std::filesystem::path& root) {
  std::error_code failed;
  std::filesystem::create_directories(root, failed);
  if (failed) throw FileError(root, "cannot be made: " + failed.message());
  for (int number = 1;; ++number) {
    path_ = root / fmt::format("{}-{}", processNumber(), number);
    const bool isNew = std::filesystem::create_directory(path_, failed);
    if (failed) throw FileError(path_, "cannot be made: " + failed.message());
    if (isNew && lock_.take(path_ / "lock")) return;
    constexpr int kMax = 1000;
    if (number == kMax) throw FileError(path_, "cannot be locked");
  }
}

UnsavedStrokes::~UnsavedStrokes() {
  try {
    if (making_.valid()) writer_ = making_.get();
    if (writer_) writePending();
    writer_.reset();
  } catch (...) {  // the log keeps what was written before
  }
}

StrokeFolder& UnsavedStrokes::folder() {
  const std::scoped_lock hold(folderLock_);
  if (!folder_) folder_ = std::make_shared<StrokeFolder>(root_);
  return *folder_;
}

void UnsavedStrokes::fail(const std::string& what) {
  failed_ = true;
  const std::scoped_lock hold(faultLock_);
  fault_ = "unsaved strokes are no longer kept on disk, and would be lost if this program ended: " + what;
}

std::optional<std::string> UnsavedStrokes::takeFault() {
  const std::scoped_lock hold(faultLock_);
  return std::exchange(fault_, std::nullopt);
}

void UnsavedStrokes::adopt(const LeftStrokes& left) {
  folder_ = left.folder;
  const std::vector<unsigned> logs = folder_->logs();
  number_ = logs.empty() ? 0 : logs.back();
  session_.document = left.document();
  session_.config.model.file = left.session.config.model.file;
  since_ = left.since;
  begin(left.edits);
}

// The last log is removed only when the new one contains all of it.
void UnsavedStrokes::begin(EditBatch initial) {
  ++number_;
  failed_ = false;
  pending_.clear();
  states_ = initial.points.size();
  making_ = std::async(std::launch::async, [this, number = number_, session = session_, initial = std::move(initial),
                                            last = std::move(writer_)]() mutable {
    session.points = model_.cloud.size();
    session.checksum = checksumOf(model_);
    auto writer = std::make_unique<SessionWriter>(folder().log(number), headerText(session),
                                                  [this](const std::string& what) { fail(what); });
    writer->add(initial);
    writer->flush();
    last.reset();
    if (!failed_) folder().removeLogs(number);
    return writer;
  });
}

void UnsavedStrokes::takeMade() {
  if (!making_.valid() || making_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    writer_ = making_.get();
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void UnsavedStrokes::writePending() {
  mergeEdits(pending_);
  states_ += pending_.points.size();
  writer_->add(pending_);
  pending_.clear();
  sinceWritten_ = Stopwatch();
}

// The masks and fields as undone changes, which cannot be undone again.
EditBatch UnsavedStrokes::snapshot(const PointStates& points, const LayerAttributes& attributes) const {
  const std::vector<PointState> before = statesOf(model_.cloud);
  EditBatch all;
  for (const PointState& state : points)
    if (state.number >= before.size() || !(before[state.number] == state)) all.points.push_back(state);
  all.marks.push_back({all.points.size(), EditMark::Kind::change});
  all.attributes = attributes.all();
  all.marks.resize(1 + all.attributes.size(), {all.points.size(), EditMark::Kind::undone});
  return all;
}

void UnsavedStrokes::saved(const PointStates& points, const LayerAttributes& attributes) {
  failed_ = false;
  if (!isKept()) return;
  if (making_.valid()) making_.wait();
  takeMade();
  writer_.reset();
  pending_.clear();
  saved_ = snapshot(points, attributes);
  folder().removeLogs(number_ + 1);
}

// The note is cleared before new changes are written, and set only after undone ones are written.
void UnsavedStrokes::noteUnchanged(bool on) {
  if (std::exchange(unchanged_, on) != on) folder().setUnchanged(on);
}

void UnsavedStrokes::follow(const EditBatch& fresh, const PointStates& points, const LayerAttributes& attributes,
                            bool isChanged, const StrokesSince& since) {
  takeMade();
  if (isChanged) noteUnchanged(false);
  if (isChanged && !failed_ && since_ != since) folder().setSince(since_ = since);
  if (!isKept()) {
    if ((fresh.empty() && !attributes.hasMasks()) || failed_) return;  // masks are in no saved file
    EditBatch initial = fresh.empty() ? snapshot(points, attributes) : saved_.value_or(EditBatch());
    append(initial, fresh);  // it may be the begin of a stroke, which is undone as a whole
    saved_.reset();
    return begin(std::move(initial));
  }
  append(pending_, fresh);
  if (writer_ && pending_.empty() && !isChanged) noteUnchanged(true);
  if (!writer_ || pending_.empty() || sinceWritten_.elapsed_s() < kBetweenWrites_s) return;
  const bool isInStroke = pending_.marks.empty() || pending_.marks.back().at < pending_.points.size();
  if (!isInStroke && states_ > std::max(kMaxStates, kMaxClouds * model_.cloud.size()))
    return begin(snapshot(points, attributes));
  writePending();
}

void UnsavedStrokes::keepModel() {
  try {
    folder().keepModel(session_.config.model.file);
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void UnsavedStrokes::remove() {
  if (making_.valid()) making_.wait();
  making_ = {};
  writer_.reset();
  pending_.clear();
  const std::scoped_lock hold(folderLock_);
  if (folder_) folder_->remove();
  folder_.reset();
  saved_.reset();
  unchanged_ = false;
  since_ = {};
}

}  // namespace palpate
