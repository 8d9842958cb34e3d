#include <CLI/CLI.hpp>
#include <filesystem>

#include "apps/cli/command_line.hpp"
#include "apps/cli/config_flags.hpp"
#include "apps/cli/context.hpp"
#include "apps/cli/suggestion.hpp"

namespace palpate {
namespace {

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
}

void addFooter(const std::vector<CLI::App*>& commands) {
  for (CLI::App* command : commands) {
    command->footer(command->get_footer() +
                    "Every command also takes --gpu, --validate, --json, --threads and --quiet: see palpate --help.");
    addFooter(command->get_subcommands({}));
  }
}

// What nobody expected, in front; empty where all was.
std::string firstUnexpected(const CLI::App& app) {
  const std::vector<std::string> unexpected = app.remaining(true);
  return unexpected.empty() ? std::string() : unexpected.front();
}

// "--name" of each option that help shows.
void addOptionNames(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
}

// What is wrong with a command line that could not be read, and what was probably meant. A word that nobody expected
// comes first: what is missing may be what it was meant to be.
std::string complaint(const CLI::App& app, const CLI::Error& error) {
  const CLI::App* command = &app;
  std::string help = "palpate";
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().back();
    help += " " + command->get_name();
  }
  help += " --help";
  const std::string word = firstUnexpected(app);
  if (word.empty()) return fmt::format("{}; see {}", error.what(), help);
  const bool isOption = word.starts_with("-");
  std::vector<std::string> names;
  if (isOption) {
    addOptionNames(*command, names);
    addOptionNames(app, names);
  } else {
    for (const CLI::App* sub : command->get_subcommands({})) names.push_back(sub->get_name());
  }
  if (!isOption && names.empty()) return fmt::format("'{}' is one word too many; see {}", word, help);
  const std::string name = isOption ? word.substr(0, word.find('=')) : word;
  const std::string meant = nearestName(name, names);
  return fmt::format("there is no {} '{}'{}; see {}", isOption ? "option" : "subcommand", name,
                     meant.empty() ? std::string() : fmt::format("; did you mean {}?", meant), help);
}

// Whether a first word that is no subcommand is meant as a model.
bool isModel(const std::string& word) {
  std::error_code ignored;
  return !word.starts_with("-") && (std::filesystem::exists(word, ignored) || word.find_first_of("./") != word.npos);
}

void parse(CLI::App& app, std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);  // as CLI11 wants them
  try {
    app.parse(std::vector(arguments));
  } catch (const CLI::ParseError& error) {
    // `palpate MODEL` is `palpate view MODEL`, and `palpate` the window with nothing in it.
    const std::string word = firstUnexpected(app);
    const bool isAlone = word.empty() && error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError);
    if (!app.get_subcommands().empty() || !(isAlone || isModel(word))) throw;
    arguments.emplace_back("view");
    app.parse(std::move(arguments));
  }
}

// The innermost subcommand that the command line has named.
const Options& namedIn(const Options& options) {
  const std::vector<const Options*> named = options.named();
  return named.empty() ? options : namedIn(*named.front());
}

int run(std::vector<std::string> arguments) {
  Options options{
      "palpate: feel, see and sculpt point clouds of millions of points in real time.\n"
      "palpate and palpate MODEL... open the window. Units: model coordinates as in the file; mm, N, N/mm, N s/mm, s; "
      "GPU times "
      "in us."};
  CLI::App& app = options.app();
  app.name("palpate");
  app.set_version_flag("--version", "palpate " PALPATE_VERSION, "the version of this program");
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* main, const CLI::Error& error) {
    return fmt::format("palpate: {}\n", complaint(*main, error));
  });
  app.fallthrough();
  Context context;
  context.addOptions(options);
  Command command;
  addSubcommands(options, context, command);
  addFooter(app.get_subcommands({}));
  app.footer("palpate COMMAND --help shows the options of that command.");

  try {
    parse(app, std::move(arguments));
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    command();
    checkStdout();
    if (const std::size_t messages = context.closeDevices())
      throw Error("{} validation message{}; see above", messages, messages == 1 ? "" : "s");
    return 0;
  } catch (const ConfigError& error) {
    fmt::print(stderr, "palpate: {}\n", inFlags(error, namedIn(options)));
    return 2;
  } catch (const UsageError& error) {
    fmt::print(stderr, "palpate: {}\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "palpate: out of memory; ask for fewer points\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate: {}\n", error.what());
  }
  return 1;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  std::vector<std::string> words = palpate::commandLine(argc, argv);
  if (!words.empty()) words.erase(words.begin());  // the program's own name, which a caller may leave out
  return palpate::run(std::move(words));
}
