#include "apps/cli/fused_folder.hpp"

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/motion/frame_fusion.hpp"

namespace palpate {

namespace {

// Returns false at the end.
bool readNext(RgbdFolder& stream, FrameFusion& fusion, DepthFrame& frame) {
  for (;;) {
    try {
      return stream.next(frame);
    } catch (const Error& error) {
      fusion.countLost(error.what());
    }
  }
}

}  // namespace

FusedFolder readFused(Context& context, const std::filesystem::path& folder, const RgbdOptions& options) {
  Log& log = context.log();
  RgbdFolder stream(folder, options, &log);
  FusionOptions fusionOptions;
  fusionOptions.threads = context.threads();
  FrameFusion fusion(fusionOptions, {}, &log);
  DepthFrame frame;
  for (double done = 1; readNext(stream, fusion, frame); ++done) {
    fusion.fuse(stream.camera(), frame);
    log.progress("fusing", done / static_cast<double>(stream.frames()));
  }
  log.endProgress();
  FusedFolder fused{.stored = {.cloud = fusion.map().cloud()},
                    .kind = std::string(stream.kind()),
                    .frames = stream.frames(),
                    .fused = fusion.fused(),
                    .unplaced = fusion.unplaced(),
                    .lost = fusion.lost()};
  if (fused.stored.cloud.empty())
    throw FileError(folder, fmt::format("its {} frames show no surface: {} were fused, {} could not be placed, {} not "
                                        "read; check the depth scale ({} values a metre) and the intrinsics",
                                        fused.frames, fused.fused, fused.unplaced, fused.lost, stream.depthScale()));
  log.say("{}: {} of {} frames fused into {}, in metres", folder.string(), fused.fused, fused.frames,
          counted(fused.stored.cloud.size(), "point"));
  return fused;
}

}  // namespace palpate
