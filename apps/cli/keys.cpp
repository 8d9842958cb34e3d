#include "apps/cli/context.hpp"
#include "haptics/sharing/security.hpp"

namespace palpate {

namespace {

struct KeyOptions {
  std::string folder, name;
  std::uint32_t days = 365;
};

void makeKeysFor(Context& context, const KeyOptions& options) {
  const MadeKeys made = makeKeys({.folder = options.folder, .name = options.name, .days = options.days});
  const std::string authority = (std::filesystem::path(options.folder) / "authority").string();
  if (made.isNewAuthority)
    context.log().say("{}: new authority '{}'; this folder is enough to make keys, so keep it private", authority,
                      made.authority);
  context.log().say("{}: keys of '{}', valid until {}; give this folder to their holder only (--security)",
                    made.folder.string(), options.name, made.until);
  context.writeJson({{"folder", made.folder.string()},
                     {"name", options.name},
                     {"authority", made.authority},
                     {"new_authority", made.isNewAuthority},
                     {"until", made.until}});
}

}  // namespace

void addKeys(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("keys", "make keys for encrypted sessions (--security)");
  auto options = std::make_shared<KeyOptions>();
  sub.add("folder", options->folder, "folder of the authority and its keys; created if missing")
      .required()
      .typeName("FOLDER");
  sub.add("--name", options->name,
          "name of the holder of the keys, one per person or machine; they are written to FOLDER/NAME")
      .required();
  sub.add("--days", options->days, "validity of the keys, days").check(inRange(1, 3650)).showDefault();
  sub.footer(
      "Run it once per holder: palpate keys lab --name server; palpate keys lab --name surgeon. "
      "Then run palpate serve scan.laz --name city --interface eth0 --security lab/server, copy the "
      "folder lab/surgeon safely to the other machine, and run palpate view --join city --interface "
      "eth0 --security surgeon there. Existing files are never overwritten.\n");
  sub.whenNamed([&, options] { command = [&context, options] { makeKeysFor(context, *options); }; });
}

}  // namespace palpate
