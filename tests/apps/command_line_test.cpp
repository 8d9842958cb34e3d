// The command line as users type it: help, misspelt words, bounds, and progress.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "engine/core/clock.hpp"
#include "tests/apps/program.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"
#include "tests/source_folder.hpp"

namespace palpate::command_line_test {

namespace {

bool lacks(const std::string& text, const std::string& part) { return text.find(part) == std::string::npos; }

// Output of the program on a pseudo-terminal.
std::string onTerminal(const ScratchFolder& folder, const std::string& arguments) {
  const std::string file = (folder / "said").string();
  const std::string command =
      "script -qec \"" + program() + " " + arguments + "\" /dev/null > " + file + " 2>&1 < /dev/null";
  REQUIRE_MESSAGE(std::system(command.c_str()) == 0, contentOf(file));
  return contentOf(file);
}

bool answersOnSoftware(const ScratchFolder& folder) {
  works("doctor --json " + (folder / "doctor.json").string());
  const auto doctor = jsonOf(folder / "doctor.json");
  for (const auto& gpu : doctor["gpus"])
    if (gpu["name"] == doctor["in_use"]) return gpu["type"] == "CPU";
  return false;
}

}  // namespace

TEST_CASE("doctor names a faster version of an old software driver") {
  const std::string text = palpate("doctor").text, driver = "driver: llvmpipe Mesa ";
  const std::size_t at = text.find(driver);
  if (at == std::string::npos)
    MESSAGE("skipped: there is no llvmpipe");
  else
    CHECK(says(text, "up to twice as fast") == (std::stoi(text.substr(at + driver.size())) < 25));
}

TEST_CASE("the overview is readable, and the options of touch are grouped under headings, common ones first") {
  const Outcome overview = palpate("--help");
  CHECK(overview.code == 0);
  CHECK(std::ranges::count(overview.text, '\n') < 50);
  CHECK(says(overview.text, "palpate and palpate MODEL... open the window"));
  for (const char* command :
       {"view", "touch", "render", "mesh", "info", "make", "simulate", "convert", "replay", "bench", "doctor"})
    CHECK_MESSAGE(says(overview.text, std::string("\n  ") + command + " "), command);
  const std::string touch = palpate("touch --help").text;
  std::size_t last = 0;
  for (const char* heading : {"Model:", "Path:", "Contact and force:", "Sculpting:", "Output:", "Picture:", "Motion:",
                              "Depth camera:", "Shared session:", "Back end:", "Tool:", "Devices:"}) {
    const std::size_t at = touch.find(std::string("\n") + heading + "\n");
    REQUIRE_MESSAGE(at != std::string::npos, heading);
    CHECK(at > last);
    last = at;
  }
  std::size_t options = 0;
  for (std::size_t at = touch.find("\n  -"); at != touch.npos; at = touch.find("\n  -", at + 1)) ++options;
  CHECK(options > 30);
  CHECK(options <= 41);
  CHECK(touch.find("--stiffness") < touch.find("--backend"));
  CHECK_FALSE(says(touch, "--bucket-key"));
  CHECK(says(touch, " more options: palpate touch --help-all\n"));
  CHECK(says(palpate("touch --help-all").text, "--bucket-key"));
  CHECK(says(palpate("--help-all").text, "--bucket-key"));
}

TEST_CASE("a misspelt command, option or value gets a suggestion") {
  const auto meant = [](const std::string& arguments, const std::string& complaint) {
    if (isLeftOut(arguments)) return;
    CAPTURE(arguments);
    const Outcome outcome = palpate(arguments);
    CHECK(outcome.code == 2);
    CHECK_MESSAGE(says(outcome.text, complaint), outcome.text);
    CHECK(std::ranges::count(outcome.text, '\n') == 1);
  };
  meant("rendr x.ply", "unknown subcommand 'rendr'; did you mean 'render'? See palpate --help");
  meant("tuoch x.ply", "did you mean 'touch'?");
  meant("bench coexsit", "unknown subcommand 'coexsit'; did you mean 'coexist'? See palpate bench --help");
  meant("touch x.ply --stifness 1",
        "unknown option '--stifness'; did you mean '--stiffness'? See palpate touch --help");
  meant("touch x.ply --qiuet", "did you mean '--quiet'?");
  meant("make sphere --outptu=x.ply", "unknown option '--outptu'; did you mean '--output'?");
  meant("bench edit --touchd 3", "did you mean '--touched'? See palpate bench edit --help");
  meant("make sphere more -o x.ply", "'more' is one word too many; see palpate make --help");
  const Outcome far = palpate("fly");
  CHECK(says(far.text, "unknown subcommand 'fly'; see palpate --help"));
  meant("fly --help", "unknown subcommand 'fly'");
  meant("touch x.ply --edit psuh", "--edit: unknown value 'psuh'; did you mean 'push'? Choose none, push, carve");
  meant("help bench coexsit", "did you mean 'coexist'?");
  meant("bench", "a subcommand is required: build, sort,");
  meant("convert -- a.ply b.ply --force", "--force follows --, and what follows that are names, not options");
}

TEST_CASE("text that cannot be written is an error of every command, and not a success") {
  if (!std::filesystem::exists("/dev/full")) return;
  const ScratchFolder folder;
  works("--quiet make sphere -n 100 -o " + (folder / "s.ply").string());
  for (const std::string& command :
       {std::string("--help"), std::string("--help-all"), std::string("--version"), std::string("help touch"),
        std::string("touch --help"), std::string("reference"), std::string("complete bash"),
        "info " + (folder / "s.ply").string(), "info --json - " + (folder / "s.ply").string()}) {
    CAPTURE(command);
    const Outcome outcome = run("(" + program() + " " + command + " >/dev/full)");
    CHECK(outcome.code == 1);
    CHECK(says("\n" + outcome.text, "\npalpate: "));
  }
}

TEST_CASE("info advises how to read the bytes of a pipe") {
  const ScratchFolder folder;
  const std::string ply = (folder / "s.ply").string(), copy = (folder / "c.ply").string();
  works("--quiet make sphere -n 100 -o " + ply);
  const Outcome refused = run("cat " + ply + " | " + program() + " info /dev/stdin");
  CHECK(refused.code == 1);
  CHECK(says(refused.text, "name standard input -, with its --format"));
  const Outcome converted = run("cat " + ply + " | " + program() + " convert /dev/stdin " + copy);
  CHECK(converted.code == 0);
  works("info " + copy);
}

TEST_CASE("a duplicate option, or one without its value, is reported in a sentence") {
  const auto refuses = [](const std::string& arguments, const std::string& complaint) {
    const Outcome outcome = palpate(arguments);
    CHECK(outcome.code == 2);
    CHECK_MESSAGE(says(outcome.text, complaint), arguments);
  };
  refuses("touch x.ply --rate 10 --rate 20", "--rate is given 2 times; give it once");
  refuses("touch x.ply --gpu a --gpu b --gpu c", "--gpu is given 3 times; give it once");
  refuses("touch x.ply --rate", "--rate needs a value; see palpate touch --help");
  refuses("touch x.ply --trace --log", "--trace needs the name of a file, and --log looks like an option");
  refuses("render x.ply -o --force", "--output needs the name of a file, and --force looks like an option");
  refuses("convert x.ply --force", "output: is required; name a file, or a folder with --to");
}

TEST_CASE("palpate help COMMAND shows what palpate COMMAND --help does") {
  for (const std::string command : {"", "touch", "bench", "bench edit"}) {
    if (isLeftOut(command)) continue;
    const Outcome help = palpate("help " + command);
    CHECK(help.code == 0);
    CHECK(help.text == palpate(command + " --help").text);
  }
}

TEST_CASE("an output that cannot be written is refused before any work, and a pipe is written only once") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), pipe = (folder / "pipe").string();
  const Outcome refused = palpate("make sphere -n 1000 -o " + model + " --json " + (folder / "no/x.json").string());
  CHECK(refused.code == 1);
  CHECK(says(refused.text, "x.json: cannot be written"));
  CHECK_FALSE(std::filesystem::exists(model));
  works("make sphere -n 1000 -o " + model);
  const Outcome piped = run("mkfifo " + pipe + " && { cat " + pipe + " & timeout 20 " + program() + " info " + model +
                            " --quiet --json " + pipe + " > /dev/null; wait; }");
  CHECK(piped.code == 0);
  CHECK(says(piped.text, "1000"));
}

