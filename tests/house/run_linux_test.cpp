// tests/run.sh with a build and tests that are not there: every leg runs, and the end says what failed.
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>

#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_folder.hpp"

namespace palpate {

namespace {

namespace fs = std::filesystem;

struct Run {
  int code = 0;
  std::string text;
};

void writeProgram(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << "#!/usr/bin/env bash\n" << text;
  fs::permissions(file, fs::perms::owner_all);
}

/// `cmake`, `ctest`: what stands for them, in bash; the preset is $preset.
Run runLegs(const std::string& cmake, const std::string& ctest, bool hasDrivers = true) {
  const ScratchFolder folder;
  const std::string preset =
      "preset=$(printf '%s\\n' \"$@\" | sed -E 's,^build/(.*)/tests$,\\1,' | grep -m 1 -xE 'dev|asan|tsan')\n";
  const std::string told =
      "echo \"$(basename \"$0\") $* threads=${LP_NUM_THREADS:-}${LP_NATIVE_VECTOR_WIDTH:+ of $LP_NATIVE_VECTOR_WIDTH "
      "bits}\"\n"
      "[ -z \"${VK_DRIVER_FILES:-}\" ] || echo driver=$VK_DRIVER_FILES $PALPATE_GPU\n"
      "[ -z \"${VK_LAYER_PATH:-}\" ] || echo layer=$VK_LAYER_PATH $PALPATE_TESTS_VALIDATE\n";
  writeProgram(folder / "bin/cmake", preset + told + cmake);
  writeProgram(folder / "bin/ctest", preset + told + ctest);
  writeProgram(folder / "third_party/install.sh", "");
  if (hasDrivers) writeProgram(folder / "third_party/drivers.sh", "echo other/drivers\n");
  writeProgram(folder / "third_party/windows.sh", "echo 'windows.sh: no wine here'; exit 1\n");
  fs::create_directories(folder / "tests");
  fs::copy_file(sourceFolder() / "tests/run.sh", folder / "tests/run.sh");
  const std::string command = "env -u PALPATE_GPU PATH='" + (folder / "bin").string() + ":'\"$PATH\" bash '" +
                              (folder / "tests/run.sh").string() + "' 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  Run run;
  std::array<char, 4096> piece;
  while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), pipe)) run.text.append(piece.data(), size);
  const int status = ::pclose(pipe);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return run;
}

bool hasSources() {
  if (fs::exists(sourceFolder() / "tests/run.sh")) return true;
  MESSAGE("skipped: the sources are not at " << sourceFolder().string());
  return false;
}

}  // namespace

TEST_CASE("run.sh runs every leg, the GPU's passes also with one driver thread and subgroups of four") {
  if (!hasSources()) return;
  const Run run = runLegs("", "");
  CHECK(run.code == 0);
  CHECK(says(run.text, "ctest --preset asan -j 2 --no-tests=error -L ^host$ -LE ^waits$ threads=\n"));
  CHECK(says(run.text,
             "ctest --test-dir build/asan/tests -j 2 --no-tests=error --output-on-failure -L ^waits$ threads=\n"));
  CHECK(says(run.text, "ctest --preset tsan -j 2 --no-tests=error -R ^(haptics\\.|core\\.latest_value$) threads=\n"));
  CHECK(says(run.text,
             "(spatial|contact|edit|mesh|motion_gpu)\\.(gpu|hash_compaction)$|^matter_gpu\\.portable$ threads=1 of 128 "
             "bits\n"));
  CHECK(says(run.text, "ctest --preset dev -j 2 --no-tests=error -LE ^(host|waits)$ threads=\n"));
  CHECK(says(
      run.text,
      "ctest --test-dir build/dev/tests -j 2 --no-tests=error --output-on-failure -LE ^host$ -L ^waits$ threads=\n"));
  CHECK(says(run.text, "-C portable -L ^portable$ threads=\ndriver=other/drivers/swiftshader.json SwiftShader\n"));
  CHECK(says(run.text, "-C portable -L ^portable$ threads=\nlayer=other/drivers core\n"));
  CHECK(says(run.text, "run.sh: every leg passed"));
  CHECK(run.text.find("skipped: on SwiftShader") == std::string::npos);
  CHECK(says(run.text, "run.sh: skipped: for Windows: windows.sh: no wine here\n"));
}

TEST_CASE("run.sh says which legs it skips, where another driver cannot be had") {
  if (!hasSources()) return;
  const Run run = runLegs("", "", false);
  CHECK(run.code == 0);
  CHECK(says(run.text, "run.sh: skipped: on SwiftShader, and under a current validation layer"));
  CHECK(run.text.find("driver=") == std::string::npos);
  CHECK(run.text.find("layer=") == std::string::npos);
}

TEST_CASE("a leg of run.sh that fails hides none behind it, and the last lines name what failed") {
  if (!hasSources()) return;
  const Run run = runLegs("",
                          "if [ $preset = dev ]; then exit 0; fi\n"
                          "mkdir -p build/$preset/Testing/Temporary\n"
                          "printf '3:%s.one\\n17:%s.two\\n' $preset $preset > "
                          "build/$preset/Testing/Temporary/LastTestsFailed.log\nexit 8\n");
  CHECK(run.code == 1);
  CHECK(says(run.text, "ctest --preset dev -j 2 --no-tests=error -LE ^(host|waits)$ threads=\n"));
  CHECK(says(run.text, "run.sh: failed: without Vulkan, under AddressSanitizer and UBSan: asan.one asan.two\n"));
  CHECK(says(run.text, "run.sh: failed: under ThreadSanitizer: tsan.one tsan.two\n"));
  CHECK(run.text.find("failed: all") == std::string::npos);
  CHECK(run.text.find("every leg passed") == std::string::npos);
}

