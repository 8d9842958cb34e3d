/** @file
 * palpate's C interface: sessions, their options and their state. palpate.h includes this. */
#ifndef PALPATE_SESSIONS_H
#define PALPATE_SESSIONS_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

#include <palpate/clouds.h>
#include <palpate/vulkan.h>

/** @defgroup sessions Sessions: a cloud that is felt, seen and sculpted
 * @{ */

/** Handle of a session. See the beginning of palpate.h for the threads that may use it. */
typedef struct pp_session {
  uint64_t id; /**< 0 is null */
} pp_session;

/** Position of a hand at a time. */
typedef struct pp_pose {
  double t_s;        /**< time, s */
  double hip[3];     /**< haptic interface point, model units */
  uint32_t no_edit;  /**< 1: only feels, even if the session has a brush */
  uint32_t reserved; /**< not used */
} pp_pose;

/** Answer of the surface to a pose. It is fresh (from the pose's own query), held (`valid` and not `fresh`: bridged
 * within the budget; the force fades as age_s grows, and is zero within 0.2 s) or none (not `valid`: a fault; no
 * force). */
typedef struct pp_contact {
  double proxy[3];       /**< position on the surface, model units; equals the HIP without contact */
  double normal[3];      /**< unit length, outward; zero if no surface was within reach */
  double force_N[3];     /**< force that the hand was given, N */
  double penetration_mm; /**< distance from HIP to proxy, mm; 0 without contact */
  uint32_t neighbours;   /**< points within the support radius */
  uint8_t contact;       /**< 1: the hand touches the surface */
  uint8_t fresh;         /**< 1: from this pose's own query; 0: bridged, because the answer would have been late */
  uint8_t valid;         /**< 0: a fault occurred, and the force is zero */
  /** 1: in contact, force_N is less than the surface's, because forces are off, or were gone: after at most 0.1 s
   * without an answer they return over half a second; after a longer absence, and after they were switched off, once
   * the hand has left the surface. A force law is given 0. */
  uint8_t withheld;
  double age_s; /**< age of the data from which it was computed, s: 0 if fresh; negative: there are none */
} pp_contact;

/** One tick of the haptic loop. */
typedef struct pp_tick {
  double t_s;            /**< time, s */
  double hip[3];         /**< haptic interface point, model units */
  double proxy[3];       /**< as in pp_contact, and so are the fields below */
  double normal[3];      /**< unit length, outward */
  double force_N[3];     /**< force that the hand was given, N */
  double penetration_mm; /**< distance from HIP to proxy, mm */
  uint32_t neighbours;   /**< points within the support radius */
  uint8_t contact;       /**< 1: the hand touches the surface */
  uint8_t fresh;         /**< 1: from this tick's own query; 0: bridged */
  uint8_t valid;         /**< 0: a fault occurred, and the force is zero */
  uint8_t withheld;      /**< 1: in contact, force_N is less than the surface's */
} pp_tick;

/** A force law of the program, in C or a compatible language: writes the force on the hand, N, for one tick of contact.
 * contact->force_N is the force of palpate's spring and damper. The limits of magnitude and rise still apply to the
 * result. Called on the servo thread in each tick: it must not allocate, wait or throw. A force that is not finite, or
 * whose length is not, counts as zero and is reported: pp_touch() fails with PP_ERROR_FAILED, a path at its end, with
 * all its ticks written; a live session warns when its ticks are read. */
typedef void (*pp_force_law)(void* user, const pp_pose* pose, const pp_contact* contact, double dt_s,
                             double force_N[3]);

/** Surface that the points define, and the force of the contact. */
typedef struct pp_contact_options {
  uint32_t size;             /**< bytes of this struct */
  uint32_t reserved;         /**< not used */
  const char* surface;       /**< "average", "sphere" or "sharp"; null: average */
  double friction;           /**< coefficient of sliding friction of the proxy; 0: none, at most 10 */
  double radius_mm;          /**< support radius; 0: from the spacing of the points. Fixed once the session is open. */
  double stiffness_N_per_mm; /**< of the spring from HIP to proxy, N/mm; default 0.8 */
  double damping_N_s_per_mm; /**< of the damper on its change, N s/mm; default 0.002 */
  double max_force_N;        /**< limit of the magnitude, N; default 3.3 */
  /** Motion of the stylus for a motion of the hand, of a live device that is held, 0.05 to 4; default 1. It changes
   * about where the stylus is: neither that nor the force changes at once. */
  double hand_gain;
} pp_contact_options;
PP_OPTIONS(contact_options)

/** Tool of a hand: one point, or many points that share the stiffness, each with its own proxy. */
typedef struct pp_tool {
  uint32_t size;    /**< bytes of this struct */
  uint32_t points;  /**< number of points of a pad, ball or spatula, 1 to 64 */
  const char* kind; /**< "point", "pad" (a fingertip), "ball" or "spatula"; null: point */
  double size_mm;   /**< diameter of a pad or ball, length of a spatula, mm */
  /** Direction of the face of a pad or spatula without rotation, in the model's axes; of any length but 0. */
  double axis[3];
} pp_tool;
PP_OPTIONS(tool)

/** Maximum number of hands in one session. */
#define PP_MAX_HANDS 8

