#include "apps/cli/standard_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <random>

#include "apps/cli/command_line.hpp"
#include "engine/core/error.hpp"
#include "engine/core/shown_names.hpp"
#include "engine/core/system_file.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

constexpr std::string_view kStream = "-", kInput = "standard input", kOutput = "standard output";
constexpr std::array<std::string_view, 2> kRead{"MODEL", "IN"};
constexpr std::array<std::string_view, 3> kWritten{"OUT", "OUT.ply", "MESH.ply"};  // types of values

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::vector<std::string> formatNames() {
  std::vector<std::string> names;
  for (const CloudFormat& format : cloudFormats().all())
    for (const std::string_view ending : format.endings) names.emplace_back(ending.substr(1));
  return names;
}

std::filesystem::path freshName(std::string_view stream, const std::string& format) {
  std::random_device random;
  return std::filesystem::temp_directory_path() /
         fmt::format("{} of palpate {:08x}{:08x}.{}", stream, random(), random(), format);
}

void copy(std::FILE* from, std::string_view source, std::FILE* to, std::string_view target) {
  std::array<char, std::size_t{1} << 16> bytes;
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), from))
    if (std::fwrite(bytes.data(), 1, count, to) != count) throw FileError(target, whyNotWritten(errno));
  if (std::ferror(from)) throw FileError(source, "cannot be read");
  if (std::fflush(to) != 0) throw FileError(target, whyNotWritten(errno));
}

File opened(const std::filesystem::path& path, const char* how) {
  File file(openFile(path, how), &std::fclose);
  if (!file) throw FileError(path, whyNotWritten(errno));
  return file;
}

}  // namespace

void StandardStreams::addOption(Options& program) {
  program
      .add("--format", format_,
           "format of a cloud named -, which is read from stdin or written to stdout: " +
               fmt::format("{}", fmt::join(formatNames(), ", ")))
      .typeName("FORMAT")
      .check({[](const std::string& text) {
        const std::vector<std::string> names = formatNames();
        return std::ranges::find(names, text) != names.end()
                   ? std::string()
                   : fmt::format("'{}' is not one of {}", text, fmt::join(names, ", "));
      }})
      .offers(formatNames());
}

void StandardStreams::redirect(const Options& command) {
  const auto isAmong = [](const auto& types, const Option& option) {
    return std::ranges::find(types, option.type()) != types.end();
  };
  for (Option option : command.all()) {
    const auto texts = option.takesValue() && option.given() ? option.texts() : std::vector<std::string>{};
    const bool reads = isAmong(kRead, option);
    if (std::ranges::find(texts, kStream) == texts.end() || !(reads || isAmong(kWritten, option))) continue;
    if (format_.empty())
      throw UsageError("{}: - is {}; name its format, as in --format ply", option.name(), reads ? kInput : kOutput);
    std::optional<TemporaryFile>& file = reads ? input_ : output_;
    if (!file) {
      file.emplace(freshName(reads ? kInput : kOutput, format_));
      showAs(file->path().string(), std::string(reads ? kInput : kOutput));
    }
    option.replace(std::string(kStream), file->path().string());
  }
  for (const Options* const named : command.named()) redirect(*named);
}

void StandardStreams::read() {
  if (!input_) return;
  if (isTerminal(stdin)) throw UsageError("-: standard input is a terminal; pipe a cloud into it, or name a file");
  passBytes(stdin);
  copy(stdin, kInput, opened(input_->path(), "wbx").get(), input_->path().string());
}

void StandardStreams::finish() {
  if (!output_) return;
  passBytes(stdout);
  copy(opened(output_->path(), "rb").get(), output_->path().string(), stdout, kOutput);
}

}  // namespace palpate
