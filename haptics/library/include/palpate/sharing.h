/** @file
 * palpate's C interface: sessions shared by several programs, here or on other machines, over DDS. palpate.h includes
 * this. In a library built without PALPATE_NETWORK all of it gives PP_ERROR_UNSUPPORTED. */
#ifndef PALPATE_SHARING_H
#define PALPATE_SHARING_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup sharing Shared sessions
 * @{ */

/** 1 if this library was built with PALPATE_NETWORK, else 0. */
PP_API uint32_t pp_can_share(void);

/** Called each twentieth of a second by a call that waits for other programs, on the waiting thread: other than 0 ends
 * the call with PP_ERROR_NETWORK. It must not call palpate. */
typedef int32_t (*pp_stop_function)(void* user);

/** Network on which sessions are shared. */
typedef struct pp_network {
  uint32_t size;   /**< bytes of this struct */
  uint32_t domain; /**< domain of DDS, as ROS numbers them: 0 to 230 */
  /** An interface of this machine, by name or address; null: programs of this machine only. With an interface, every
   * program on that network can take part, and nothing is encrypted without `security`. */
  const char* interface_name;
  const char* const* peers; /**< addresses of machines to contact directly, for networks without multicast */
  uint64_t peer_count;      /**< number of peers */
  /** A folder of keys (palpate keys): everything is encrypted, and only holders of keys of the same authority can take
   * part; null: no keys. */
  const char* security;
  /** Ends pp_network_discover(), pp_session_join() and pp_serve() while they wait for other programs; null: none. It is
   * not called after they return. */
  pp_stop_function stop;
  void* stop_user; /**< passed to `stop` */
} pp_network;
PP_OPTIONS(network)

/** A served session. Names are as the other programs have sent them: cut off to fit, without control characters, and
 * not necessarily UTF-8. */
typedef struct pp_served_session {
  char name[208];       /**< name of the session */
  char host[64];        /**< machine of its server */
  char model[208];      /**< its server's description of the points */
  uint64_t points;      /**< number of points */
  double round_trip_ms; /**< median of the answered pings, ms; below 0: no ping was answered */
  uint32_t version;     /**< version of the network protocol */
  uint32_t compatible;  /**< 1: same version as this library, so that it can be joined */
  uint32_t pings;       /**< number of pings */
  uint32_t answered;    /**< number of answered pings */
} pp_served_session;
/** Lists the sessions that are served on a network. Listens for `seconds` (0 to 600), then pings the sessions found,
 * which takes half a second, and up to two more if pings are lost. Copies the first `capacity` of them; `count` is
 * their total number. `network` may be null. PP_ERROR_NETWORK if the network cannot be used. */
PP_API pp_status pp_network_discover(const pp_network* network, double seconds, pp_served_session* sessions,
                                     uint64_t capacity, uint64_t* count);

/** How pp_session_join() takes part in a served session. */
typedef struct pp_join_options {
  uint32_t size;             /**< bytes of this struct */
  uint32_t read_only;        /**< 1: this hand feels the others' edits, and cannot have a brush */
  const pp_network* network; /**< null: pp_default_network() */
  const char* hand_name;     /**< name of this hand for the others; null: name of the machine */
  /** Timeout for finding the session, for each further piece of it, and, in calls by path and in commands, for all
   * edits to reach all programs; above 0. */
  double timeout_s;
  /** 1: streams only the points around the hands, ahead of them (for models too large to download); pp_session_cloud()
   * has the known ones, with their numbers among all as a field, and nothing is recorded. Moving points are always
   * streamed this way, and can be felt live. */
  uint32_t partial;
} pp_join_options;
PP_OPTIONS(join_options)
/** Joins a session that another program serves (pp_serve(), `palpate serve`), by its name: a copy of its points, felt
 * like those of a cloud of this program, by path, tick by tick and live. The edits of a hand are sent to the server,
 * and from there to all others, whose strokes are felt between two ticks; at rest all programs have the same points,
 * bit by bit. Points are neither inserted nor removed, whatever pp_brush.resample says. Undo reverts this hand's
 * strokes, except where others have changed the points since. While the server is silent for seconds the force fades,
 * tick by tick and live, until the server is heard again; contact->valid stays 1. All hands are shown to the others,
 * until a second after their last tick. A session that is sculpted cannot be recorded. Options may be null.
 * PP_ERROR_NETWORK if there is no such session, if two have that name, or if its version differs; and from any call
 * that touches once this hand's part has ended permanently, after which the points can still be copied. */
PP_API pp_status pp_session_join(const char* name, const pp_join_options* join, const pp_session_options* options,
                                 pp_session* session);

/** State of the exchange with the other programs. */
typedef struct pp_sharing {
  uint32_t size;           /**< bytes of this struct */
  uint32_t sculptable;     /**< 0: served read-only: the counts of strokes are 0 */
  uint32_t connected;      /**< 0: no force, since the server has been silent for too long */
  uint32_t delivered;      /**< 1: the server has taken all edits of this hand */
  uint32_t idle;           /**< 1: and all edits of others are in effect here */
  uint32_t same;           /**< 1: at rest, and the points are the server's, bit by bit */
  uint64_t sent;           /**< states of points that this hand has made */
  uint64_t received;       /**< states of points that others have made and that took effect here */
  uint64_t resent;         /**< pieces of strokes that were sent again */
  uint64_t resumed;        /**< number of requests for missing edits, including the first */
  uint64_t pings;          /**< number of pings */
  uint64_t answered;       /**< number of answered pings */
  double silent_s;         /**< time since the server was last heard, s */
  double longest_silent_s; /**< maximum of silent_s so far */
  double round_trip_ms;    /**< median of the last pings, ms; below 0: none was answered yet */
  char name[208];          /**< name of the session */
  char host[64];           /**< machine of its server */
  char model[208];         /**< its server's description of the points */
  char fault[256];         /**< reason why this hand's part has ended permanently; empty: it has not */
  /** Number of restarts of the moving points at the server, such as of water that was stirred too fast. */
  uint64_t restarts;
} pp_sharing;
PP_OPTIONS(sharing)
/** State of a joined session. PP_ERROR_STATE for a session that was not joined, as from the functions below. */
PP_API pp_status pp_session_get_sharing(pp_session session, pp_sharing* sharing);

/** Last known state of another program's hand. */
typedef struct pp_other_hand {
  char name[208];     /**< name of the hand */
  uint32_t number;    /**< the same on all machines, while it takes part */
  uint32_t touching;  /**< 1: it touches the surface */
  uint32_t sculpts;   /**< 1: it has a brush */
  uint32_t reserved;  /**< not used */
  double position[3]; /**< position of what it touches with, model units */
  double proxy[3];    /**< the proxy of that on the surface, model units */
  double age_s;       /**< time since it was heard, s */
} pp_other_hand;
/** Hands of other programs that were heard within two seconds. Copies the first `capacity` of them; `count` is their
 * total number. */
PP_API pp_status pp_session_other_hands(pp_session session, pp_other_hand* hands, uint64_t capacity, uint64_t* count);

/** Camera of a picture of the points. */
typedef struct pp_camera_place {
  double position[3]; /**< model units */
  /** Unit quaternion w x y z of the camera's axes: x to the right of the picture, y down in it, z in the direction
   * of view. */
  double orientation[4];
  double fov_deg; /**< vertical field of view, degrees, above 0 and below 180 */
  double aspect;  /**< width / height of the picture, 0.001 to 1000 */
} pp_camera_place;
/** Last known camera of another program's picture. */
typedef struct pp_other_camera {
  char name[208];        /**< name of its hand */
  uint32_t number;       /**< number of that hand */
  uint32_t reserved;     /**< not used */
  pp_camera_place place; /**< the camera itself */
  double age_s;          /**< time since it was heard, s */
} pp_other_camera;
/** Cameras of other programs that were heard within two seconds, including those of read-only sessions and of sessions
 * near their hands. Copies the first `capacity` of them; `count` is their total number. */
PP_API pp_status pp_session_cameras(pp_session session, pp_other_camera* cameras, uint64_t capacity, uint64_t* count);
/** Shows this camera to the others from now on, at most 30 times a second; null: none, as at first. Pictures of
 * pp_session_render() are not shown unless this function is called. */
PP_API pp_status pp_session_publish_camera(pp_session session, const pp_camera_place* camera);

/** Requests the server's state, and exchanges edits until all that the server had taken before this call is in effect
 * here, and the server has all edits made here; waits at most `seconds`. `same`: 1 if so and the points are the
 * server's, 0 also if the server does not answer; may be null. PP_ERROR_STATE while the session is live. */
PP_API pp_status pp_session_settle(pp_session session, double seconds, uint32_t* same);

/** Answer of a server to pp_session_save_at_server(). */
typedef struct pp_server_save {
  uint32_t size;    /**< bytes of this struct */
  uint32_t written; /**< 1: the server has written its file; 0: it has not, for the reason in `text` */
  uint64_t points;  /**< number of points in the file */
  char text[256];   /**< the file, as its server names it, or the reason */
} pp_server_save;
PP_OPTIONS(server_save)
/** Asks the server of a joined session to write all its points to its file (pp_serve_options.save, `palpate serve
 * --save`), once it has taken the edits made here, and waits at most `seconds` for its answer. A server writes once in
 * five seconds at most. PP_OK whatever the answer is. */
PP_API pp_status pp_session_save_at_server(pp_session session, double seconds, pp_server_save* save);

/** Handle of a served cloud. Any number of threads may use it. */
typedef struct pp_server {
  uint64_t id; /**< 0 is null */
} pp_server;

/** How pp_serve() serves a cloud. */
typedef struct pp_serve_options {
  uint32_t size;             /**< bytes of this struct */
  uint32_t read_only;        /**< 1: joined programs can feel it but not sculpt it */
  const pp_network* network; /**< null: pp_default_network() */
  const char* model;         /**< description of the points; null: the name of the cloud's file */
  double mm_per_unit; /**< millimetres per model unit; 0: as the cloud says, or the longest side becomes 100 mm */
  uint32_t estimate_normals; /**< 1: even if the cloud has normals */
  uint32_t threads;          /**< threads of the CPU for that; 0: one per core */
  /** A file to which each stroke is written when it is taken. A server that is started with it again continues where
   * the file ends, and so do the programs that have joined; null: none. */
  const char* journal;
  pp_log_function log; /**< receives messages, such as of programs that join, until the server is closed; null: none */
  void* log_user;      /**< passed to `log` */
  pp_watch watch;      /**< watches pp_serve() */
  /** A file to which the server writes its points when a joined program asks for it (pp_session_save_at_server(), or
   * saving in the window); a file that exists is kept as NAME.bak; null: such requests are refused. */
  const char* save;
} pp_serve_options;
PP_OPTIONS(serve_options)
/** Serves the cloud on a thread of its own until the server is closed, under a name of 1 to 200 bytes that no other
 * session of the network has. Normals are estimated if the cloud has none. Options may be null. The call takes a
 * second, in which it listens for another session of that name. PP_ERROR_NETWORK if the name is taken or the network
 * cannot be used, PP_ERROR_FILE if the journal cannot be written. */
PP_API pp_status pp_serve(pp_cloud cloud, const char* name, const pp_serve_options* options, pp_server* server);

/** State of a served cloud. */
typedef struct pp_server_info {
  uint32_t size;      /**< bytes of this struct */
  uint32_t serving;   /**< 0: the server has ended, for the reason in `fault` */
  uint64_t points;    /**< number of points */
  uint64_t clients;   /**< clients that have ever requested points */
  uint64_t sculptors; /**< clients whose strokes were taken */
  uint64_t pieces;    /**< pieces of strokes taken */
  uint64_t states;    /**< states of points in them */
  uint64_t sent;      /**< states sent to all clients */
  uint64_t refused;   /**< invalid requests and pieces of strokes, which no palpate client sends */
  double mm_per_unit; /**< millimetres per model unit */
  char access[256];   /**< who can join, as a sentence */
  char fault[256];    /**< reason why it has ended; empty: it has not */
} pp_server_info;
PP_OPTIONS(server_info)
/** Present state of the server. */
PP_API pp_status pp_server_get_info(pp_server server, pp_server_info* info);
/** Copies the present points, with all strokes taken, into a new cloud. */
PP_API pp_status pp_server_cloud(pp_server server, pp_cloud* cloud);
/** Stops serving. Programs that have joined keep their points, but receive nothing any more. */
PP_API pp_status pp_server_close(pp_server server);

/** @} */

#endif
