// Error messages about invalid command lines.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace palpate {

/// The first unexpected word; empty if there is none.
std::string firstUnexpected(const CLI::App& app);

/// The subcommand of that name; null if there is none.
const CLI::App* subcommandOf(const CLI::App& app, const std::string& name);

/// A sentence about the error, with the probably intended word and the help command. An unexpected word is reported
/// first: it may be a misspelt form of what is missing.
std::string complaint(const CLI::App& app, const CLI::Error& error);

/// The command line that shows the help of the command that `names` lead to. Throws UsageError if there is none.
std::vector<std::string> helpOf(const CLI::App& app, std::vector<std::string> names);

}  // namespace palpate