TEST_CASE("an output with an unknown ending is refused before any work, with the endings that can be written") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 500 -o " + in("s.ply"));
  const std::string model = in("s.ply"), touch = "touch " + model + " --backend cpu --rate 50 ";
  const auto refused = [&](const std::string& command, const char* name, const std::string& complaint) {
    if (isLeftOut(command)) return;
    CAPTURE(command);
    const Outcome outcome = palpate(command + in(name));
    CHECK(outcome.code == 2);
    CHECK_MESSAGE(says(outcome.text, in(name) + ": " + complaint), outcome.text);
    CHECK(std::ranges::count(outcome.text, '\n') == 1);  // nothing was read or done
  };
  // The missing input files are not read before.
  const std::string none = in("none.ply");
  for (const char* name : {"b.foo", "b"}) {
    refused("make sphere -n 500 -o ", name, "clouds are written as .ply, .las");
    refused("convert " + none + " ", name, "clouds are written as .ply, .las");
    refused("mesh " + none + " -o ", name, "meshes are written as .ply, .obj");
    refused("render " + none + " -o ", name, "pictures are written as .png, .jpg, .jpeg; use one of these extensions");
    refused("simulate none.json --save ", name, "clouds are written as .ply, .las");
    refused("replay none --recover --save ", name, "clouds are written as .ply, .las");
    refused(touch + "--edit push --save ", name, "clouds are written as .ply, .las");
    refused(touch + "--picture ", name, "pictures are written as .png, .jpg, .jpeg; use one of these extensions");
    refused("serve " + none + " --name a --save ", name, "clouds are written as .ply, .las");
    refused("bench build --sizes 1000 --plot ", name,
            "plots are written as .png, .pdf, .svg; use one of these extensions");
    refused("bench edit --models " + none + " --plot ", name,
            "plots are written as .png, .pdf, .svg; use one of these extensions");
  }
  refused("make sphere -n 500 -o ", "b.stl",
          "STL contains triangles, but these are points; clouds are written as .ply");
  refused(touch + "--edit push --save ", "b.3dgs.ply", "only palpate convert can write 3DGS");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()) == 1);
  works("make sphere -n 500 -o /dev/null --json /dev/null");
  // Outputs that have only one format may have any name.
  works(touch + "--duration 0.1 --trace " + in("trace") + " --trajectory " + in("way") + " --log " + in("l.ply") +
        " --json " + in("result.txt"));
}

