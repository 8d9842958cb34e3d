// The reference page contains everything that a user can name.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/apps/program.hpp"
#include "tests/apps/result.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_folder.hpp"

namespace palpate::reference_test {

namespace {

Result reference() {
  const ScratchFolder folder;
  const std::string file = (folder / "reference.json").string();
  works("reference --json " + file);
  return Result::parse(contentOf(file));
}

// The keys of a result as the reference names them: an object counts as one key where the reference describes none of
// its members; a list of objects never does.
void addKeys(const Result& json, const std::string& before, const std::set<std::string>& described,
             std::set<std::string>& keys) {
  for (const std::string& name : json.keys()) {
    const std::string path = before + name;
    const Result inside = json[name];
    const auto member = described.lower_bound(path + ".");
    if (inside.isObject() && member != described.end() && member->starts_with(path + "."))
      addKeys(inside, path + ".", described, keys);
    else
      keys.insert(path);
    if (!inside.isArray()) continue;
    for (const Result& element : inside)
      if (element.isObject()) addKeys(element, path + "[].", described, keys);
  }
}

// The object or list that contains a key; empty if it is the result itself.
std::string ownerOf(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  if (dot == key.npos) return {};
  return key.substr(0, key.compare(dot - 2, 2, "[]") == 0 ? dot - 2 : dot);
}

// The described keys of each command's results.
std::map<std::string, std::set<std::string>> describedKeys() {
  std::map<std::string, std::set<std::string>> described;
  for (const Result& result : reference()["results"]) {
    CHECK(result["meaning"].get<std::string>().size() > 2);
    CHECK(described[result["command"]].insert(result["key"]).second);
  }
  return described;
}

}  // namespace

TEST_CASE("the reference page of the project is what the program says") {
  if (isLeftOut("bench") || isLeftOut("simulate")) {
    MESSAGE("skipped: the page describes a palpate with all annexes");
    return;
  }
  const std::string page = contentOf(sourceFolder() / "apps/REFERENCE.md");
  CHECK_MESSAGE(page == palpate("reference").text,
                "apps/REFERENCE.md differs from the program; make it again: palpate reference > apps/REFERENCE.md");
}

TEST_CASE("each setting with an option is an option of palpate touch with the same default and bounds") {
  const Result all = reference();
  std::map<std::string, Result> options;
  for (const Result& option : all["options"]) {
    if (option["command"].get<std::string>() != "palpate touch") continue;
    const std::string names = option["names"];
    if (const std::size_t dashes = names.find("--"); dashes != names.npos)
      options.emplace(names.substr(dashes), option);
  }
  std::size_t compared = 0;
  for (const Result& setting : all["settings"]) {
    const std::string flag = setting["option"], key = setting["key"];
    if (flag.empty()) continue;
    CAPTURE(key);
    REQUIRE(options.contains(flag));
    const Result& option = options.at(flag);
    const std::string bounds = option["bounds"], unit = option["unit"], settingUnit = setting["unit"];
    const std::string inOption = bounds.starts_with("auto, ") ? bounds.substr(6) : bounds;
    if (const std::string wanted = setting["bounds"]; !wanted.empty()) CHECK_MESSAGE(says(wanted, inOption), bounds);
    if (!unit.empty()) CHECK(unit == settingUnit);
    const std::string usual = option["default"], settingUsual = setting["default"].dump();
    if (!bounds.empty() && !usual.empty() && settingUsual != "0" && settingUsual != "0.0" && settingUsual != "null")
      CHECK(std::stod(usual.substr(usual.rfind(' ') + 1)) == std::stod(settingUsual));  // "as remembered, else 0.8"
    ++compared;
  }
  CHECK(compared > 50);
}

TEST_CASE("each key that a command writes with --json is in the reference, with a meaning") {
  const ScratchFolder folder;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  std::map<std::string, std::set<std::string>> described = describedKeys();
  const std::string model = in("m.ply"), quick = " --backend cpu --duration 0.05 ";
  const std::vector<std::pair<std::string, std::string>> commands{
      {"make", "make sphere -n 500 -o " + model},
      {"info", "info " + model},
      {"info", "info " + model + " --statistics z"},
      {"info", "info water"},
      {"info", "info jelly"},
      {"convert", "convert " + model + " " + in("c.xyz") + " --random 90"},
      {"convert", "convert " + model + " --to " + in("converted")},
      {"simulate", "simulate water --duration 0.003 --backend cpu --probe 50,20,50"},
      {"touch", "touch " + model + quick + "--edit push --undo 1 --log " + in("l") + " --device sim --tool pad"},
      {"touch", "touch " + model + quick + "--hand path=builtin:slide"},
      {"touch", "touch water" + quick},
      {"touch", "touch " + model + " --backend cpu --device replay:" + in("l")},
      {"replay", "replay " + in("l")},
      {"doctor", "doctor --speed"},
      {"bench step", "bench step --sizes 500 --repeat 5 --backend cpu"},
      {"bench edit", "bench edit --sizes 2000 --touched 50 --repeat 5 --backend cpu"},
      {"bench matter", "bench matter --sizes 500 --matter soft --repeat 5 --backend cpu"},
      {"bench read", "bench read " + model + " --repeat 5"},
      {"bench select", "bench select --sizes 500 --repeat 5 --beside 0.02"},
      {"bench mesh", "bench mesh --sizes 500 --resolution 8 --repeat 1 --shapes sphere --truth-points 500"},
      {"bench stream", "bench stream --sizes 500 --frames 16x12 --repeat 1"},
  };
  std::map<std::string, std::set<std::string>> written;
  for (const auto& [command, words] : commands) {
    CAPTURE(words);
    if (isLeftOut(words)) continue;
    works(words + " --json " + in("result.json"));
    std::set<std::string> keys;
    addKeys(Result::parse(contentOf(in("result.json"))), "", described[command], keys);
    CHECK(keys.size() > 2);
    for (const std::string& key : keys) CHECK_MESSAGE(described[command].contains(key), key);
    for (const std::string& key : keys) written[command].insert(ownerOf(key));
  }
  // What other options write is at least part of an object that is described or written.
  for (const auto& [command, owners] : written)
    for (const std::string& key : described[command])
      CHECK_MESSAGE((owners.contains(ownerOf(key)) || described[command].contains(ownerOf(key))), key);
}

TEST_CASE("the reference lists exactly the keys of the window's state") {
  if (!hasDisplay()) return;
  const auto played = play("sphere.ply --backend cpu --size 320x240",
                           "0.2 key d\n0.2 mouse 160 120\n0.3 button left down\n0.4 button left up\n"
                           "0.6 state %/state.json\n0.6 quit\n",
                           "", [](const std::filesystem::path& folder) { makeSphere(folder, 2000); });
  REQUIRE_MESSAGE(played->outcome.code == 0, played->outcome.text);
  std::set<std::string> described = describedKeys()["view"], keys;
  addKeys(played->state("state.json"), "", described, keys);
  for (const std::string& key : keys) CHECK_MESSAGE(described.contains(key), key);
  // Without a joined session, a simulation or a device.
  std::erase_if(described, [](const std::string& key) {
    return key.starts_with("shared") || key.starts_with("partial") || key.starts_with("other_") ||
           key == "parameters" || key.starts_with("device.");
  });
  REQUIRE(keys.contains("picked.point"));
  for (const std::string& key : described)
    CHECK_MESSAGE((keys.contains(key) || key == "picked" || key == "device"), key);
}

TEST_CASE("the comments of the C headers state the bounds of the settings") {
  // Bounds in a comment, as in "falloff ...; 0 to 16; default 1".
  static const std::regex field(R"(^  \w+ (\w+); */\*.*[ ;,](\d+) to (\d+)(?:; default [^;]*)? \*/)");
  std::map<std::string, std::string> bounds;
  for (const Result& setting : reference()["settings"]) {
    const std::string key = setting["key"];
    if (key.starts_with("brush.") || key.starts_with("force.") || key.starts_with("tool."))
      bounds[key.substr(key.find('.') + 1)] = setting["bounds"].get<std::string>();
  }
  const auto headers = sourceFolder() / "haptics/library/include/palpate";
  std::istringstream header(contentOf(headers / "sessions.h") + contentOf(headers / "touch.h"));
  std::size_t compared = 0;
  std::string section;
  for (std::string line; std::getline(header, line);) {
    if (line.starts_with("typedef struct ")) section = line.substr(15, line.find(' ', 15) - 15);
    std::smatch found;
    if ((section != "pp_brush" && section != "pp_contact_options" && section != "pp_tool") ||
        !std::regex_search(line, found, field) || !bounds.contains(found[1]))
      continue;
    CAPTURE(line);
    CHECK(bounds.at(found[1]) == found[2].str() + " to " + found[3].str());
    ++compared;
  }
  CHECK(compared >= 4);
}

}  // namespace palpate::reference_test
