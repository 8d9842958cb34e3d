// Lets C++ and GLSL read the same struct. Every shared struct has scalar layout: a vec3 takes 12 bytes and aligns to 4,
// an address takes 8 and aligns to 8. PALPATE_SIZE with its bytes follows each struct, so that a C++ compiler stops
// where the layouts differ.
#ifndef PALPATE_SHARED_TYPES_H
#define PALPATE_SHARED_TYPES_H
#include "shaders/shared/real.h"

#ifdef __cplusplus
#include <cstdint>

#include <glm/common.hpp>

#include "engine/core/vec.hpp"

#define PALPATE_SIZE(type, bytes) static_assert(sizeof(type) == (bytes))
#define PALPATE_ADDRESS(reference) std::uint64_t
#ifdef __CUDACC__
#define PALPATE_FUNCTION inline __host__ __device__
#else
#define PALPATE_FUNCTION inline
#endif

namespace palpate::shared {
using uint = std::uint32_t;
using vec2 = Vec2;
using vec3 = Vec3;
using vec4 = Vec4;
using ivec3 = IVec3;
using uvec2 = UVec2;
using uvec3 = UVec3;
using mat4 = Mat4;
using glm::clamp;
using glm::floatBitsToUint;
using glm::floor;
}  // namespace palpate::shared
#else
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require

#define PALPATE_SIZE(type, bytes)
#define PALPATE_ADDRESS(reference) reference
#define PALPATE_FUNCTION

// A reference type that is itself stored in memory declares an alignment of 8, as addresses have there: glslang aligns
// the load of an address to the type it refers to.
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Uints { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer UVec2s { uvec2 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Vec4s { vec4 at[]; };
#endif

#endif