TEST_CASE("every numeric option has bounds, which its error names") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), out = (folder / "o.ply").string();
  works("make sphere -n 500 -o " + model);
  const auto refuses = [&](const std::string& command, const std::string& option,
                           std::initializer_list<const char*> values) {
    for (const char* value : values) {
      const Outcome outcome = palpate(command + " " + option + "=" + value);
      CAPTURE(outcome.text);
      CHECK(outcome.code == 2);
      CHECK(says(outcome.text, option + ": " + value + " is not "));
      CHECK(says(outcome.text, " from "));
      CHECK(says(outcome.text, " to "));
    }
  };
  const std::initializer_list<const char*> never{"nan", "inf", "-1", "1e30", "word"};
  for (const char* option :
       {"--stiffness", "--damping", "--max-force", "--friction", "--yield-depth", "--push-rate", "--strength",
        "--brush-radius", "--penetration", "--rate", "--mm-per-unit", "--cell", "--tool-size", "--hand-stiffness",
        "--hand-damping", "--duration", "--undo-memory", "--radius"})
    refuses("touch " + model, option, never);
  for (const char* option : {"--falloff", "--tool-points", "--undo", "--redo"})
    refuses("touch " + model, option, never);
  refuses("touch " + model, "--undo", {"1.5"});
  refuses("info " + model, "--threads", {"-1", "1e9", "100000"});
  refuses("make sphere -o " + out, "--points", {"nan", "-1", "1e30", "1.5"});
  for (const char* option : {"--seed", "--noise", "--size"}) refuses("make sphere -n 10 -o " + out, option, never);
  for (const char* option : {"--resolution", "--radius"}) refuses("mesh " + model + " -o " + out, option, never);
  refuses("render " + model + " -o x.png", "--resolution", never);
  for (const char* option : {"--rate", "--mm-per-unit", "--undo-memory"}) refuses("view " + model, option, never);
  CHECK(palpate("make sphere -n 10 --center=1e30,0,0 -o " + out).code == 2);
  CHECK_FALSE(std::filesystem::exists(out));
  works("touch " + model + " --stiffness 1000 --friction 0 --radius auto --max-force 0");
}

