/** @file
 * palpate's C interface: palpate's own servo thread, with a haptic device. palpate.h includes this. */
#ifndef PALPATE_LIVE_H
#define PALPATE_LIVE_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup live Live sessions: palpate's own servo thread, with a haptic device
 * @{ */

/** Device, path, rate and force law of a live hand. */
typedef struct pp_live_options {
  uint32_t size;           /**< bytes of this struct */
  uint32_t reserved;       /**< not used */
  const char* device;      /**< openhaptics[:NAME] dhd[:NUMBER] haply[:SERIAL] hid[:WHICH] sim replay:FILE path;
                                null: path */
  const char* builtin;     /**< for sim and path: "press", "slide", "scan" or "orbit", instead of `path` */
  const pp_path* path;     /**< for path: followed against the clock, after which the hand stays; copied */
  double rate_Hz;          /**< ticks per second; 0: the session's */
  pp_force_law law;        /**< null: the session's */
  void* law_user;          /**< passed to `law` */
  const char* law_library; /**< null: the session's */
  /** Next hand, if the session has several: its device, builtin, path, axes, and its own `next`. Only the first hand
   * has a rate and a force law. The ticks run at the first hand's pace, even with a device whose driver would call
   * them. */
  const struct pp_live_options* next;
  /** Axes of a hand-held device that point right, up and towards the user, as in "x,z,-y"; null: as its user agreed to
   * after the guided test, else the device's own. */
  const char* axes;
} pp_live_options;
PP_OPTIONS(live_options)
/** Starts ticks against the wall clock, on a thread of palpate. Until pp_live_stop() the session accepts calls that
 * look at it, and commands: pp_session_set_brush(), pp_session_set_contact(), undo and redo, pp_session_record() and
 * pp_session_cloud(). A command takes effect between two ticks; meanwhile the hand keeps the planes that it felt last.
 * These calls wait for those of other threads, and for a tick, 15 s at most: then PP_ERROR_TIMEOUT. A contact is never
 * stiffer than what the user of a hand-held device agreed to after its guided test. Options may be null.
 * PP_ERROR_ARGUMENT for an unknown device, or axes that are not a permutation or of a device that is not in a hand;
 * PP_ERROR_DEVICE if a device or its driver cannot be opened, as while another program uses it. */
PP_API pp_status pp_live_start(pp_session session, const pp_live_options* options);
/** Arrays of the program for the ticks of a live session, of `capacity` rows each; null: not wanted. */
typedef struct pp_live_rows {
  uint32_t size;       /**< bytes of this struct */
  uint32_t reserved;   /**< not used */
  uint64_t capacity;   /**< rows for which there is room; with several hands each tick has a row for each of them */
  pp_tick* ticks;      /**< required */
  double* torques_mNm; /**< torques of tools and of balls in matter about the HIP, 3 for each row */
  double* ages_s;      /**< as pp_contact.age_s */
} pp_live_rows;
PP_OPTIONS(live_rows)
/** pp_live_read_ticks() with all that is known of a tick. */
PP_API pp_status pp_live_read_rows(pp_session session, const pp_live_rows* rows, uint64_t* count);
/** Copies the ticks since the last call, up to `capacity`, and takes in the edits. With several hands `capacity` and
 * `count` are numbers of rows, as for pp_session_touch_hands(), of whole ticks. Ticks not read for half a minute at 1
 * kHz are dropped. If the live session has ended because of a fault, returns PP_ERROR_DEVICE or PP_ERROR_GPU once no
 * ticks are left. Returns PP_ERROR_NETWORK, with the ticks, as pp_session_apply_edits() does. PP_ERROR_STATE if the
 * session was never live. */
PP_API pp_status pp_live_read_ticks(pp_session session, pp_tick* ticks, uint64_t capacity, uint64_t* count);

/** State of a live session. */
typedef struct pp_live_state {
  uint32_t size;    /**< bytes of this struct */
  uint32_t running; /**< 0: it has ended, or was never started */
  uint64_t ticks;   /**< ticks of this live session read so far */
  uint64_t missed;  /**< ticks missed, because their time had passed, before the last one read */
} pp_live_state;
PP_OPTIONS(live_state)
/** State of the present or last live session. */
PP_API pp_status pp_live_get_state(pp_session session, pp_live_state* state);
/** Switches the force off while `on` is 0. When it is 1 again, the force waits, as at the start of a session, until the
 * surface would push with less than 0.1 N, as once the hand has left it, and then ramps up over half a second. May be
 * called from any thread, at the same time as any other call.
 *
 * With a device in a hand, or sim, a signal that asks the program to end, or a crash, takes the force away before the
 * program's own handler runs; on Windows Ctrl+C and its like. If the program goes on, the ticks report a force of 0
 * until this is called with 1. A handler that the program installs during a live session is kept, and runs first; from
 * the next live session on it runs after the force is gone. A path moves no motor: its ticks report the force that a
 * hand there would feel, whatever the signal, and the program's signals are left alone. */
PP_API pp_status pp_live_set_forces(pp_session session, uint32_t on);
/** Stops the live session after the tick in progress; the device has no force afterwards. Ticks not read yet can still
 * be read. */
PP_API pp_status pp_live_stop(pp_session session);

/** @} */

#endif
