// The shaders of matter alone, as tests/gpu/all_pipelines_test.cpp does with all others.
#include <doctest/doctest.h>

#include "shaders/simulation.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/shader_pipelines.hpp"

namespace palpate::matter_pipelines_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

class MatterPipelinesFixture : protected GpuFixture {};

}  // namespace

TEST_CASE_FIXTURE(MatterPipelinesFixture, "every compute shader of matter compiles into a pipeline") {
  CHECK(checkPipelines(device, shader_code::simulation) > 25);
}

TEST_SUITE_END();

}  // namespace palpate::matter_pipelines_test
