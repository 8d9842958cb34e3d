/** @file
 * palpate's C interface: clouds whose frames the program provides, such as those of a camera or of its own simulation.
 * palpate.h includes this. */
#ifndef PALPATE_FRAMES_H
#define PALPATE_FRAMES_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup frames Frames of the program, and of depth cameras
 * @{ */

/** How pp_session_open_frames() opens a session. */
typedef struct pp_frames_options {
  uint32_t size;        /**< bytes of this struct */
  uint32_t stable_rows; /**< 1: each point has the same row in all frames, which have the same size; 0: the rows of
                            different frames are unrelated */
  uint64_t max_points;  /**< maximum number of points of a frame, at least that of the cloud; 0: that of the cloud */
} pp_frames_options;
PP_OPTIONS(frames_options)
/** Opens a session of a cloud that is at rest until the first frame. It cannot be sculpted or recorded. Time continues
 * from path to path. A live session begins at 0 with the newest frame, and so does the first path after it. Options may
 * be null. PP_ERROR_ARGUMENT if max_points is less than the points of the cloud; otherwise as pp_session_open(). */
PP_API pp_status pp_session_open_frames(pp_cloud cloud, const pp_frames_options* frames,
                                        const pp_session_options* options, pp_session* session);

/** A frame of the program: the points, and the time from which they are valid. */
typedef struct pp_frame_arrays {
  uint32_t size;     /**< bytes of this struct */
  uint32_t reserved; /**< not used */
  uint64_t count;    /**< points, at least 1 */
  /** Time for which the positions are valid, in the time of the session's ticks; later than that of the frame before.
   */
  double t_s;
  pp_rows positions; /**< x y z, PP_FLOAT32 or PP_FLOAT64, file coordinates of the cloud */
  pp_rows normals;   /**< same types; are normalized; required */
  /** Model units per second, with which positions are extrapolated for up to 50 ms; if not given, the points are at
   * rest between frames. */
  pp_rows velocities;
} pp_frame_arrays;
PP_OPTIONS(frame_arrays)
/** Adds a frame, whose arrays are copied; the points are felt there from its time on. May be called from any thread, at
 * the same time as any other call. At most 1023 frames whose time has not come are kept: a further one replaces the
 * oldest of them. PP_ERROR_ARGUMENT if the normals are
 * missing, if a number is not finite, if there are too many points, or if the time is not later than that of the frame
 * before. */
PP_API pp_status pp_session_push_frame(pp_session session, const pp_frame_arrays* frame);

/** How pp_session_open_stream() plays a recorded depth camera. */
typedef struct pp_stream_options {
  uint32_t size;          /**< bytes of this struct */
  uint32_t loop;          /**< 1: restarts after the last frame */
  uint32_t fuse;          /**< 1: frames are fused into one map; 0: the newest frame is the cloud */
  uint32_t reserved;      /**< not used */
  double speed;           /**< seconds of the recording per second of the session */
  double depth_scale;     /**< depth values per metre; 0: as the folder says */
  const char* intrinsics; /**< a JSON file; null: as the folder says */
} pp_stream_options;
PP_OPTIONS(stream_options)
/** Opens a session of a recorded depth camera: a folder in the layout of TUM, ScanNet, Redwood, Replica or 7-Scenes,
 * with points in metres. Each frame is felt once its time has come, and no frame is skipped. A session, and each live
 * session, begins with the first frame. It cannot be sculpted. Options may be null. PP_ERROR_FILE if the folder has
 * another layout, or its lists are invalid. */
PP_API pp_status pp_session_open_stream(const char* folder, const pp_stream_options* stream,
                                        const pp_session_options* options, pp_session* session);

/** @} */

#endif
