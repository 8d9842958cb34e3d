// The formulas of the brushes on the GPU against double precision.
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/test_shaders.hpp"
#include "tests/edit/brush_questions.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::brush_gpu_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE_FIXTURE(GpuFixture, "every brush gives the same result on the GPU as in double precision") {
  constexpr double kSignedDistance = 0.3;
  const auto questions = randomQuestions(6000);
  std::vector<shared::BrushQuestion> asked;
  for (const BrushCase& question : questions) asked.push_back(question.asked);
  // One element more than needed: validation rounds the size of a struct up to a multiple of 16.
  const Buffer input = Buffer::of<shared::BrushQuestion>(device, asked.size() + 1, Memory::device, "questions");
  const Buffer output = Buffer::of<shared::BrushAnswer>(device, asked.size() + 1, Memory::device, "answers");
  upload(device, input, asked);
  const ComputePipeline pipeline(device, shader_code::edit_gpu_brush_probe,
                                 {.pushBytes = sizeof(shared::BrushProbeArgs)});
  const auto count = static_cast<std::uint32_t>(asked.size());
  CommandList list(device, device.latencyQueue(), "brushes");
  list.begin();
  list.dispatch(pipeline, count,
                shared::BrushProbeArgs{.questions = input.address(),
                                       .answers = output.address(),
                                       .count = count,
                                       .signedDistance = static_cast<float>(kSignedDistance)});
  list.end();
  device.latencyQueue().run(list);
  checkAgree(questions, download<shared::BrushAnswer>(device, output, asked.size()), kSignedDistance);
}

TEST_SUITE_END();

}  // namespace palpate::brush_gpu_test
