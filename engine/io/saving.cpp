#include "engine/io/saving.hpp"
#include "engine/cloud/estimated_normals.hpp"

#include <algorithm>
#include <memory>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {

namespace {

constexpr std::string_view kOurs = "comment written by palpate";

// "1 face", "2 faces".
std::string inWords(const FileElement& element) {
  const bool plural = element.count != 1 && !element.name.ends_with('s');
  return fmt::format("{} {}{}", element.count, element.name, plural ? "s" : "");
}

std::string moreOf(const FileContents& contents) {
  std::string more;
  const auto add = [&](const std::string& what) { more += (more.empty() ? "" : ", ") + what; };
  for (const FileElement& element : contents.elements) {
    if (element.name != "vertex") {
      // Gaussians are kept by what was read from them, and are replaced by nothing else without a question.
      if (element.count > 0 && element.name != "Gaussian") add(inWords(element));
      continue;
    }
    for (const FileElement::Property& property : element.properties)
      if (property.isList) add(fmt::format("the list {} of each point", inQuotes(property.name)));
  }
  return more;
}

}  // namespace

std::string FileInTheWay::sentence() const {
  if (more.empty()) return name + " was not written by palpate";
  return fmt::format("{} has {}, which a sculpted cloud cannot keep", name, more);
}

FileInTheWay fileInTheWay(const std::filesystem::path& file, const CloudFormats& formats) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  FileInTheWay found{.name = file.filename().string()};
  try {
    const FileContents contents = contentsOf(file, formats);
    found.byPalpate = isOurs(contents.comments);
    found.more = moreOf(contents);
  } catch (const FileError&) {  // another kind of file
  }
  return found;
}

void sayWhatIsLost(const std::filesystem::path& file, Log& log) {
  const FileInTheWay inTheWay = fileInTheWay(file);
  if (inTheWay.name.empty()) return;
  log.say("{}; the existing file is kept as {}",
          inTheWay.losesSomething() ? inTheWay.sentence() : inTheWay.name + " exists",
          AtomicFile::nameToKeep(file).string());
}

std::filesystem::path* whereToKeep(const std::filesystem::path& file, std::filesystem::path& kept, Log& log) {
  FileInTheWay inTheWay = fileInTheWay(file);
  if (inTheWay.name.empty()) return nullptr;
  inTheWay.more.clear();  // ours, or kept in any case
  log.say("{}; it is kept as {}", inTheWay.losesSomething() ? inTheWay.sentence() : inTheWay.name + " exists",
          AtomicFile::nameToKeep(file).string());
  return &kept;
}

bool isOurs(std::span<const std::string> comments) { return std::ranges::find(comments, kOurs) != comments.end(); }

void markAsOurs(PointCloud& cloud) {
  auto& comments = cloud.storedAs.comments;
  if (!isOurs(comments)) comments.emplace_back(kOurs);
}

namespace {

// As `convert` reports it.
std::string notKept(const std::filesystem::path& file, const PointCloud& cloud, const CloudFormats& formats) {
  const std::vector<std::string> lost = lostOnTheWay(cloud, formats.toSave(file));
  return lost.empty() ? std::string() : fmt::format("not kept: {}", fmt::join(lost, ", "));
}

/// Whether it is a PLY or PCD file with its numbers in text.
bool isAscii(const std::filesystem::path& file) {
  const auto start = startOf(file);
  if (!start) return false;
  const std::string_view bytes = start->bytes, head = bytes.substr(0, bytes.find("end_header"));
  return start->startsWith("ply") ? head.find("\nformat ascii") != head.npos : bytes.find("\nDATA ascii") != bytes.npos;
}

}  // namespace

std::filesystem::path saveKeeping(const std::filesystem::path& file, PointCloud cloud, const SaveOptions& options) {
  OwnSave* const own = options.own;
  if (areNormalsEstimated(cloud)) cloud.normals.clear();
  markNormalsAsEstimated(cloud, false);
  if (options.notKept) *options.notKept = notKept(file, cloud, options.formats);
  markAsOurs(cloud);
  std::filesystem::path kept;
  std::error_code ignored;
  const bool isOwn =
      own && own->file == file && std::filesystem::last_write_time(file, ignored) == own->written && !ignored;
  writeCloud(file, cloud,
             {.ascii = isAscii(options.like.empty() ? file : options.like),
              .keptAs = fileInTheWay(file, options.formats).name.empty() ? nullptr : &kept},
             options.formats);
  if (!own) return kept;
  std::error_code failed;
  if (isOwn && !own->kept.empty() && !kept.empty()) std::filesystem::rename(kept, own->kept, failed);
  if (isOwn && !own->kept.empty() && !failed) kept = own->kept;
  *own = {.file = file,
          .written = std::filesystem::last_write_time(file, ignored),
          .kept = isOwn ? kept : std::filesystem::path()};
  return kept;
}

std::function<std::string(const PointCloud&)> saverTo(const std::string& file) {
  if (file.empty()) return {};
  return [file, own = std::make_shared<OwnSave>()](const PointCloud& points) {
    saveKeeping(file, points, {.own = own.get()});
    return file;
  };
}

std::filesystem::path whereToSave(const std::filesystem::path& file) {
  const CloudFormats& formats = cloudFormats();
  std::error_code isNone;
  const bool isFolder = std::filesystem::is_directory(file, isNone);
  if (isFolder) return nameBeside(file);
  const CloudFormat &to = formats.toSave(file), &from = formats.toRead(file);
  const bool isKept = &to == &from || (!to.family.empty() && to.family == from.name);
  return isKept ? file : nameBeside(file);
}

std::filesystem::path nameBeside(const std::filesystem::path& file) {
  // The cloud of a folder is saved to a file of the default format.
  std::error_code isNone;
  const bool folder = std::filesystem::is_directory(file, isNone);
  const std::filesystem::path whole = file.has_filename() ? file : file.parent_path();
  const std::string stem = (folder ? whole.filename() : whole.stem()).string();
  const std::string extension =
      folder ? std::string(cloudFormats().toSave("").endings.front()) : cloudFormats().endingToSave(whole);
  for (int number = 1;; ++number) {
    const std::string ending = number == 1 ? "-sculpted" : fmt::format("-sculpted-{}", number);
    std::filesystem::path name = whole;
    name.replace_filename(fmt::format("{}{}{}", stem, ending, extension));
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, ignored))) return name;
  }
}

}  // namespace palpate
