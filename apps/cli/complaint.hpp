// What is wrong with a command line that could not be read.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace palpate {

/// What nobody expected, in front; empty where all was.
std::string firstUnexpected(const CLI::App& app);

/// The subcommand of that name; null where there is none.
const CLI::App* subcommandOf(const CLI::App& app, const std::string& name);

/// A sentence about it, what was probably meant, and where help is. A word that nobody expected comes first: what is
/// missing may be what it was meant to be.
std::string complaint(const CLI::App& app, const CLI::Error& error);

/// The command line that shows the help of the command that `names` lead to. Throws UsageError where there is none.
std::vector<std::string> helpOf(const CLI::App& app, std::vector<std::string> names);

}  // namespace palpate
