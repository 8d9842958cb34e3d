#include "apps/cli/output.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/render/image.hpp"

namespace palpate {

namespace {

constexpr std::array<std::string_view, 3> kPlots{".png", ".pdf", ".svg"};

void checkPlot(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::ranges::find(kPlots, ending) == kPlots.end())
    throw UsageError("{}: plots are written as {}; use one of these extensions", file.string(),
                     fmt::join(kPlots, ", "));
}

void checkName(const std::string& file, Output kind) {
  switch (kind) {
    case Output::points:
      cloudFormats().toWrite(file, Written::points);
      break;
    case Output::mesh:
      cloudFormats().toWrite(file, Written::mesh);
      break;
    case Output::copy:
      cloudFormats().toWrite(file, Written::copy);
      break;
    case Output::picture:
      imageFormatOf(file);
      break;
    case Output::plot:
      if (!isDeviceOrPipe(file)) checkPlot(file);
      break;
    case Output::only:
      break;
  }
}

}  // namespace

void checkOutput(const std::string& file, Output kind) {
  if (file.empty()) return;
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw FileError(file, "is a folder; name a file in it");
  checkName(file, kind);
  if (!isDeviceOrPipe(file)) AtomicFile probe(file);  // a pipe's reader would take the probe for the end of the data
}

}  // namespace palpate