/** How a session is opened. */
typedef struct pp_session_options {
  uint32_t size;    /**< bytes of this struct */
  uint32_t threads; /**< threads of the CPU; 0: one per core */
  const char* gpu;  /**< number or part of a name; "cpu": no GPU, double precision; null: a GPU if there is one */
  /** Millimetres in the hand per model unit, the scale of all lengths in mm (1 for a scan in mm that is felt at its own
   * size); 0: as the cloud says, or else the longest side becomes 100 mm, which is reported to the log. A length of L
   * model units is L * pp_session_info.mm_per_unit mm. */
  double mm_per_unit;
  uint32_t estimate_normals;         /**< 1: even if the cloud has normals */
  uint32_t reserved;                 /**< not used */
  double rate_Hz;                    /**< ticks per second; default 1000 */
  const pp_contact_options* contact; /**< null: pp_default_contact_options() */
  /** pp_touch(): time limit of an answer, us, after which the points around the hand that were kept last bridge it, or
   * a share of them if they are too many (pp_session_info.bridged_ticks, thinned_ticks); 0: no limit. */
  double budget_us;
  double undo_memory_MiB;  /**< memory of strokes that can be undone, MiB, default 1024; beyond it the oldest go */
  pp_force_law law;        /**< null: spring and damper */
  void* law_user;          /**< passed to `law` */
  const char* law_library; /**< "libmine.so:function": a force law to load, instead of `law` */
  pp_log_function log;     /**< receives messages until the session is closed; null: none */
  void* log_user;          /**< passed to `log` */
  uint32_t hands;          /**< simultaneous hands, 1 to PP_MAX_HANDS; the first one sculpts, the others feel; 0: 1 */
  uint32_t reserved2;      /**< not used */
  const pp_tool* tool;     /**< tool of the first hand; null: a point. The other hands touch with a point. */
  const pp_vulkan_device* vulkan; /**< a device of the program, instead of a GPU by name; null: none */
  /** Watches this call and the long calls on the session: paths, pp_session_set_brush(), undo and redo,
   * pp_session_cloud(), pictures, meshes, pp_session_settle() and pp_live_start(). */
  pp_watch watch;
  /** "vulkan" (a GPU), "cpu" (double precision), or "auto": "vulkan" if a GPU is named or there is one other than a
   * software driver, else "cpu"; null: auto. With auto, a budget_us and no named GPU, a cloud at rest is answered by
   * the one of both that takes less time for a tick with an edit: it is measured for up to two seconds, reported to
   * `log`, and remembered in the user's cache folder. PP_ERROR_ARGUMENT if it conflicts with `gpu` or `vulkan`. */
  const char* backend;
} pp_session_options;
PP_OPTIONS(session_options)
/** Opens a session and builds its index; normals are estimated if the cloud has none. Options may be null.
 * PP_ERROR_ARGUMENT for a cloud without points or an option out of bounds, PP_ERROR_GPU if no GPU has that name or it
 * lacks a feature, PP_ERROR_FAILED if the force law cannot be loaded. */
PP_API pp_status pp_session_open(pp_cloud cloud, const pp_session_options* options, pp_session* session);
/** Opens a session of a scene of moving matter, in millimetres: "water", "sand", "jelly" or another built-in scene,
 * "FILE in water", "FILE in sand" or "soft FILE" with a closed cloud or mesh, or a JSON file. Each hand holds a ball in
 * water and sand, and presses on the surface of a soft body, whose shape a brush changes. By path, its time advances by
 * the duration of each path and continues with the next one; with a budget, and live, it follows the clock. The scene
 * restarts when the time of the ticks goes back, and when a live session begins or has ended. Options may be null.
 * PP_ERROR_ARGUMENT for an unknown scene; otherwise as for pp_session_open(). */
PP_API pp_status pp_session_open_matter(const char* scene, const pp_session_options* options, pp_session* session);
/** Closes the session, and ends its live session. PP_ERROR_NETWORK: it is closed, but the server of a joined session
 * has not confirmed all strokes of this hand within pp_join_options.timeout_s, or 5 s if it is silent. */
PP_API pp_status pp_session_close(pp_session session);

/** Present state of a session. */
typedef struct pp_session_info {
  uint32_t size;          /**< bytes of this struct */
  uint32_t live;          /**< 1: a live session is running */
  uint64_t points;        /**< points of the cloud as opened */
  double mm_per_unit;     /**< millimetres in the hand per model unit */
  double spacing_mm;      /**< mean distance of neighbouring points, mm */
  double radius_mm;       /**< support radius, mm */
  double rate_Hz;         /**< ticks per second */
  uint64_t undo_count;    /**< strokes that can be undone, with one in progress, of the edits taken in so far */
  uint64_t redo_count;    /**< strokes that can be redone */
  uint64_t edits;         /**< states of points that brushes have made and that have been taken in so far */
  char backend[16];       /**< "vulkan" or "cpu" */
  char machine[112];      /**< name of the machine that answers; cut off to fit */
  uint64_t blocked_moves; /**< moves for which points had no room, before a side that stays; in each edit one a point */
  uint64_t blocked_edits; /**< edits in which nearly all points under the brush had no room: the part is too thin */
  /** Ticks whose own answer would have been late, so that the points around the hand that were kept last answered them;
   * the count restarts with the first brush. */
  uint64_t bridged_ticks;
  uint64_t thinned_ticks; /**< of them, those answered from only a share of these points, because they are too many */
} pp_session_info;
PP_OPTIONS(session_info)
/** Present state of the session. */
PP_API pp_status pp_session_get_info(pp_session session, pp_session_info* info);

/** @} */

#endif
