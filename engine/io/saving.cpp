#include "engine/io/saving.hpp"
#include "engine/cloud/estimated_normals.hpp"

#include <algorithm>

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
      if (element.count > 0) add(inWords(element));
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

namespace {

bool isReplaceable(const std::filesystem::path& file, const CloudFormats& formats) {
  return !file.empty() && !fileInTheWay(file, formats).losesSomething();
}

/// The first of the names of kept files, up to `last`, that is a cloud of palpate; `last` if there is none.
std::filesystem::path firstOurs(const std::filesystem::path& last, const CloudFormats& formats) {
  const std::string text = last.string();
  const std::string base = text.substr(0, text.rfind(".bak")) + ".bak";
  std::error_code ignored;
  for (int number = 1;; ++number) {
    const std::filesystem::path name = number == 1 ? base : fmt::format("{}{}", base, number);
    if (name == last || !std::filesystem::exists(name, ignored) || isReplaceable(name, formats)) return name;
  }
}

std::filesystem::path nameToKeep(const std::filesystem::path& file) {
  const std::filesystem::path name = AtomicFile::nameToKeep(file);
  return isReplaceable(file, cloudFormats()) ? firstOurs(name, cloudFormats()) : name;
}

}  // namespace

void sayWhatIsLost(const std::filesystem::path& file, Log& log) {
  const FileInTheWay inTheWay = fileInTheWay(file);
  if (inTheWay.name.empty()) return;
  log.say("{}; the existing file is kept as {}",
          inTheWay.losesSomething() ? inTheWay.sentence() : inTheWay.name + " exists", nameToKeep(file).string());
}

std::filesystem::path* whereToKeep(const std::filesystem::path& file, std::filesystem::path& kept, Log& log) {
  FileInTheWay inTheWay = fileInTheWay(file);
  if (inTheWay.name.empty()) return nullptr;
  inTheWay.more.clear();  // ours, or kept in any case
  log.say("{}; it is kept as {}", inTheWay.losesSomething() ? inTheWay.sentence() : inTheWay.name + " exists",
          nameToKeep(file).string());
  return &kept;
}

std::filesystem::path keepNewest(const std::filesystem::path& kept, const CloudFormats& formats) {
  if (kept.empty() || !isReplaceable(kept, formats)) return kept;
  std::filesystem::path name = firstOurs(kept, formats);
  std::error_code error;
  if (name != kept) std::filesystem::rename(kept, name, error);
  return error ? kept : name;
}

bool isOurs(std::span<const std::string> comments) { return std::ranges::find(comments, kOurs) != comments.end(); }

void markAsOurs(PointCloud& cloud) {
  auto& comments = cloud.storedAs.comments;
  if (!isOurs(comments)) comments.emplace_back(kOurs);
}

std::filesystem::path saveKeeping(const std::filesystem::path& file, PointCloud cloud, const CloudFormats& formats) {
  markAsOurs(cloud);
  if (areNormalsEstimated(cloud)) cloud.normals.clear();
  markNormalsAsEstimated(cloud, false);
  std::filesystem::path kept;
  writeCloud(file, cloud, {.keptAs = fileInTheWay(file, formats).name.empty() ? nullptr : &kept}, formats);
  return keepNewest(kept, formats);
}

std::filesystem::path whereToSave(const std::filesystem::path& file) {
  const CloudFormat& format = cloudFormats().toRead(file);
  std::error_code isNone;
  const bool isFolder = std::filesystem::is_directory(file, isNone);
  return !isFolder && format.write && !format.ofTriangles && !format.onlyCopied ? file : nameBeside(file);
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
