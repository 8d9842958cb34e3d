#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "apps/cli/command_line.hpp"
#include "apps/cli/complaint.hpp"
#include "apps/cli/completion.hpp"
#include "apps/cli/completion_scripts.hpp"
#include "apps/cli/config_flags.hpp"
#include "apps/cli/context.hpp"
#include "apps/cli/options.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/prepare_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/shown_names.hpp"
#include "engine/core/system_file.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

// Clouds that a command reads from standard input, or writes to standard output: "-", with a format.

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

class StandardStreams {
 public:
  /// Adds --format.
  void addOption(Options& program) {
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

  /// Replaces each "-" that names a cloud on the command line by a temporary file, which messages name by its stream.
  /// Throws UsageError without --format.
  void redirect(const Options& command) {
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

  /// Reads standard input into its file, if it is named. Throws UsageError for a terminal, and FileError.
  void read() {
    if (!input_) return;
    if (isTerminal(stdin)) throw UsageError("-: standard input is a terminal; pipe a cloud into it, or name a file");
    passBytes(stdin);
    copy(stdin, kInput, opened(input_->path(), "wbx").get(), input_->path().string());
  }

  /// Whether standard output is reserved for a cloud.
  bool writes() const { return output_.has_value(); }
  /// Writes the file of the command to standard output.
  void finish() {
    if (!output_) return;
    passBytes(stdout);
    copy(opened(output_->path(), "rb").get(), output_->path().string(), stdout, kOutput);
  }

 private:
  std::string format_;
  std::optional<TemporaryFile> input_, output_;
};

void addSubcommands(Options& app, Context& context, Command& command) {
  addView(app, context, command);
  addTouch(app, context, command);
  addRender(app, context, command);
  addMesh(app, context, command);
  addConvert(app, context, command);
  addInfo(app, context, command);
  addMake(app, context, command);
  addSimulate(app, context, command);
  addServe(app, context, command);
  addKeys(app, context, command);
  addReplay(app, context, command);
  addBench(app, context, command);
  addDoctor(app, context, command);
  addReference(app, context, command);
}

// One line for each command that works on any scan; tests run them.
constexpr std::pair<std::string_view, std::string_view> kExamples[]{
    {"view", "palpate view scan.ply"},
    {"touch", "palpate touch scan.ply --path builtin:scan --edit smooth --save smooth.ply"},
    {"render", "palpate render scan.ply -o scan.png"},
    {"mesh", "palpate mesh scan.ply -o mesh.stl --resolution 64"},
    {"convert", "palpate convert scan.ply scan.laz"},
    {"info", "palpate info scan.ply"},
    {"make", "palpate make torus -n 100000 -o torus.ply"},
    {"simulate", "palpate simulate dam --duration 0.1 --save water.ply"},
    {"serve", "palpate serve scan.ply --name scan"},
    {"keys", "palpate keys lab --name server"},
    {"replay", "palpate touch scan.ply --edit push --log session.log && palpate replay session.log"},
    {"bench", "palpate bench read scan.ply"},
    {"doctor", "palpate doctor"},
    {"reference", "palpate reference > reference.md"},
};

void addFooter(const std::vector<CLI::App*>& commands) {
  for (CLI::App* command : commands) {
    std::string footer = command->get_footer() +
                         "Every command also takes --gpu, --validate, --json, --format, --threads, --force and "
                         "--quiet: see palpate --help.";
    for (const auto& [name, example] : kExamples)
      if (name == command->get_name() && !command->get_parent()->get_parent())
        footer += fmt::format("\nExample: {}", example);
    command->footer(footer);
    addFooter(command->get_subcommands({}));
  }
}

// Whether a first word that is not a subcommand names a model, or an option of the window.
bool isOfWindow(const CLI::App& app, const std::string& word) {
  if (word.starts_with("-")) return app.get_subcommand("view")->get_option_no_throw(word.substr(0, word.find('=')));
  std::error_code ignored;
  return std::filesystem::exists(word, ignored) || word.find_first_of("./") != word.npos;
}

void parse(CLI::App& app, std::vector<std::string> arguments) {
  if (!arguments.empty() && arguments.front() == "help")
    arguments = helpOf(app, {arguments.begin() + 1, arguments.end()});
  joinOutliers(arguments);
  std::ranges::reverse(arguments);  // the order that CLI11 expects
  try {
    app.parse(std::vector(arguments));
  } catch (const CLI::ParseError& error) {
    // `palpate [OPTIONS] MODEL` means `palpate view [OPTIONS] MODEL`, and `palpate` alone the empty window.
    const std::string word = firstUnexpected(app);
    const bool isAlone = error.get_name() == "RequiredError" && word.empty();
    if (!app.get_subcommands().empty() || !(isAlone || isOfWindow(app, word))) throw;
    arguments.emplace_back("view");
    app.parse(std::move(arguments));
  }
}

// Parses the command line, and answers --help or --version; true if one was given, and there is no command to run.
bool answered(CLI::App& app, std::vector<std::string> arguments) {
  try {
    parse(app, std::move(arguments));
    return false;
  } catch (const CLI::Success& asked) {
    if (app.get_subcommands().empty() && !firstUnexpected(app).empty()) throw UsageError("{}", complaint(app, asked));
    app.exit(asked);
    return true;
  }
}

// The innermost subcommand on the command line.
const Options& namedIn(const Options& options) {
  const std::vector<const Options*> named = options.named();
  return named.empty() ? options : namedIn(*named.front());
}

// For the shell: what may come after the words behind "--", or the script that asks for it.
void complete(const Options& program, std::vector<std::string> words) {
  if (words.size() == 1)
    for (const auto& [shell, script] : completion_script::kAll)
      if (words.front() == shell) return fmt::print("{}", script);
  if (!words.empty() && words.front() == "--") words.erase(words.begin());
  const Completions completions = completionsOf(program, words);
  for (const std::string& word : completions.words) fmt::print("{}\n", word);
  if (completions.files)  // "/" cannot be a word
    fmt::print("/{}{}\n", completions.endings.empty() ? "" : " ", fmt::join(completions.endings, " "));
}

int run(std::vector<std::string> arguments) {
  Options options{
      "palpate: feel, see and sculpt point clouds of millions of points in real time.\n"
      "palpate and palpate MODEL... open the window, with the options of palpate view. Units: model coordinates as in "
      "the file; mm in the hand (the touch scale of `palpate info`), N, N/mm, N s/mm, s; GPU times in us."};
  CLI::App& app = options.app();
  app.name("palpate");
  app.set_help_all_flag("--help-all", "Print all options and exit");
  app.set_version_flag("--version", "palpate " PALPATE_VERSION, "the version of this program");
  app.require_subcommand(1);
  app.fallthrough();
  Context context;
  context.addOptions(options);
  context.setCommandLine(arguments);
  StandardStreams streams;
  streams.addOption(options);
  // Prints the error and returns the exit code: an interrupted run returns the code that shells expect.
  const auto fail = [&, words = arguments](std::string_view what, int failed) {
    const int code = StopBySignal::requested() ? StopBySignal::exitCode() : failed;
    fmt::print(stderr, "palpate: {}\n", withShownNames(std::string(what)));
    context.writeFailure(what, code, words);
    return code;
  };
  Command command;
  addSubcommands(options, context, command);
  addFooter(app.get_subcommands({}));
  app.footer("palpate help COMMAND shows the options of that command, as palpate COMMAND --help does.");

  try {
    if (!arguments.empty() && arguments.front() == "complete") {
      complete(options, {arguments.begin() + 1, arguments.end()});
    } else if (!answered(app, std::move(arguments))) {
      streams.redirect(options);
      checkFileNames(options);
      context.checkJson();
      if (streams.writes()) context.reserveStdout();
      streams.read();
      command();
      streams.finish();
    }
    checkStdout();
    if (const std::size_t messages = context.closeDevices())
      throw Error("{}; see above", counted(messages, "validation message"));
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail(complaint(app, error), 2);
  } catch (const ConfigError& error) {
    return fail(inFlags(error, namedIn(options)), 2);
  } catch (const UsageError& error) {
    return fail(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return fail("out of memory; ask for fewer points", 1);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}

}  // namespace

}  // namespace palpate

int main(int argc, char** argv) {
  palpate::removeTemporaryFilesAtSignals();
  std::vector<std::string> words = palpate::commandLine(argc, argv);
  if (!words.empty()) words.erase(words.begin());  // the program's name, which a caller may omit
  const int code = palpate::run(std::move(words));
  palpate::keepConsole(code);
  return code;
}
