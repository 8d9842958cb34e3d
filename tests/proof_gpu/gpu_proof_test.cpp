// A GPU is right in every primitive, and each wrong is found and named.
#include "engine/proof/gpu_proof.hpp"

#include "engine/core/named_values.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::gpu_proof_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE_FIXTURE(GpuFixture, "every primitive of this GPU gives the known results, each reported as it ends") {
  std::vector<std::string> reported;
  const GpuProof proof = proveGpu(device, {.proved = [&](const ProvedPrimitive& each) {
                                    reported.emplace_back(nameOf(kPrimitives, each.primitive));
                                  }});
  CHECK(reported == namesOf(kPrimitives));
  CHECK(proof.subgroupSize == device.subgroupSize());
  for (const ProvedPrimitive& each : proof.primitives) CHECK_MESSAGE(each.wrong.empty(), each.wrong);
  CHECK(proof.wrong().empty());
  CHECK(proof.run_ms() > 0);
}

TEST_CASE_FIXTURE(GpuFixture, "a primitive that fails is found and named, and no other one") {
  for (const auto& [name, primitive] : kPrimitives) {
    CAPTURE(name);
    const GpuProof proof = proveGpu(device, {.fails = primitive});
    CHECK(proof.wrong() == name);
    for (const ProvedPrimitive& each : proof.primitives) CHECK(each.wrong.empty() == (each.primitive != primitive));
  }
}

TEST_SUITE_END();

}  // namespace palpate::gpu_proof_test
