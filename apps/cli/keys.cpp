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
    context.log().say("{}: a new authority, '{}'; whoever has this folder can make keys: keep it to yourself",
                      authority, made.authority);
  context.log().say(
      "{}: keys of '{}', good until {}; give this folder to who is to have them and to nobody else (--security)",
      made.folder.string(), options.name, made.until);
  context.writeJson({{"folder", made.folder.string()},
                     {"name", options.name},
                     {"authority", made.authority},
                     {"new_authority", made.isNewAuthority},
                     {"until", made.until}});
}

}  // namespace

void addKeys(Options& app, Context& context, Command& command) {
  Options& sub =
      app.addSubcommand("keys", "keys for sessions that are encrypted and open to their holders alone (--security)");
  auto options = std::make_shared<KeyOptions>();
  sub.add("folder", options->folder, "of an authority and of all whom it gives keys; made where there is none")
      .required()
      .typeName("FOLDER");
  sub.add("--name", options->name, "of who gets the keys, one for each person or machine; their folder is FOLDER/NAME")
      .required();
  sub.add("--days", options->days, "for which they are good").check(inRange(1, 3650)).showDefault();
  sub.footer(
      "Once for each: palpate keys lab --name server; palpate keys lab --name surgeon. Then palpate serve scan.laz "
      "--name city "
      "--interface eth0 --security lab/server, and on another machine, with the folder lab/surgeon brought there "
      "safely, "
      "palpate view --join city --interface eth0 --security surgeon. Nothing that is there is written over.\n");
  sub.whenNamed([&, options] { command = [&context, options] { makeKeysFor(context, *options); }; });
}

}  // namespace palpate
