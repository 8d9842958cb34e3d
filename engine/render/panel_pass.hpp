#pragma once

#include <span>
#include <vector>

#include "engine/gpu/command_list.hpp"
#include "shaders/shared/panels.h"

namespace palpate {

/// What lies over a picture: triangles from the lowest to the uppermost, which name their vertices and the rectangle
/// that clips them (left, top, right, bottom; pixels).
struct PanelShapes {
  std::span<const shared::PanelVertex> vertices;
  std::span<const shared::PanelTriangle> triangles;
  std::span<const Vec4> clips;
};

/// The triangles of each tile of a picture, in their order: those of tile t are entries[starts[t]] to
/// entries[starts[t + 1]], tiles in rows from the top left.
struct PanelTiles {
  std::vector<std::uint32_t> starts, entries;
};
/// Triangles without area, with a place that is no number, or outside of their clip stand in no tile; the others in
/// those that they or the pixels next to them reach.
PanelTiles tilesOf(const PanelShapes& shapes, const UVec2& size_px);
/// A number for each tile that tells what it shows from anything else.
std::vector<std::uint64_t> checksumsOf(const PanelShapes& shapes, const PanelTiles& tiles);

/// Puts panels over a picture and makes of it what a window shows. In compute, so that it needs no graphics pipeline.
/// The panels have a layer of their own, of which only those tiles are made anew that show something else than before.
/// Belongs to the sight side.
class PanelPass {
 public:
  /// `texture`: how much of each texel is covered, texture_px.x * texture_px.y bytes in rows from the top.
  PanelPass(Device& device, std::span<const std::uint8_t> texture, const UVec2& texture_px);

  /// Another one from the next picture on. What was recorded before must be done.
  void setTexture(std::span<const std::uint8_t> texture, const UVec2& texture_px);

  /// `picture`: RGBA8, of size_px or, where each of its pixels covers `shrink` x `shrink` of them, rounded up; null for
  /// `background` alone. `shown`: size_px, BGRA8 where `blueFirst`. What was recorded before must
  /// have been submitted, and be done.
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
