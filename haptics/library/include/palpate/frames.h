/* palpate's C interface: a cloud whose frames a program brings, as those of a camera or of a simulation of its own.
 * palpate.h includes this. */
#ifndef PALPATE_FRAMES_H
#define PALPATE_FRAMES_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which has this"
#endif

typedef struct pp_frames_options {
  uint32_t size;
  uint32_t keeps_points; /* 1: a point has its row in all frames, which have as many; 0: nothing is known of which is
                            which */
  uint64_t most_points;  /* of a frame; 0: as many as the cloud has */
} pp_frames_options;
PP_OPTIONS(frames_options)
/* The cloud stands still until the first frame. It cannot be sculpted, and is in no session log. Time goes on from path
 * to path; a live session begins at 0 with the newest frame, and so does the first path after it. Options may be null.
 */
PP_API pp_status pp_session_open_frames(pp_cloud cloud, const pp_frames_options* frames,
                                        const pp_session_options* options, pp_session* session);

typedef struct pp_frame_arrays {
  uint32_t size;
  uint32_t reserved;
  uint64_t count;    /* points, 1 and more */
  double t_s;        /* that they are true for, in the time of the session's ticks; after that of the frame before */
  pp_rows positions; /* x y z, PP_FLOAT32 or PP_FLOAT64, file coordinates of the cloud */
  pp_rows normals;   /* as these; made unit length; needed */
  pp_rows
      velocities; /* model units per second, with which points go on for 50 ms; none: they stand still between frames */
} pp_frame_arrays;
PP_OPTIONS(frame_arrays)
/* Copies the arrays. From that time on the points are felt there. From any thread, beside any other call. */
PP_API pp_status pp_session_push_frame(pp_session session, const pp_frame_arrays* frame);

typedef struct pp_stream_options {
  uint32_t size;
  uint32_t loop; /* 1: after the last frame it begins again */
  uint32_t fuse; /* 1: frames become one map; 0: the newest one is the cloud */
  uint32_t reserved;
  double speed;           /* seconds of the recording in one of the session's */
  double depth_scale;     /* depth values per metre; 0: as the folder says */
  const char* intrinsics; /* a JSON file; null: as the folder says */
} pp_stream_options;
PP_OPTIONS(stream_options)
/* A recorded depth camera: a folder as the TUM benchmark or Redwood lay it out, whose points are in metres. Each frame
 * is felt once its time has come, and none is left out; a session begins with the first one, and a live session does.
 * It cannot be sculpted. Options may be null. */
PP_API pp_status pp_session_open_stream(const char* folder, const pp_stream_options* stream,
                                        const pp_session_options* options, pp_session* session);

#endif
