// The part of unsaved strokes that the next program needs: finds the strokes.
#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

#include "engine/core/error.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/recorded_edits.hpp"
#include "haptics/session/unsaved_strokes.hpp"

namespace palpate {

namespace {

constexpr std::string_view kLog = "strokes-", kEnding = ".log", kKept = "model", kUnchanged = "unchanged",
                           kSince = "since", kDamaged = ".damaged";

// The number in the name of a log; 0 for other files.
unsigned logNumberOf(const std::string& name) {
  if (!name.starts_with(kLog) || !name.ends_with(kEnding)) return 0;
  unsigned number = 0;
  const char* const end = name.data() + name.size() - kEnding.size();
  const auto [last, error] = std::from_chars(name.data() + kLog.size(), end, number);
  return error == std::errc() && last == end ? number : 0;
}

// A log whose content a power cut has left off: its blocks were never written.
bool isBlank(const std::filesystem::path& log) {
  std::ifstream in(log, std::ios::binary);
  return std::all_of(std::istreambuf_iterator<char>(in), {}, [](char byte) { return byte == 0; });
}

LeftStrokes readFolder(std::shared_ptr<StrokeFolder> folder) {
  LeftStrokes left;
  std::filesystem::path log;
  std::size_t most = 0;
  SessionRecord best;
  // The last log, unless the program ended before that log contained all of the log before it.
  std::optional<FileError> failure;
  for (const unsigned number : folder->logs()) {
    SessionRecord record;
    try {
      if (isBlank(folder->log(number))) continue;
      record = readLoggedEdits(folder->log(number));
    } catch (const FileError& error) {
      if (!failure) failure = error;
      continue;
    }
    const std::size_t edits = record.edits.points.size() + record.edits.attributes.size();
    if (!log.empty() && edits < most) continue;
    most = edits;
    log = folder->log(number);
    best = std::move(record);
  }
  if (log.empty() && failure) throw *failure;
  if (log.empty()) {
    left.folder = std::move(folder);
    return left;
  }
  left.session = parseHeader(log, best.text);
  requireEditsOf(log, left.session.points, best);
  best.end.emplace();  // a missing end is expected and not reported
  left.lacks = whatIsMissing(best);
  left.edits = std::move(best.edits);
  const std::vector<EditMark>& marks = left.edits.marks;
  const bool isUnderWay = left.edits.points.size() > (marks.empty() ? 0 : marks.back().at);
  const auto isMade = [](const EditMark& mark) {
    return mark.kind == EditMark::Kind::stroke || mark.kind == EditMark::Kind::attribute;
  };
  left.since =
      folder->since().value_or(StrokesSince{.made = static_cast<std::size_t>(std::ranges::count_if(marks, isMade))});
  left.since.made += isUnderWay;
  std::error_code ignored;
  left.made = std::filesystem::last_write_time(log, ignored);
  left.folder = std::move(folder);
  return left;
}

}  // namespace

std::unique_ptr<StrokeFolder> StrokeFolder::open(const std::filesystem::path& folder) {
  std::unique_ptr<StrokeFolder> opened(new StrokeFolder);
  opened->path_ = folder;
  // A folder without a lock file is still being made.
  const std::filesystem::path lock = folder / "lock";
  std::error_code ignored;
  if (!std::filesystem::exists(lock, ignored) || !opened->lock_.take(lock)) return nullptr;
  return opened;
}

std::filesystem::path StrokeFolder::log(unsigned number) const {
  return path_ / fmt::format("{}{}{}", kLog, number, kEnding);
}

std::vector<unsigned> StrokeFolder::logs() const {
  std::vector<unsigned> numbers;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(path_, ignored))
    if (const unsigned number = logNumberOf(entry.path().filename().string())) numbers.push_back(number);
  std::ranges::sort(numbers);
  return numbers;
}

void StrokeFolder::removeLogs(unsigned before) {
  std::error_code ignored;
  for (const unsigned number : logs())
    if (number < before) std::filesystem::remove(log(number), ignored);
}

