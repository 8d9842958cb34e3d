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

struct Named {
  Option option;
  std::string text;
};

// The given values of the command and of those that it is a part of.
std::vector<Named> given(const Options& options) {
  std::vector<Named> all;
  for (const Option& option : options.all())
    if (option.given() && option.takesValue())
      for (const std::string& text : option.texts()) all.push_back({option, text});
  for (const Options* const named : options.named()) std::ranges::move(given(*named), std::back_inserter(all));
  return all;
}

// The file that a value names as an output; empty if it names none.
std::string outputOf(const Named& named) {
  const OptionFacts& facts = named.option.facts();
  const std::size_t at = named.text.find(facts.fileKey);
  if (facts.writes == Writes::nothing || at == named.text.npos || named.text == "-") return {};
  const std::size_t from = at + facts.fileKey.size();
  return named.text.substr(from, facts.fileKey.empty() ? named.text.npos : named.text.find(',', from) - from);
}

bool isSameFile(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored) ||
         std::filesystem::weakly_canonical(a, ignored) == std::filesystem::weakly_canonical(b, ignored);
}

// Whether a value, or a word of it as in "soft FILE" and "device=sim,path=FILE", names this existing file.
bool reads(const Named& named, const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::equivalent(named.text, file, ignored)) return true;
  for (std::size_t from = 0; from < named.text.size();) {
    const std::size_t end = std::min(named.text.find_first_of(" ,=", from), named.text.size());
    if (end > from && std::filesystem::equivalent(named.text.substr(from, end - from), file, ignored)) return true;
    from = end + 1;
  }
  return false;
}

}  // namespace

void checkFileNames(const Options& program) {
  const std::vector<Named> all = given(program);
  for (auto one = all.begin(); one != all.end(); ++one) {
    const std::string file = outputOf(*one);
    if (file.starts_with("-") && one->option.name().starts_with("-"))
      throw UsageError("{} needs the name of a file, and {} looks like an option; a file of that name is ./{}",
                       one->option.name(), file, file);
    if (file.empty() || isDeviceOrPipe(file)) continue;
    for (auto other = all.begin(); other != all.end(); ++other) {
      if (one == other) continue;
      const std::string second = outputOf(*other);
      const bool clash = second.empty() ? one->option.facts().writes == Writes::replacing && reads(*other, file)
                                        : isSameFile(file, second);
      if (clash)
        throw UsageError("{}: {} is also named by {}, and would be lost; name another file", one->option.name(), file,
                         other->option.name());
    }
  }
}

void checkOutput(const std::string& file, Output kind) {
  if (file.empty()) return;
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw FileError(file, "is a folder; name a file in it");
  checkName(file, kind);
  if (!isDeviceOrPipe(file)) AtomicFile probe(file);  // a pipe's reader would take the probe for the end of the data
}

}  // namespace palpate
