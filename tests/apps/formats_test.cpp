// A file of every format is opened by touch, info and render.
#include "tests/apps/every_format.hpp"
#include "tests/apps/program.hpp"

namespace palpate::formats_test {

TEST_CASE("info, touch and render open a file of every format" * kMoreInFull) {
  const ScratchFolder folder;
  const std::map<std::string, std::filesystem::path> files = filesOfAllFormats(folder.path());
  const std::string json = (folder / "a.json").string(), picture = (folder / "a.png").string();
  for (const CloudFormat& format : cloudFormats().all()) {
    if (!format.read) continue;
    CAPTURE(std::string(format.name));
    REQUIRE(files.contains(std::string(format.name)));
    const std::filesystem::path& file = files.at(std::string(format.name));
    CHECK(&cloudFormats().toRead(file) == &format);
    works("info " + file.string() + " --quiet --json " + json);
    CHECK(jsonOf(json)["points"] > 0);
    const bool isDear = becomesMany(std::string(format.name)) && !inFullTier();
    if (isDear && format.name != "glTF") continue;
    works("touch " + file.string() + " --backend cpu --path builtin:press --rate 250 --quiet --json " + json);
    CHECK(jsonOf(json)["ticks"] > 0);
    if (format.write) CHECK(jsonOf(json)["contact_ticks"] > 0);  // the other files are not balls
    if (isDear) continue;
    std::filesystem::remove(picture);
    works("render " + file.string() + " --size 64x64 --quiet -o " + picture);
    CHECK(std::filesystem::file_size(picture) > 100);
  }
}

}  // namespace palpate::formats_test
