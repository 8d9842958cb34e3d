// The shaders of the study alone, as tests/gpu/all_pipelines_test.cpp does with all others.
#include <doctest/doctest.h>

#include "shaders/study.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/shader_pipelines.hpp"

namespace palpate::study_pipelines_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

class StudyPipelinesFixture : protected GpuFixture {};

}  // namespace

TEST_CASE_FIXTURE(StudyPipelinesFixture, "every compute shader of the slower query methods compiles into a pipeline") {
  CHECK(checkPipelines(device, shader_code::study) == 4);
}

TEST_SUITE_END();

}  // namespace palpate::study_pipelines_test