TEST_CASE("an unsupported configuration is refused with the options that request it") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 500 -o " + model);
  const auto refused = [&](const std::string& arguments, const std::string& complaint) {
    if (isLeftOut(arguments)) return;
    CAPTURE(arguments);
    const Outcome outcome = palpate(arguments);
    CHECK(outcome.code == 2);
    CHECK(says(outcome.text, "palpate: " + complaint));
  };
  const std::string touch = "touch " + model + " ", second = "--hand path=builtin:slide ";
  refused(touch + "--surface sphere --backend cuda",
          "--surface: --backend cuda supports only the surface average; use vulkan or cpu for sphere");
  refused(touch + "--tool pad --backend cuda",
          "--tool: --backend cuda supports only the tool point; use vulkan or cpu for pad");
  refused(touch + "--tool pad --method naive",
          "--tool: --method naive supports only the tool point; use fused for pad");
  refused(touch + "--tool ball --ahead on --backend vulkan",
          "--ahead: queries with a ball cannot be submitted ahead; leave it out");
  refused(touch + "--tool pad --tool-axis 0,0,0 --backend cpu", "--tool-axis: is not a direction");
  refused(touch + second + "--backend cuda", "--hand: --backend cuda supports one hand; use vulkan or cpu");
  refused(touch + second + "--method naive", "--hand: --method naive supports one hand; use fused");
  refused(touch + second + "--ahead on --backend vulkan",
          "--ahead: queries of several hands cannot be submitted ahead; leave it out");
  refused(touch + "--ahead off --backend cpu", "--ahead: only --backend vulkan supports it");
  refused(touch + "--print-tick --backend cpu", "--print-tick: only --backend vulkan supports it");
  refused(touch + "--edit carve --backend cuda",
          "--edit: --backend cuda supports only the brush push; use vulkan or cpu for carve");
  refused(touch + "--edit push --undo 1 --backend cuda",
          "--undo: back end cuda does not report its edits; use vulkan or cpu");
  refused(touch + "--log x --backend cuda", "--log: back end cuda does not report its edits; use vulkan or cpu");
  refused(touch + "--method direct --backend vulkan",
          "--method: direct is not a method of --backend vulkan, which has fused");
  refused(touch + "--device dhd:x --realtime --duration 1 --backend cpu",
          "--device: dhd:x: is not the number of a device");
  refused("bench step --sizes 2000 --wait spin --backend cpu", "--wait: only --backend vulkan supports it");
  refused("bench step --sizes 2000 --surface sphere --backend cuda",
          "--surface: --backend cuda supports only the surface average");
  refused("bench edit --models " + model + " --touched 20 --duration 1 --rate 20000",
          "--rate: 20000 is not between 1 and 10000");
}

TEST_CASE("an option has one name: no second one is accepted, and a slip is corrected") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 1000 -o " + model);
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    const Outcome outcome = palpate(options);
    CAPTURE(options);
    CHECK(outcome.code == 2);
    CHECK(says(outcome.text, complaint));
  };
  for (const char* other : {"--tau 1", "--beta 0.1", "--tool-radius 6", "--keep-points", "--second-device path",
                            "--second-path a.csv", "--second-trace t.csv", "--all-points", "--as anna"})
    refused("touch " + model + ' ' + other, "unknown option '" + std::string(other, std::strcspn(other, " ")) + "'");
  refused("mesh " + model + " -o m.ply --lattice 64", "unknown option '--lattice'");
  refused("view " + model + " --lattice 64", "unknown option '--lattice'");
  refused("touch " + model + " --yeild-depth 1", "did you mean '--yield-depth'?");
  refused("touch " + model + " --push-rat 1", "did you mean '--push-rate'?");
  refused("touch " + model + " --brush-raduis 6", "did you mean '--brush-radius'?");
  refused("touch " + model + " --no-resampel", "did you mean '--no-resample'?");
  refused("touch " + model + " --hand-nam anna", "did you mean '--hand-name'?");
  refused("mesh " + model + " -o m.ply --resoluton 64", "did you mean '--resolution'?");
}

TEST_CASE("progress is a bar on a terminal, lines in a file, and absent with --quiet" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 20000 -o " + model);
  const std::string session = "touch " + model + " --backend cpu --realtime --duration 1.6";  // shown after 1 s
  const std::string seen = onTerminal(folder, session);
  CHECK(says(seen, "\r\033[Ktouch [="));
  CHECK(seen.find("\r\033[K", seen.rfind("] ")) != std::string::npos);  // erased before the table
  const Outcome plain = palpate(session);
  CHECK(says(plain.text, "touch: "));
  CHECK(says(plain.text, " %\n"));
  CHECK(lacks(plain.text, "\r"));
  for (const std::string& quiet : {onTerminal(folder, "--quiet " + session), palpate("--quiet " + session).text}) {
    CHECK(lacks(quiet, "touch ["));
    CHECK(lacks(quiet, "touch: "));
  }
  CHECK(says(onTerminal(folder, "make sphere -n 4000000 --ascii -o /dev/null"), "/dev/null [="));
  if (!inFullTier()) return;
  const Stopwatch watch;
  const std::string mesh = onTerminal(folder, "mesh " + model + " --resolution 256 -o " + (folder / "m.ply").string());
  if (watch.elapsed_s() > 2)
    CHECK_MESSAGE(says(mesh, "m.ply [="), mesh);
  else
    MESSAGE("this machine meshes too fast to show progress");
}

