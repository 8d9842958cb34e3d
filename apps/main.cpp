#include "apps/context.hpp"

namespace palpate {
namespace {

int run(int argc, char** argv) {
  CLI::App app{
      "palpate: feel, see and sculpt point clouds of millions of points in real time.\n"
      "Units: model coordinates as in the file; mm, N, N/mm, N s/mm, s; GPU times in us."};
  app.name("palpate");
  app.set_version_flag("--version", "palpate " PALPATE_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return fmt::format("palpate: {}; see palpate --help, or palpate COMMAND --help\n", error.what());
  });
  app.fallthrough();
  Context context;
  context.addOptions(app);
  Command command;
  addInfo(app, context, command);
  addMake(app, context, command);
  addTouch(app, context, command);
  addReplay(app, context, command);
  addRender(app, context, command);
  addView(app, context, command);
  addMesh(app, context, command);
  addConvert(app, context, command);
  addBench(app, context, command);
  addDoctor(app, context, command);
  for (CLI::App* sub : app.get_subcommands({}))
    sub->footer(sub->get_footer() +
                "Every command also takes --gpu, --validate, --json, --threads and --quiet: see palpate --help.");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (app.get_subcommands().empty() && !app.remaining().empty() && !app.remaining().front().starts_with("-")) {
      fmt::print(stderr, "palpate: there is no subcommand '{}'; see palpate --help\n", app.remaining().front());
      return 2;
    }
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    command();
    checkStdout();
    if (const std::size_t messages = context.closeDevices())
      throw Error("{} validation message{}; see above", messages, messages == 1 ? "" : "s");
    return 0;
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

int main(int argc, char** argv) { return palpate::run(argc, argv); }