std::filesystem::path StrokeFolder::keptModel() const {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(path_, ignored))
    if (entry.path().stem() == kKept) return entry.path();
  return {};
}

bool StrokeFolder::isUnchanged() const {
  std::error_code ignored;
  return std::filesystem::exists(path_ / kUnchanged, ignored);
}

void StrokeFolder::setUnchanged(bool on) {
  std::error_code ignored;
  if (on)
    std::ofstream(path_ / kUnchanged).flush();
  else
    std::filesystem::remove(path_ / kUnchanged, ignored);
}

std::optional<StrokesSince> StrokeFolder::since() const {
  StrokesSince since;
  std::ifstream in(path_ / kSince);
  return in >> since.made >> since.undone ? std::optional(since) : std::nullopt;
}

void StrokeFolder::setSince(const StrokesSince& since) {
  const std::filesystem::path part = path_ / (std::string(kSince) + ".part");
  std::ofstream(part) << since.made << ' ' << since.undone << '\n';
  replaceFile(part, path_ / kSince);
}

void StrokeFolder::keepModel(const std::filesystem::path& file) {
  if (!keptModel().empty()) return;
  const std::filesystem::path kept = path_ / (std::string(kKept) + file.extension().string());
  std::error_code failed;
  std::filesystem::create_hard_link(file, kept, failed);
  if (!failed) return;
  const std::filesystem::path part = path_ / "part";
  std::filesystem::copy_file(file, part, std::filesystem::copy_options::overwrite_existing, failed);
  if (!failed) failed = replaceFile(part, kept);
  if (!failed) return;
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  throw FileError(kept, "cannot be written: " + failed.message());
}

void StrokeFolder::remove() {
  std::error_code ignored;
  for (const unsigned number : logs()) std::filesystem::remove(log(number), ignored);
  lock_.release();
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path StrokeFolder::putAside() {
  lock_.release();
  std::error_code failed;
  std::filesystem::path aside = path_.string() + std::string(kDamaged);
  for (int number = 2; std::filesystem::exists(aside, failed); ++number)
    aside = fmt::format("{}{}{}", path_.string(), kDamaged, number);
  std::filesystem::rename(path_, aside, failed);
  return failed ? path_ : aside;
}

const std::string& LeftStrokes::document() const {
  return session.document.empty() ? session.config.model.file : session.document;
}

ModelConfig LeftStrokes::model() const {
  ModelConfig model = session.config.model;
  if (const std::filesystem::path kept = folder->keptModel(); !kept.empty()) model.file = kept.string();
  return model;
}

void LeftStrokes::requireModel(const Model& model) const {
  if (model.cloud.size() != session.points || checksumOf(model) != session.checksum)
    throw FileError(session.config.model.file,
                    "has changed since its unsaved strokes were made; they are kept, and offered again: restore the "
                    "original file");
}

std::vector<LeftStrokes> leftStrokes(const std::filesystem::path& root,
                                     const std::function<void(const std::string&)>& say) {
  std::vector<LeftStrokes> all;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(root, ignored)) {
    if (entry.path().extension().string().starts_with(kDamaged)) continue;
    const std::shared_ptr<StrokeFolder> folder = StrokeFolder::open(entry.path());
    if (!folder) continue;
    if (folder->logs().empty() || folder->isUnchanged()) {
      folder->remove();
      continue;
    }
    try {
      LeftStrokes left = readFolder(folder);
      if (!left.edits.points.empty() || !left.edits.attributes.empty() || left.since.undone > 0)
        all.push_back(std::move(left));
      else if (left.lacks.empty())
        left.folder->remove();
    } catch (const std::exception& error) {
      say(fmt::format("unsaved strokes cannot be read, and are kept in {}: {}", folder->putAside().string(),
                      error.what()));
    }
  }
  std::ranges::sort(all, std::ranges::greater(), &LeftStrokes::made);
  return all;
}

}  // namespace palpate