TEST_CASE("touch selects a hardware GPU, otherwise the CPU, unless an option requires one of them") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), json = (folder / "t.json").string();
  works("make sphere -n 5000 -o " + model);
  const auto backendOf = [&](const std::string& options) {
    const Outcome outcome = palpate("touch " + model + " --rate 100 " + options + " --json " + json);
    REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
    const std::string backend = jsonOf(json)["backend"];
    CHECK(says(outcome.text, "(" + backend + ")\n"));
    return backend;
  };
  const std::string own = answersOnSoftware(folder) ? "cpu" : "vulkan";
  CHECK(backendOf("") == own);
  CHECK(backendOf("--backend auto") == own);
  CHECK(backendOf("--backend cpu") == "cpu");
  CHECK(backendOf("--backend vulkan") == "vulkan");
  if (!isLeftOut("--method indirect")) CHECK(backendOf("--method indirect") == "vulkan");
  CHECK(backendOf("--method direct") == "cpu");
  CHECK(backendOf("--print-tick") == "vulkan");
  CHECK(backendOf("--gpu 0") == "vulkan");
  CHECK(backendOf("--validate") == "vulkan");
  const std::string log = (folder / "log").string();
  CHECK(backendOf("--log " + log) == own);
  CHECK(says(contentOf(log), "\"name\": \"" + own + "\""));
  works("replay " + log);
}

TEST_CASE("the report states how the index was updated after edits: static, rebuilt or incremental") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), json = (folder / "t.json").string();
  works("make sphere -n 5000 -o " + model);
  const auto report = [&](const std::string& options) {
    works("touch " + model + " --penetration 3 --brush-radius 6 --rate 125 " + options + " --json " + json);
    return jsonOf(json);
  };
  for (const char* backend : {"--backend cpu", "--backend vulkan"}) {
    const auto still = report(backend);
    CHECK(still["index"] == "static");
    CHECK(still["index_rebuilds"] == 0);
    CHECK(still["index_followed"] == 0);
  }
  const auto cpu = report("--backend cpu --edit push");
  CHECK(cpu["index"] == "incremental");
  CHECK(cpu["index_rebuilds"] == 0);
  CHECK(cpu["index_followed"] >= cpu["edit_ticks"].get<int>() / 2);  // ticks without a change move nothing
  const auto built = report("--backend cpu --edit push --index rebuild");
  CHECK(built["index"] == "rebuild");
  CHECK(built["index_rebuilds"] >= built["edit_ticks"].get<int>() / 2);
  CHECK(built["index_followed"] == 0);
  const auto followed = report("--backend vulkan --edit push");
  CHECK(followed["index"] == "incremental");
  CHECK(followed["index_rebuilds"] == 0);
  CHECK(followed["index_followed"] == followed["edit_ticks"]);
  const auto rebuilt = report("--backend vulkan --edit push --index rebuild");
  CHECK(rebuilt["index"] == "rebuild");
  CHECK(rebuilt["index_rebuilds"] == rebuilt["edit_ticks"]);
  CHECK(rebuilt["index_followed"] == 0);
}

TEST_CASE("touch reports a tool smaller than the spacing, with both sizes and advice") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), info = (folder / "info.json").string();
  works("make sphere -n 2000 -o " + model);  // of 100 mm
  works("info " + model + " --json " + info);
  const double spacing_mm = jsonOf(info)["mean_spacing"];
  const std::string session = "touch " + model + " --backend cpu --edit push --penetration 3 --brush-radius ";
  const std::string small = palpate(session + "0.5").text;
  CHECK_MESSAGE(
      says(small, fmt::format("a tool of 0.5 mm is smaller than the spacing of the points, {:.3g} mm", spacing_mm)),
      small);
  CHECK(says(small, fmt::format("make --brush-radius {:.3g} mm or more", 2 * spacing_mm)));
  CHECK(lacks(palpate(session + "9").text, "smaller than the spacing"));
  CHECK(lacks(palpate("touch " + model + " --backend cpu --brush-radius 0.5").text, "smaller than the spacing"));
}

}  // namespace palpate::command_line_test
