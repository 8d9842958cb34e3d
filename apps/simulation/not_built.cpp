// Replaces `palpate simulate` if palpate is built without PALPATE_SIMULATION.
#include <CLI/CLI.hpp>

#include "apps/cli/context.hpp"
#include "apps/cli/scene_info.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

[[noreturn]] void refuse(std::string_view what) { throw NotBuilt(what, "PALPATE_SIMULATION"); }

}  // namespace

void addSimulate(Options& app, Context&, Command& command) {
  Options& sub =
      app.addSubcommand("simulate", "simulate without a hand; this palpate was built without PALPATE_SIMULATION");
  sub.app().fallthrough(false)->allow_extras();  // the error is the same for every scene and option
  sub.whenNamed([&command] { command = [] { refuse("simulate"); }; });
}

void infoOfScene(Context&, const std::string& name, const SceneRef&) { refuse(name); }

}  // namespace palpate
