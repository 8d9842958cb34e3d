// Panels over a picture: triangles in pixels, one above the other (engine/render/panel_pass.hpp).
#ifndef PALPATE_SHARED_PANELS_H
#define PALPATE_SHARED_PANELS_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Side of a tile, pixels; one invocation for each pixel.
const uint kPanelTile_px = 16u;
const uint kPanelWorkgroup = kPanelTile_px * kPanelTile_px;

struct PanelVertex {
  vec2 place_px;  // from the top left corner
  vec2 uv;        // in the texture, 0 to 1
  uint color;     // RGBA8, not premultiplied
};
PALPATE_SIZE(PanelVertex, 20);

struct PanelTriangle {
  uvec3 vertices;
  uint clip;
};
PALPATE_SIZE(PanelTriangle, 16);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PanelVertices { PanelVertex at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PanelTriangles { PanelTriangle at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PanelClips { vec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PanelLayer { uvec2 at[]; };
#endif

// The layer over a picture, for each of its pixels: its own light, and the share of the light below that it lets
// through, in pairs of 16 bits from 0 to 1 (red and green, blue and through).
struct PanelLayerArgs {
  PALPATE_ADDRESS(PanelLayer) layer;  // out, size_px; only the tiles in `tiles`
  PALPATE_ADDRESS(PanelVertices) vertices;
  PALPATE_ADDRESS(PanelTriangles) triangles;
  PALPATE_ADDRESS(PanelClips) clips;  // left, top, right, bottom; pixels
  PALPATE_ADDRESS(Uints) starts;      // first entry of each tile; one more at the end
  PALPATE_ADDRESS(Uints) entries;     // triangles of the tiles, from the lowest to the topmost
  PALPATE_ADDRESS(Uints) tiles;       // tiles to draw
  PALPATE_ADDRESS(Uints) texture;     // coverage of each texel, 8 bits
  uvec2 size_px;
  uvec2 texture_px;
  uint tileCount;  // tiles to draw
};
PALPATE_SIZE(PanelLayerArgs, 88);

struct PanelComposeArgs {
  PALPATE_ADDRESS(Uints) picture;  // RGBA8; null: no picture, `background` is shown
  PALPATE_ADDRESS(PanelLayer) layer;
  PALPATE_ADDRESS(Uints) shown;  // out, size_px
  uvec2 size_px;
  uint background;  // RGBA8
  uint blueFirst;   // not 0: blue is in the lowest byte of `shown`
  uint shrink;      // pixels along each side that one pixel of the picture covers; more than 1: interpolated
  uint pictureWidth_px;
  uvec2 squares;  // of shrink x shrink pixels, across and down
};
PALPATE_SIZE(PanelComposeArgs, 56);
const uint kPanelNothing = 0xffff0000u;  // second word of the layer where all light from below comes through

PALPATE_SHARED_END
#endif
