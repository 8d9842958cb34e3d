#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <pugixml.hpp>

#include "engine/core/error.hpp"
#include "engine/io/e57_scans.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {

namespace {

/// Reads numbers of the document, and names invalid ones.
class Reading {
 public:
  explicit Reading(const std::filesystem::path& file) : file_(file) {}

  FileError refuse(const std::string& what) const { return FileError(file_, "in its XML: " + what); }

  /// An empty text is 0, as the standard defines.
  template <class T>
  T number(std::string_view text, const std::string& of) const {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\n' || text.front() == '\t'))
      text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\n' || text.back() == '\t')) text.remove_suffix(1);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    T value{};
    if (text.empty()) return value;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      throw refuse(fmt::format("{} is {}; expected a number", of, inQuotes(text)));
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) throw refuse(fmt::format("{} is {}", of, inQuotes(text)));
    return value;
  }
  template <class T>
  T attribute(const pugi::xml_node& node, const char* name, T otherwise) const {
    const pugi::xml_attribute found = node.attribute(name);
    return found ? number<T>(found.value(), fmt::format("{} of {}", name, node.name())) : otherwise;
  }
  double child(const pugi::xml_node& node, const char* name) const {
    return number<double>(node.child_value(name), fmt::format("{} of {}", name, node.name()));
  }

 private:
  const std::filesystem::path& file_;
};

E57Field fieldOf(const pugi::xml_node& node, const Reading& reading) {
  using Kind = E57Field::Kind;
  E57Field field{.name = node.name()};
  const std::string_view type = node.attribute("type").value();
  if (type == "Integer" || type == "ScaledInteger") {
    field.kind = type == "Integer" ? Kind::integer : Kind::scaled;
    field.least = reading.attribute(node, "minimum", std::numeric_limits<std::int64_t>::min());
    field.most = reading.attribute(node, "maximum", std::numeric_limits<std::int64_t>::max());
    if (field.least > field.most)
      throw reading.refuse(fmt::format("{} is from {} to {}", field.name, field.least, field.most));
    field.scale = reading.attribute(node, "scale", 1.0);
    field.offset = reading.attribute(node, "offset", 0.0);
  } else if (type == "Float") {
    field.kind = std::string_view(node.attribute("precision").value()) == "single" ? Kind::single : Kind::real;
  } else if (type == "String") {
    field.kind = Kind::text;
  } else {
    throw reading.refuse(fmt::format("{} has the type {}; expected a type of numbers", field.name, inQuotes(type)));
  }
  return field;
}

void readPose(const pugi::xml_node& pose, const Reading& reading, E57Scan& scan) {
  const pugi::xml_node rotation = pose.child("rotation"), translation = pose.child("translation");
  if (translation)
    scan.translation = {reading.child(translation, "x"), reading.child(translation, "y"),
                        reading.child(translation, "z")};
  if (!rotation) return;
  constexpr std::array<const char*, 4> kNames{"w", "x", "y", "z"};
  double squared = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    scan.rotation[k] = reading.child(rotation, kNames[k]);
    squared += scan.rotation[k] * scan.rotation[k];
  }
  if (!(squared > 1e-12 && squared < 1e12))
    throw reading.refuse(fmt::format("the rotation of scan {} has no direction", inQuotes(scan.name)));
  scan.rotationLength = std::sqrt(squared);
  for (double& part : scan.rotation) part /= scan.rotationLength;
}

E57Scan scanOf(const pugi::xml_node& node, const Reading& reading) {
  E57Scan scan{.name = node.child_value("name")};
  const pugi::xml_node points = node.child("points");
  if (std::string_view(points.attribute("type").value()) != "CompressedVector")
    throw reading.refuse(fmt::format("scan {} has no points", inQuotes(scan.name)));
  scan.pointsAt = reading.attribute<std::uint64_t>(points, "fileOffset", 0);
  scan.points = reading.attribute<std::uint64_t>(points, "recordCount", 0);
  for (const pugi::xml_node& codec : points.child("codecs").children())
    throw reading.refuse(
        fmt::format("scan {} has an unknown encoding: {}", inQuotes(scan.name), inQuotes(codec.name())));
  for (const pugi::xml_node& field : points.child("prototype").children())
    if (field.type() == pugi::node_element) scan.fields.push_back(fieldOf(field, reading));
  readPose(node.child("pose"), reading, scan);
  if (const pugi::xml_node limits = node.child("colorLimits")) {
    constexpr std::array<const char*, 3> kColors{"Red", "Green", "Blue"};
    auto& known = scan.colorLimits.emplace();
    for (std::size_t k = 0; k < 3; ++k)
      known[k] = {reading.child(limits, fmt::format("color{}Minimum", kColors[k]).c_str()),
                  reading.child(limits, fmt::format("color{}Maximum", kColors[k]).c_str())};
  }
  return scan;
}

}  // namespace

bool canReadE57() { return true; }

E57Contents readE57Contents(const E57Pages& pages) {
  const Reading reading(pages.file());
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(pages.xml().data(), pages.xml().size());
  if (!parsed) {
    const auto* at = reinterpret_cast<const std::byte*>(pages.xml().data()) + parsed.offset;
    throw FileError::atByte(pages.file(), pages.fileByteOf(at), fmt::format("not valid XML: {}", parsed.description()));
  }
  const pugi::xml_node root = document.child("e57Root");
  if (!root) throw reading.refuse("there is no e57Root");
  E57Contents contents;
  for (const pugi::xml_node& scan : root.child("data3D").children())
    if (scan.type() == pugi::node_element) contents.scans.push_back(scanOf(scan, reading));
  for (const pugi::xml_node& image : root.child("images2D").children())
    contents.images += image.type() == pugi::node_element ? 1 : 0;
  return contents;
}

}  // namespace palpate
