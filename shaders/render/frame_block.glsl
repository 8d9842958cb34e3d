// The constants of the picture that is drawn, which all of its passes read (CommandList::use).
#ifndef PALPATE_RENDER_FRAME_BLOCK_GLSL
#define PALPATE_RENDER_FRAME_BLOCK_GLSL
#extension GL_EXT_scalar_block_layout : require
#include "shaders/shared/render.h"

layout(set = 0, binding = 0, scalar) uniform FrameBlock { RenderFrame frame; };

#endif
