/** @file
 * palpate's C interface: session logs, which record what a hand did and felt and how it changed the points, so that the
 * session can be replayed. palpate.h includes this. */
#ifndef PALPATE_LOGS_H
#define PALPATE_LOGS_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup logs Session logs
 * @{ */

/** Writes the next path of the session, or its next live session, to `file`, up to its end; while the session is live,
 * the rest of it, with all commands. A log begins with the
 * points as they were opened and names the file from which they can be loaded. It holds one hand, without a force law
 * of the program. Errors while writing are reported to the session's log function, and the call that ends the log gives
 * PP_ERROR_FILE. PP_ERROR_STATE for a session of several hands, with a force law of the program, whose points have been
 * edited, or whose model cannot be recorded. */
PP_API pp_status pp_session_record(pp_session session, const char* file);

/** Handle of a log that was read. */
typedef struct pp_recording {
  uint64_t id; /**< 0 is null */
} pp_recording;

/** One tick of a log. */
typedef struct pp_recording_tick {
  double t_s;       /**< time of the tick, s */
  double device[3]; /**< position of the stylus, in the device's own unit: mm for hardware, model units for a path */
  double orientation[4]; /**< orientation of the stylus: unit quaternion w x y z */
  double proxy[3];       /**< position of the proxy, model units */
  double force_N[3];     /**< force on the hand, N */
  uint64_t edits;        /**< number of edits of the log before the tick's answer */
  uint32_t neighbours;   /**< points within the support radius */
  uint32_t buttons;      /**< pressed buttons, as bits; the first one is 1 */
  uint8_t contact;       /**< 1: the hand touched the surface */
  uint8_t fresh;         /**< 1: from this tick's own query; 0: bridged, because the answer was late */
  uint8_t valid;         /**< 0: a fault occurred, and the force was zero */
  uint8_t put_down;      /**< 1: the stylus was lifted before this tick, and put down elsewhere */
  uint8_t forceless;     /**< 1: the device applied no force */
  uint8_t edit_dropped;  /**< 1: an edit that the answer requested was dropped */
  uint8_t reserved[2];   /**< not used */
} pp_recording_tick;

/** State of a point after an edit. */
typedef struct pp_recording_edit {
  uint32_t point;    /**< number of the point in the file; new points are numbered after those of the file */
  uint32_t parent;   /**< point whose other properties it has; itself for a point of the file */
  float position[3]; /**< model units, relative to the origin of the cloud */
  float normal[3];   /**< unit length */
  uint8_t color[4];  /**< red green blue alpha; 0 if the cloud has no colours */
  uint32_t gone;     /**< 1: the point was removed */
} pp_recording_edit;

/** View of a log. */
typedef struct pp_recording_content {
  uint64_t ticks;                /**< number of ticks */
  uint64_t edits;                /**< number of edits */
  const pp_recording_tick* tick; /**< the ticks, in order of time */
  const pp_recording_edit* edit; /**< the edits, in order of time */
  const char* header;            /**< how to replay the session, as JSON */
  const char* missing;           /**< missing parts of the log, one per line; empty if it is complete */
  uint64_t points;               /**< points of the model */
  uint64_t lost_ticks;           /**< ticks not in the log, because its thread fell behind */
  uint64_t merged_edits;         /**< edits superseded by later ones of the same point */
  /** From the device's unit to model units: map_scale * device + map_offset, until a clutch was used. */
  double map_scale;
  double map_offset[3]; /**< model units; see map_scale */
  uint32_t ended;       /**< 1: the log includes the end of the session */
  uint32_t reserved;    /**< not used */
} pp_recording_content;

/** Reads a log. Of a log that is damaged, or was cut off by a crash, all complete parts are read. PP_ERROR_FILE if it
 * cannot be read at all. */
PP_API pp_status pp_recording_read(const char* file, pp_recording* log);
/** Read-only view of the log; nothing is copied. Valid until the log is closed. */
PP_API pp_status pp_recording_view(pp_recording log, pp_recording_content* content);
/** Closes the handle and invalidates its views. */
PP_API pp_status pp_recording_close(pp_recording log);

/** How pp_recording_replay() replays a session. */
typedef struct pp_replay_options {
  uint32_t size;       /**< bytes of this struct */
  uint32_t threads;    /**< threads of the CPU; 0: one per core */
  const char* gpu;     /**< GPU to use, if the session was on one; null: the best available */
  const char* model;   /**< file of the model; null: the file that the log names */
  pp_cloud cloud;      /**< the model itself, instead of a file; null: none */
  double tolerance;    /**< maximum difference, N for forces and mm for points; 0: identical to the last bit */
  pp_log_function log; /**< receives messages; null: none */
  void* log_user;      /**< passed to `log` */
  pp_watch watch;      /**< watches this call */
} pp_replay_options;
PP_OPTIONS(replay_options)

/** How a replay differs from its log. */
typedef struct pp_replay_result {
  uint32_t size;             /**< bytes of this struct */
  uint32_t identical;        /**< 1: all ticks, and all points at the end, are the same within the tolerance */
  uint64_t ticks;            /**< ticks of the log */
  uint64_t compared;         /**< ticks compared; fewer than all if the session cannot be replayed exactly */
  uint64_t force_ticks;      /**< ticks whose forces differ */
  uint64_t edit_ticks;       /**< ticks between which the edits differ */
  uint64_t points;           /**< points that differ at the end */
  double largest_force_N;    /**< maximum difference of a force, N */
  double first_difference_s; /**< time of the first difference, s; negative: no difference */
  uint32_t ends_compared;    /**< 1: the points at the end were compared */
  /** 1: the edits of the log give the points at the end of the session; 2: they do not; 0: the log has no end. */
  uint32_t recorded_edits;
  char reason[192];      /**< reason why not all ticks, or not the points at the end, were compared; empty: all were */
  char machine[112];     /**< name of the machine that replayed; cut off to fit */
  char recorded_on[112]; /**< name of the machine that recorded; cut off to fit */
} pp_replay_result;
PP_OPTIONS(replay_result)
/** Replays a recorded session in virtual time and compares it with the log. Returns PP_OK even if it differs: see the
 * result. PP_ERROR_FILE if the model is not the recorded one. */
PP_API pp_status pp_recording_replay(const char* file, const pp_replay_options* options, pp_replay_result* result);

/** @} */

#endif
