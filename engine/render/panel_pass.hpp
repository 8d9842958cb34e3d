#pragma once

#include <span>
#include <vector>

#include "engine/gpu/command_list.hpp"
#include "shaders/shared/panels.h"

namespace palpate {

/// Panels over a picture: triangles in drawing order, which index their vertices and clip rectangles (left, top, right,
/// bottom; pixels).
struct PanelShapes {
  std::span<const shared::PanelVertex> vertices;
  std::span<const shared::PanelTriangle> triangles;
  std::span<const Vec4> clips;
};

/// The triangles of each tile of a picture, in order: tile t has entries[starts[t]] to entries[starts[t + 1]]
/// (exclusive); tiles are in rows from the top left.
struct PanelTiles {
  std::vector<std::uint32_t> starts, entries;
};
/// A triangle is listed in the tiles that it or its adjacent pixels reach. Triangles without area, with coordinates
/// that are not finite, or outside their clip rectangle are not listed.
PanelTiles tilesOf(const PanelShapes& shapes, const UVec2& size_px);
/// A checksum of each tile's content.
std::vector<std::uint64_t> checksumsOf(const PanelShapes& shapes, const PanelTiles& tiles);

/// Composes panels and a picture into the image that a window shows. Uses compute only, so no graphics pipeline is
/// required. The panels have a layer of their own, of which only changed tiles are drawn again. Part of the sight side.
class PanelPass {
 public:
  /// `texture`: coverage of each texel, texture_px.x * texture_px.y bytes in rows from the top.
  PanelPass(Device& device, std::span<const std::uint8_t> texture, const UVec2& texture_px);

  /// Replaces the texture for the next recordings. Earlier recordings must be complete.
  void setTexture(std::span<const std::uint8_t> texture, const UVec2& texture_px);

  /// `picture`: RGBA8 of size_px, or, if each of its pixels covers `shrink` x `shrink` of them, that much smaller,
  /// rounded up; null: only `background`. `shown`: size_px, BGRA8 if `blueFirst`. Earlier recordings must be complete.
  void record(CommandList& list, const Buffer* picture, std::uint32_t shrink, const PanelShapes& shapes,
              const UVec2& size_px, const Buffer& shown, std::uint32_t background, bool blueFirst);

 private:
  void recordLayer(CommandList& list, const PanelShapes& shapes, const UVec2& size_px);

  Device& device_;
  UVec2 texture_px_{0};
  ComputePipeline makeLayer_, compose_;
  Buffer texture_, vertices_, triangles_, clips_, starts_, entries_, tiles_, layer_;
  UVec2 layer_px_{0};
  std::vector<std::uint64_t> made_;  // checksums of the layer's tiles
};

}  // namespace palpate
