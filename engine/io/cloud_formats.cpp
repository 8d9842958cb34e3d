#include "engine/io/cloud_formats.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/check.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/foreign_file.hpp"
#include "engine/io/known_formats.hpp"
#include "engine/io/ply_writer.hpp"

namespace palpate {

namespace {

/// The format for which `may` is true with the longest ending that matches the file's name; null: none.
const CloudFormat* named(std::span<const CloudFormat> formats, const std::filesystem::path& file, auto&& may) {
  std::string name = file.filename().string();
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const CloudFormat* found = nullptr;
  std::size_t longest = 0;
  for (const CloudFormat& format : formats)
    for (const std::string_view ending : format.endings)
      if (ending.size() > longest && name.size() > ending.size() && name.ends_with(ending) && may(format)) {
        found = &format;
        longest = ending.size();
      }
  return found;
}

bool holdsTriangles(const CloudFormat& format) { return format.ofTriangles || format.keepsTriangles; }
bool any(const CloudFormat&) { return true; }
bool isWritten(const CloudFormat& format, Written what) {
  if (!format.write || what == Written::copy) return format.write != nullptr;
  if (what == Written::mesh) return holdsTriangles(format);
  return !format.onlyCopied && !format.ofTriangles;
}
bool isSaved(const CloudFormat& format) { return format.write && !format.onlyCopied; }

const CloudFormat* holding(std::span<const CloudFormat> formats, const std::filesystem::path& path) {
  const auto holds = [&](const CloudFormat& format) { return format.holds && format.holds(path); };
  const auto found = std::ranges::find_if(formats, holds);
  return found == formats.end() ? nullptr : &*found;
}

std::string endingsOf(std::span<const CloudFormat> formats, auto&& does) {
  std::vector<std::string_view> endings;
  for (const CloudFormat& format : formats)
    if (does(format)) {
      endings.insert(endings.end(), format.endings.begin(), format.endings.end());
      if (!format.folder.empty()) endings.push_back(format.folder);
    }
  return fmt::format("{}", fmt::join(endings, ", "));
}

}  // namespace

CloudFormats::CloudFormats(std::span<const CloudFormat> formats) : formats_(formats) {
  PALPATE_CHECK(!formats.empty() && formats.front().read && formats.front().write);
}

const CloudFormat* CloudFormats::recognised(const std::filesystem::path& file) const {
  if (const CloudFormat* format = holding(formats_, file)) return format;
  // Formats with two dots in their ending are identified by content; a file without that content has the format of the
  // shorter ending.
  const auto mayBe = [](const CloudFormat& one) {
    return one.read && !(one.holds && one.endings.front().find('.', 1) != std::string_view::npos);
  };
  const CloudFormat* byName = named(formats_, file, mayBe);
  const auto start = startOf(file);
  if (!start || (byName && byName->begins && byName->begins(*start))) return byName;
  const auto begins = [&](const CloudFormat& format) { return format.begins && format.begins(*start); };
  const auto found = std::ranges::find_if(formats_, begins);
  return found == formats_.end() ? byName : &*found;
}

const CloudFormat& CloudFormats::toRead(const std::filesystem::path& file) const {
  const CloudFormat* format = recognised(file);
  return format ? *format : formats_.front();
}

const CloudFormat& CloudFormats::toWrite(const std::filesystem::path& file, Written what) const {
  const CloudFormat* format = named(formats_, file, any);
  if (format && isWritten(*format, what)) return *format;
  if (!format && isDeviceOrPipe(file)) return formats_.front();
  const std::string_view called = what == Written::mesh ? "meshes" : "clouds";
  const std::string rest =
      fmt::format("{} are written as {}; use one of these extensions", called, endingsWritten(what));
  if (!format) throw UsageError("{}: {}", file.string(), rest);
  if (!format->write) throw UsageError("{}: {} can be read but not written; {}", file.string(), format->name, rest);
  if (format->onlyCopied)
    throw UsageError("{}: only palpate convert can write {}; {}", file.string(), format->name, rest);
  if (what == Written::mesh)
    throw UsageError("{}: {} cannot hold the triangles of a mesh; {}", file.string(), format->name, rest);
  throw UsageError("{}: {} contains triangles, but these are points; {}", file.string(), format->name, rest);
}

const CloudFormat& CloudFormats::toSave(const std::filesystem::path& file, bool triangles) const {
  const CloudFormat* format = named(formats_, file, isSaved);
  return format && (triangles || !format->ofTriangles) ? *format : formats_.front();
}

std::string CloudFormats::endingToSave(const std::filesystem::path& file) const {
  if (named(formats_, file, isSaved) == &toSave(file)) return file.extension().string();
  return std::string(formats_.front().endings.front());
}

std::string CloudFormats::namesRead() const {
  std::vector<std::string_view> names;
  for (const CloudFormat& format : formats_)
    if (format.read) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string CloudFormats::endingsRead() const {
  return endingsOf(formats_, [](const CloudFormat& format) { return format.read != nullptr; });
}

std::string CloudFormats::endingsWritten(Written what) const {
  return endingsOf(formats_, [what](const CloudFormat& format) { return isWritten(format, what); });
}

const CloudFormats& cloudFormats() {
  static const std::array formats{
      plyFormat(),      lasFormat(),           lazFormat(),   copcFormat(), e57Format(),    pcdFormat(),
      npyFormat(),      npzFormat(),           xyzFormat(),   csvFormat(),  ptsFormat(),    ptxFormat(),
      objFormat(),      stlFormat(),           offFormat(),   gltfFormat(), colmapFormat(), colmapDenseFormat(),
      gaussianFormat(), compressedPlyFormat(), splatFormat(), spzFormat(),
  };
  static const CloudFormats table{formats};
  return table;
}

bool keepsBaggage(const CloudFormat& format, const PointCloud& cloud) {
  const auto& baggage = cloud.storedAs.baggage;
  return !baggage || baggage->format == (format.family.empty() ? format.name : format.family);
}

std::vector<std::string> lostOnTheWay(const PointCloud& cloud, const CloudFormat& to) {
  std::vector<std::string> lost = to.lacks ? to.lacks(cloud) : std::vector<std::string>();
  if (!keepsBaggage(to, cloud) && !cloud.storedAs.baggage->sentence.empty())
    lost.push_back(cloud.storedAs.baggage->sentence);
  return lost;
}

std::vector<std::string> lostOnTheWay(const StoredCloud& stored, const CloudFormat& to) {
  std::vector<std::string> lost = stored.lost;
  if (!stored.triangles.empty() && !holdsTriangles(to)) lost.push_back(counted(stored.triangles.size(), "triangle"));
  std::ranges::move(lostOnTheWay(stored.cloud, to), std::back_inserter(lost));
  return lost;
}

std::vector<std::string> keptOnTheWay(const StoredCloud& stored, const CloudFormat& to) {
  const PointCloud& cloud = stored.cloud;
  if (gaussiansOf(cloud) && keepsBaggage(to, cloud)) return {"all properties"};
  std::vector<std::string> names{"positions"};
  if (cloud.hasNormals() && to.keepsNormals) names.emplace_back("normals");
  if (cloud.hasColors() && to.keepsColors) names.emplace_back("colours");
  for (const Attribute* attribute : to.attributes ? to.attributes(cloud) : attributesBeside(cloud))
    names.push_back(attribute->name);
  if (!stored.triangles.empty() && holdsTriangles(to)) names.push_back(counted(stored.triangles.size(), "triangle"));
  return names;
}

namespace {

/// Throws FileError with a description for a file that no format reads.
const CloudFormat& readable(const std::filesystem::path& file, const CloudFormats& formats) {
  if (file == "-") throw FileError(file, "standard input cannot be read under this name; write it to a file");
  refuseForeign(file);
  const CloudFormat* format = formats.recognised(file);
  if (const auto start = startOf(file); start && start->size == 0)
    throw FileError(file, "is empty; it contains no points");
  std::error_code ignored;
  if (!format && std::filesystem::is_directory(file, ignored)) refuseFolder(file, formats);
  if (!format && isFile(file)) refuseUnknown(file, formats.namesRead());
  return formats.toRead(file);
}

}  // namespace

FileContents contentsOf(const std::filesystem::path& file, const CloudFormats& formats) {
  return readable(file, formats).contents(file);
}

StoredCloud readCloud(const std::filesystem::path& file, Log* log, const CloudReadOptions& options,
                      const CloudFormats& formats) {
  const CloudFormat& format = readable(file, formats);
  if (options.memory.exceeded)
    if (const auto need = exceedingNeed(file, format, options.memory.furtherPerPoint_bytes))
      options.memory.exceeded(*need);
  return format.read(file, log, options);
}

void writeCloud(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options,
                const CloudFormats& formats) {
  formats.toSave(file, options.triangles != nullptr).write(file, cloud, options);
}

}  // namespace palpate
