#include "engine/cloud/cloud_format.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "engine/cloud/ply_faces.hpp"
#include "engine/cloud/ply_reader.hpp"
#include "engine/cloud/ply_writer.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

// What of an element is not carried: its other properties where its triangles are, all of it elsewhere.
void nameLostOf(const PlyElement& element, std::vector<std::string>& lost) {
  if (element.count == 0) return;
  const bool vertex = element.name == "vertex";
  const PlyProperty* indices = PlyFaces::indexList(element);
  if (!vertex && !indices) lost.push_back(fmt::format("{} {}", element.count, element.name));
  for (const PlyProperty& property : element.properties)
    if (&property != indices && (vertex ? property.isList : indices != nullptr))
      lost.push_back(fmt::format("property '{}' of {}", property.name, element.name));
}

std::vector<std::string> lostByReading(const PlyInfo& info, const StoredCloud& stored) {
  std::vector<std::string> lost;
  std::uint64_t faces = 0;
  for (const PlyElement& element : info.elements) {
    nameLostOf(element, lost);
    if (PlyFaces::indexList(element)) faces += element.count;
  }
  if (faces != stored.triangles.size())
    lost.push_back(fmt::format("the outlines of {} faces, which become {} triangles", faces, stored.triangles.size()));
  const StoredAs& as = stored.cloud.storedAs;
  if (stored.cloud.hasColors() && as.color != ScalarType::u8) lost.emplace_back("colours finer than 8 bits a channel");
  if (stored.cloud.hasNormals() && as.normal == ScalarType::f64)
    lost.emplace_back("normals finer than single precision");
  return lost;
}

StoredCloud readPlyFile(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  StoredCloud stored;
  PlyInfo info;
  stored.cloud =
      readPly(file, log, {.normalsFromFaces = options.normalsFromFaces, .triangles = &stored.triangles, .info = &info});
  stored.lost = lostByReading(info, stored);
  return stored;
}

void writePlyFile(const std::filesystem::path& file, const StoredCloud& stored, const CloudWriteOptions& options) {
  writePly(file, stored.cloud,
           {.ascii = options.ascii,
            .triangles = stored.triangles.empty() ? nullptr : &stored.triangles,
            .keptAs = options.keptAs});
}

std::vector<std::string> lacksOfPly(const StoredCloud& stored) {
  std::vector<std::string> lost;
  for (const std::string& name : namesGivingWay(stored.cloud))
    lost.push_back(fmt::format("property '{}' of vertex, for the one that is written under its name", name));
  return lost;
}

constexpr std::array kFormats{CloudFormat{"PLY", ".ply", readPlyFile, writePlyFile, lacksOfPly}};

const CloudFormat* named(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto found = std::ranges::find(kFormats, ending, &CloudFormat::ending);
  return found == kFormats.end() ? nullptr : &*found;
}

}  // namespace

std::span<const CloudFormat> cloudFormats() { return kFormats; }

const CloudFormat& formatToRead(const std::filesystem::path& file) {
  const CloudFormat* format = named(file);
  return format && format->read ? *format : kFormats.front();
}

const CloudFormat& formatToWrite(const std::filesystem::path& file) {
  const CloudFormat* format = named(file);
  if (format && format->write) return *format;
  std::vector<std::string_view> endings;
  for (const CloudFormat& known : kFormats)
    if (known.write) endings.push_back(known.ending);
  throw UsageError("{}: clouds are written as {}; name it so", file.string(), fmt::join(endings, ", "));
}

}  // namespace palpate
