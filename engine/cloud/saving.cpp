#include "engine/cloud/saving.hpp"

#include <algorithm>

#include "engine/cloud/ply_header.hpp"
#include "engine/cloud/ply_writer.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr std::string_view kOurs = "comment written by palpate";

// "1 face", "2 faces".
std::string counted(const PlyElement& element) {
  const bool plural = element.count != 1 && !element.name.ends_with('s');
  return fmt::format("{} {}{}", element.count, element.name, plural ? "s" : "");
}

std::string moreOf(const PlyInfo& info) {
  std::string more;
  const auto add = [&](const std::string& what) { more += (more.empty() ? "" : ", ") + what; };
  for (const PlyElement& element : info.elements) {
    if (element.name != "vertex") {
      if (element.count > 0) add(counted(element));
      continue;
    }
    for (const PlyProperty& property : element.properties)
      if (property.isList) add(fmt::format("the list {} of each point", inQuotes(property.name)));
  }
  return more;
}

}  // namespace

std::string FileInTheWay::sentence() const {
  if (more.empty()) return name + " was not written by palpate";
  return fmt::format("{} has {}, which a sculpted cloud cannot keep", name, more);
}

FileInTheWay fileInTheWay(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  FileInTheWay found{.name = file.filename().string()};
  try {
    const PlyInfo info = readPlyInfo(file);
    found.byPalpate = std::ranges::find(info.comments, kOurs) != info.comments.end();
    found.more = moreOf(info);
  } catch (const FileError&) {  // it is something else
  }
  return found;
}

void sayWhatIsLost(const std::filesystem::path& file, Log& log) {
  const FileInTheWay inTheWay = fileInTheWay(file);
  if (!inTheWay.losesSomething()) return;
  log.say("{}; the file that is there is kept as {}", inTheWay.sentence(), AtomicFile::nameToKeep(file).string());
}

void markAsOurs(PointCloud& cloud) {
  auto& comments = cloud.storedAs.comments;
  if (std::ranges::find(comments, kOurs) == comments.end()) comments.emplace_back(kOurs);
}

std::filesystem::path saveKeeping(const std::filesystem::path& file, PointCloud cloud) {
  markAsOurs(cloud);
  std::filesystem::path kept;
  writePly(file, cloud, {.keptAs = fileInTheWay(file).losesSomething() ? &kept : nullptr});
  return kept;
}

std::filesystem::path nameBeside(const std::filesystem::path& file) {
  for (int number = 1;; ++number) {
    const std::string ending = number == 1 ? "-sculpted" : fmt::format("-sculpted-{}", number);
    std::filesystem::path name = file;
    name.replace_filename(file.stem().string() + ending + file.extension().string());
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, ignored))) return name;
  }
}

}  // namespace palpate
