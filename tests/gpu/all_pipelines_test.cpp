// Compiles every compute shader of the program on the present driver, including those whose pass may not be tested:
// validation examines each module, and the driver translates it.
#include <doctest/doctest.h>

#include "shaders/compiled.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/shader_pipelines.hpp"

namespace palpate::all_pipelines_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

class AllPipelinesFixture : protected GpuFixture {};

}  // namespace

TEST_CASE_FIXTURE(AllPipelinesFixture, "every compute shader compiles into a pipeline") {
  CHECK(checkPipelines(device, shader_code::compiled) > 60);
}

TEST_SUITE_END();

}  // namespace palpate::all_pipelines_test
