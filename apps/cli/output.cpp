#include "apps/cli/output.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "engine/core/atomic_file.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/render/image.hpp"

namespace palpate {

namespace {

struct Endings {
  Output kind;
  std::string_view called;
  std::array<std::string_view, 3> endings;  ///< the unused ones are empty
  bool mayHaveNone = false;
};
// Of the kinds whose endings no table of formats knows.
constexpr std::array kEndings{
    Endings{Output::depth, "depths", {".pfm"}},
    Endings{Output::trace, "traces", {".csv"}},
    Endings{Output::trajectory, "trajectories", {".csv", ".txt"}},
    Endings{Output::result, "results", {".json"}},
    Endings{Output::plot, "plots", {".png", ".pdf", ".svg"}},
    Endings{Output::session, "session logs", {".session", ".log"}, true},
    Endings{Output::journal, "journals", {".strokes", ".journal"}, true},
};

void checkEnding(const std::filesystem::path& file, const Endings& known) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending.empty() ? known.mayHaveNone : std::ranges::count(known.endings, ending) > 0) return;
  const auto end = std::ranges::find(known.endings, std::string_view());
  const std::span endings(known.endings.begin(), end);
  throw UsageError("{}: {} are written as {}{}; name it so", file.string(), known.called, fmt::join(endings, ", "),
                   known.mayHaveNone ? ", or without an ending" : "");
}

void checkName(const std::string& file, Output kind) {
  if (kind == Output::picture) {
    imageFormatOf(file);
  } else if (kind == Output::points || kind == Output::mesh || kind == Output::copy) {
    cloudFormats().toWrite(file, kind == Output::points ? Written::points
                                 : kind == Output::mesh ? Written::mesh
                                                        : Written::copy);
  } else if (!isDeviceOrPipe(file)) {
    const auto* const known = std::ranges::find(kEndings, kind, &Endings::kind);
    PALPATE_CHECK(known != kEndings.end());
    checkEnding(file, *known);
  }
}

}  // namespace

void checkOutput(const std::string& file, Output kind) {
  if (file.empty()) return;
  checkName(file, kind);
  if (!isDeviceOrPipe(file)) AtomicFile probe(file);  // whose reader would take the trial for the end
}

}  // namespace palpate
