/* palpate's C interface: session logs, of what a hand did and felt and what it did to the points, so that it can be run
 * again. palpate.h includes this. */
#ifndef PALPATE_LOGS_H
#define PALPATE_LOGS_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which has this"
#endif

/* The next path of the session, or its next live session, is written to `file`, with its end. A log begins with the
 * points as they were opened and says by which file they can be had again; it is of one hand, without a force law of
 * one's own. What cannot be written as it goes on is said in the session's remarks, and the call that ends it gives
 * PP_ERROR_FILE. */
PP_API pp_status pp_session_record(pp_session session, const char* file);

typedef struct pp_log {
  uint64_t id; /* 0 is null */
} pp_log;

typedef struct pp_log_tick {
  double t_s;
  double device[3];  /* of the stylus, in the device's own unit: mm of hardware, model units of a path */
  double turn[4];    /* of the stylus: unit quaternion w x y z */
  double proxy[3];   /* model units */
  double force_N[3]; /* on the hand */
  uint64_t edits;    /* of the log that came before the tick's answer */
  uint32_t neighbours;
  uint32_t buttons; /* pressed; the first one is 1 */
  uint8_t contact, fresh, valid;
  uint8_t put_down;      /* 1: the stylus was lifted before it, and put down elsewhere */
  uint8_t forceless;     /* 1: the device let no force through */
  uint8_t edit_left_out; /* 1: an edit that the answer asked for was not done */
  uint8_t reserved[2];
} pp_log_tick;

/* A point as an edit has left it. */
typedef struct pp_log_edit {
  uint32_t point;               /* its number in the file, or behind those of the file where it is new */
  uint32_t parent;              /* that it took its other properties from; itself where the file had it */
  float position[3], normal[3]; /* relative to the origin of the cloud */
  uint8_t color[4];             /* red green blue alpha; 0 where the cloud has none */
  uint32_t gone;                /* 1: it is not there any more */
} pp_log_edit;

typedef struct pp_log_content {
  uint64_t ticks, edits;
  const pp_log_tick* tick;
  const pp_log_edit* edit;
  const char* header;              /* how to run it again, as JSON */
  const char* missing;             /* what is missing of it and where, a line each; empty where it is whole */
  uint64_t points;                 /* of the model */
  uint64_t lost_ticks;             /* that the log has not, because its thread had fallen behind */
  uint64_t merged_edits;           /* that later ones of the same point stand for */
  double map_scale, map_offset[3]; /* model units = map_scale * device + map_offset, as long as no clutch was drawn */
  uint32_t ended;                  /* 1: the session came to its end */
  uint32_t reserved;
} pp_log_content;

/* Of a log that a crash cut off, or that is damaged, all that is whole is read. */
PP_API pp_status pp_log_read(const char* file, pp_log* log);
/* Valid until the log is closed. */
PP_API pp_status pp_log_view(pp_log log, pp_log_content* content);
PP_API pp_status pp_log_close(pp_log log);

typedef struct pp_replay_options {
  uint32_t size;
  uint32_t threads;    /* of the CPU; 0: one per core */
  const char* gpu;     /* which one, where the session was on a GPU; null: the best that there is */
  const char* model;   /* file of the model; null: that which the log names */
  pp_cloud cloud;      /* the model itself, in place of any file; null: none */
  double tolerance;    /* N for forces and mm for points; 0: the same bits */
  pp_log_function log; /* hears remarks; null: nobody */
  void* log_user;
  pp_watch watch; /* of this call */
} pp_replay_options;
PP_OPTIONS(replay_options)

typedef struct pp_replay_result {
  uint32_t size;
  uint32_t identical;        /* 1: all ticks and all points in the end came out the same, within the tolerance */
  uint64_t ticks;            /* of the log */
  uint64_t compared;         /* of them; less than all where the session cannot be run again exactly */
  uint64_t force_ticks;      /* whose forces differ */
  uint64_t edit_ticks;       /* between which the points were edited differently */
  uint64_t points;           /* that are not the same in the end */
  double largest_force_N;    /* by which forces differ */
  double first_difference_s; /* negative: there is none */
  uint32_t ends_compared;    /* 1: the points in the end were */
  uint32_t
      recorded_edits; /* 1: give the points that the session ended with; 2: do not; 0: it did not come to its end */
  char because[192];  /* why not all ticks were compared; empty where they were */
  char machine[112];  /* that ran it again, in words; cut off */
  char recorded_on[112];
} pp_replay_result;
PP_OPTIONS(replay_result)
/* Runs a recorded session again, in virtual time, and holds it against the log. PP_OK also where it differs: the result
 * says so. PP_ERROR_FILE for another model than the session had. */
PP_API pp_status pp_log_replay(const char* file, const pp_replay_options* options, pp_replay_result* result);

#endif