TEST_CASE("run.sh tries again, alone, what is held against the wall clock and nothing else") {
  if (!hasSources()) return;
  // Each test fails in the first run of a leg, which is one of two at a time.
  const auto failing = [](const std::string& names) {
    return "if [ $preset != asan ]; then exit 0; fi\n"
           "case \"$*\" in *' -N -L ^clock$'*) printf '  Test  #3: asan.late\\n  Test #12: asan.later\\n'; exit 0 ;; "
           "esac\n"
           "case \"$*\" in *' -j 2 '*) ;; *) exit 0 ;; esac\n"
           "mkdir -p build/$preset/Testing/Temporary\n"
           "printf '" +
           names + "' > build/$preset/Testing/Temporary/LastTestsFailed.log\nexit 8\n";
  };
  const std::string leg = "without Vulkan, under AddressSanitizer and UBSan";
  const Run late = runLegs("", failing("3:asan.late\\n12:asan.later\\n"));
  CHECK(late.code == 0);
  CHECK(says(late.text, "ctest --preset asan -L ^host$ -LE ^waits$ -R ^(asan\\.late|asan\\.later)$ threads=\n"));
  CHECK(says(late.text, "run.sh: passed at the second try, alone: " + leg + ": asan.late asan.later\n"));
  const Run wrong = runLegs("", failing("3:asan.late\\n5:asan.wrong\\n"));
  CHECK(wrong.code == 1);
  CHECK(wrong.text.find("second try") == std::string::npos);
  CHECK(says(wrong.text, "run.sh: failed: " + leg + ": asan.late asan.wrong\n"));
}

TEST_CASE(
    "run.sh has what waits for most of its time beside the others, and tries it again, alone, where it fails there") {
  if (!hasSources()) return;
  const std::string leg = "waiting, beside what is tried with a GPU";
  const std::string sanitized = "without Vulkan, under AddressSanitizer and UBSan";
  // It has not ended when the others have.
  const Run beside = runLegs("",
                             "case \"$*\" in *test-dir*) until [ -e $preset.others ]; do sleep 0.05; done ;; *' -LE "
                             "'*) touch $preset.others ;; esac\n");
  CHECK(beside.code == 0);
  CHECK(says(beside.text, "== " + leg + ": passed"));
  CHECK(says(beside.text, "== waiting, beside what is tried " + sanitized + ": passed"));
  CHECK(beside.text.find("ctest --preset dev -j 2 --no-tests=error -LE ^host$ -L ^waits$") == std::string::npos);
  CHECK(beside.text.find("ctest --preset asan -j 2 --no-tests=error -L ^waits$") == std::string::npos);
  // One that ends without saying what has failed.
  const Run late = runLegs("", "case \"$*\" in *build/dev*) exit 8 ;; esac\n");
  CHECK(late.code == 0);
  CHECK(says(late.text, "ctest --preset dev -j 2 --no-tests=error -LE ^host$ -L ^waits$ threads=\n"));
  CHECK(says(late.text, "run.sh: passed at the second try, alone: " + leg + "\n"));
  // What has failed is tried again, and what has not is not.
  const std::string named =
      "case \"$*\" in *build/asan*) mkdir -p build/asan/tests/Testing/Temporary\n"
      "printf '3:asan.late\\n12:asan.later\\n' > build/asan/tests/Testing/Temporary/LastTestsFailed.log; exit 8 ;; "
      "esac\n";
  const std::string again = "ctest --preset asan -j 2 --no-tests=error -R ^(asan\\.late|asan\\.later)$ threads=\n";
  const Run some = runLegs("", named);
  CHECK(some.code == 0);
  CHECK(says(some.text, again));
  CHECK(says(some.text, "run.sh: passed at the second try, alone: waiting, beside what is tried " + sanitized +
                            ": asan.late asan.later\n"));
  const Run wrong = runLegs("", named + "case \"$*\" in *'-R ^(asan'*) exit 8 ;; esac\n");
  CHECK(wrong.code == 1);
  CHECK(says(wrong.text, again));
  CHECK(says(wrong.text, "run.sh: failed: waiting, " + sanitized + "\n"));
  const Run unbuilt = runLegs("case \"$*\" in *'--preset dev --target'*) exit 1 ;; esac\n", "");
  CHECK(unbuilt.code == 1);
  CHECK(unbuilt.text.find("test-dir build/dev") == std::string::npos);
  CHECK(says(unbuilt.text, "run.sh: failed: " + leg + ": not run, not built\n"));
}

TEST_CASE("run.sh says of tests that were not built that they did not run, and runs the others") {
  if (!hasSources()) return;
  const Run run =
      runLegs("if [ \"$*\" = '--build --preset tsan --target tests_haptics tests_core' ]; then exit 1; fi\n", "");
  CHECK(run.code == 1);
  CHECK(run.text.find("ctest --preset tsan") == std::string::npos);
  CHECK(says(run.text, "ctest --preset dev -j 2 --no-tests=error -LE ^(host|waits)$ threads=\n"));
  CHECK(says(run.text, "run.sh: failed: build for ThreadSanitizer\n"));
  CHECK(says(run.text, "run.sh: failed: under ThreadSanitizer: not run, not built\n"));
}

}  // namespace palpate
