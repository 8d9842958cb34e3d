#include "apps/cli/picture_series.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>

#include "apps/cli/output.hpp"
#include "apps/cli/run_program.hpp"
#include "engine/core/error.hpp"
#include "engine/render/image.hpp"

namespace palpate {

namespace {

constexpr const char* kFilmRate = "30";  // pictures a second

// Position of the number's format, as %03d, and its length; nothing if there is not exactly one.
struct NumberFormat {
  std::size_t at, length;
};
std::optional<NumberFormat> numberFormatIn(const std::string& pattern) {
  const std::size_t at = pattern.find('%');
  if (at == pattern.npos || pattern.find('%', at + 1) != pattern.npos) return std::nullopt;
  const std::size_t end = pattern.find_first_not_of("0123456789", at + 1);
  constexpr std::size_t kMaxDigits = 2;
  if (end == pattern.npos || pattern[end] != 'd' || end - at - 1 > kMaxDigits) return std::nullopt;
  return NumberFormat{at, end + 1 - at};
}

std::string numbered(const std::string& pattern, std::uint32_t number) {
  const auto format = numberFormatIn(pattern);
  if (!format)
    throw UsageError("-o: '{}' needs a number for each picture, as in turn-%03d.png, or the ending .mp4", pattern);
  const std::string digits = pattern.substr(format->at + 1, format->length - 2);
  const int width = digits.empty() ? 1 : std::stoi(digits);
  return pattern.substr(0, format->at) + fmt::format("{:0{}}", number, width) +
         pattern.substr(format->at + format->length);
}

bool hasFfmpeg() {
  return runProgram("ffmpeg", {"-loglevel", "quiet", "-nostdin", "-f", "lavfi", "-i", "color=size=2x2:duration=0.04",
                               "-f", "null", "-"}) != 127;
}

std::string escaped(const std::string& path) {
  std::string text;
  for (const char c : path) text += c == '%' ? "%%" : std::string(1, c);
  return text;
}

}  // namespace

bool isFilm(const std::string& output) {
  std::string ending = std::filesystem::path(output).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".mp4";
}

void checkSeries(const Context& context, const std::string& output, std::uint32_t count) {
  const auto checkNew = [&](const std::string& file) {
    std::error_code ignored;
    if (!context.isForced() && std::filesystem::is_regular_file(file, ignored))
      throw Error("{}: exists; name another file, or add --force to replace it", file);
  };
  if (!isFilm(output)) {
    for (std::uint32_t k = 0; k < count; ++k) checkNew(numbered(output, k));
    return checkOutput(numbered(output, 0), Output::picture);
  }
  checkNew(output);
  checkOutput(output, Output::only);
  if (!hasFfmpeg())
    throw Error("{}: films are written by ffmpeg, which was not found; install it, or write pictures, as in {}", output,
                std::filesystem::path(output).stem().string() + "-%03d.png");
}

PictureSeries::PictureSeries(std::string output, std::uint32_t count) {
  files_.name = std::move(output);
  std::string pattern = files_.name;
  if (isFilm(files_.name)) {
    for (std::uint32_t k = 0; folder_.empty(); ++k) {
      const std::filesystem::path folder = fmt::format("{}.pictures{}", files_.name, k);
      if (std::filesystem::create_directory(folder)) folder_ = folder;
    }
    pattern = "%05d.png";
  }
  for (std::uint32_t k = 0; k < count; ++k)
    files_.each.push_back(folder_.empty() ? numbered(pattern, k) : (folder_ / numbered(pattern, k)).string());
}

PictureSeries::~PictureSeries() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void PictureSeries::finish() const {
  if (folder_.empty()) return;
  const std::filesystem::path film = folder_ / "film.mp4";
  // Players require an even width and height, and colours at half resolution.
  const int code = runProgram("ffmpeg", {"-loglevel", "error", "-nostdin", "-framerate", kFilmRate, "-i",
                                         (std::filesystem::path(escaped(folder_.string())) / "%05d.png").string(),
                                         "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", film.string()});
  if (code != 0) throw Error("{}: ffmpeg failed with exit code {}", files_.name, code);
  std::filesystem::rename(film, files_.name);
}

PointCloud revolved(const PointCloud& cloud, const Framing& framing) {
  constexpr std::size_t kSlices = 64, kCorners = 48;
  const Bounds shown = framing.shown.value_or(boundsOf(cloud));
  const DVec3 center = shown.center(), up = directionOf(framing.up), right = glm::cross(up, framing.front);
  const double low = -0.5 * std::abs(glm::dot(shown.max - shown.min, up)), thickness = -2 * low / kSlices;
  std::array<double, kSlices> radii{};
  for (const Vec3& position : cloud.positions) {
    if (!shown.contains(DVec3(position))) continue;
    const DVec3 away = DVec3(position) - center;
    const double height = glm::dot(away, up);
    const double slice = thickness > 0 ? (height - low) / thickness : 0;
    double& radius = radii[static_cast<std::size_t>(std::clamp(slice, 0.0, kSlices - 1.0))];
    radius = std::max(radius, glm::length(away - height * up));
  }
  PointCloud outline;
  outline.origin = cloud.origin;
  for (std::size_t slice = 0; slice <= kSlices; ++slice) {
    const double radius = std::max(radii[std::min(slice, kSlices - 1)], slice > 0 ? radii[slice - 1] : 0.0);
    for (std::size_t k = 0; k < kCorners; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kCorners;
      outline.positions.emplace_back(center + (low + static_cast<double>(slice) * thickness) * up +
                                     radius * (std::cos(angle) * framing.front + std::sin(angle) * right));
    }
  }
  return outline;
}

}  // namespace palpate
