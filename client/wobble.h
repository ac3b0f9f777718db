// The client of wobble for C (C11), and for every language that calls C: joins a world, sends the player's input and
// tells where every body is. The library is libwobble.so; there is no physics in it.
//
// Results: a function that can fail returns WOBBLE_OK, a positive wobble_result that is no fault, or a negative one
// that says what cannot be; wobble_describe has a sentence for each. A call that fails changes nothing. No exception
// leaves the library.
//
// Structs: the first field, struct_size, is sizeof of the struct as the caller knows it. New fields come last, and the
// library touches no byte beyond struct_size, so a program works with an older or a newer library than it was compiled
// with. In structs that the library reads, 0 and NULL stand for the default.
//
// Time: the library reads no clock. `now` is in seconds since any moment, less than 1e12, and never goes back.
//
// Memory: no pointer that you pass is kept after the call. Memory of the library is valid for as long as it says beside
// the pointer to it.
//
// Threads: the library starts none and keeps nothing outside its clients. Different threads may use different clients;
// one client is for one thread at a time. What a sample points to may meanwhile be read by another one: wobble_sample.
//
// Nothing waits for the network. But to resolve a host's name may take seconds, in wobble_connect, and in wobble_update
// when it joins again; an IP address takes none.
//
// Units: metres, seconds. The world's z is up. Texts are UTF-8.
#ifndef WOBBLE_H
#define WOBBLE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WOBBLE_API __attribute__((visibility("default")))

typedef int32_t wobble_result;
enum {
  WOBBLE_OK = 0,
  WOBBLE_NO_EVENT = 1,      // wobble_next_event: there is none at present
  WOBBLE_TOO_SMALL = 2,     // wobble_sample: an array is; the counts say what is needed
  WOBBLE_NULL = -1,         // a pointer is NULL that must not be
  WOBBLE_BAD_SIZE = -2,     // struct_size is less than the struct has ever had
  WOBBLE_BAD_FLAGS = -3,    // a bit is set that has no meaning
  WOBBLE_BAD_VALUE = -4,    // a number is not finite or out of its range, or a text too long
  WOBBLE_BAD_TIME = -5,     // now is not finite, too large, or earlier than in a call before
  WOBBLE_BAD_ADDRESS = -6,  // no HOST:PORT, or the host has no address
  WOBBLE_BAD_SECRET = -7,   // password, token, invite or server_key is none, or more than one is given
  WOBBLE_NOT_PLAYING = -8,  // only a client that plays can do that
  WOBBLE_BAD_INDEX = -9,    // there is nothing at this index, or nothing any more
  WOBBLE_NO_MEMORY = -10,
  WOBBLE_INTERNAL = -11,  // a defect of the library
};
// One line in English for any number; valid for ever.
WOBBLE_API const char* wobble_describe(wobble_result result);
// Of the library, such as "0.1.0"; valid for ever.
WOBBLE_API const char* wobble_version(void);

// 1. Connect.

typedef struct wobble_client wobble_client;

enum {
  WOBBLE_SPECTATE = 1 << 0,   // sees the world without a body
  WOBBLE_NO_REJOIN = 1 << 1,  // ends when the connection is lost; otherwise it tries for a minute to come back
};

// At most one of password, token and invite.
typedef struct wobble_connect_options {
  uint32_t struct_size;
  uint32_t flags;          // WOBBLE_SPECTATE, WOBBLE_NO_REJOIN
  const char* address;     // "HOST:PORT"; an IPv6 address stands in brackets, "[::1]:7777"
  const char* name;        // of the player, at most 32 bytes; default: "player"
  const char* password;    // 1 to 512 bytes
  const char* token;       // as a matchmaker or `wobble token` gives it out
  const char* invite;      // what follows #invite= in a link
  const char* server_key;  // that the server must have, 64 hexadecimal digits; default: any
} wobble_connect_options;

// Begins to connect and makes *client. The world comes with wobble_update. After a failure *client is NULL.
WOBBLE_API wobble_result wobble_connect(const wobble_connect_options* options, double now, wobble_client** client);

// Frees the client and all that it points to; NULL is allowed. Let a client that plays leave first: the server may
// otherwise keep its body for some seconds.
WOBBLE_API void wobble_destroy(wobble_client* client);

// 2. Update, once a frame or 60 times a second.

// Takes in what has arrived, answers, sends the input that is due, and joins again when the connection was lost.
WOBBLE_API wobble_result wobble_update(wobble_client* client, double now);

// Says goodbye. Go on with wobble_update until the state is WOBBLE_ENDED: 5 s at most.
WOBBLE_API wobble_result wobble_leave(wobble_client* client, double now);

enum {
  WOBBLE_JOINING = 0,  // for the first time, or the server's next scene
  WOBBLE_PLAYING = 1,
  WOBBLE_REJOINING = 2,  // was cut off, `reason` says why, and tries to come back; the world stands still
  WOBBLE_ENDED = 3,      // has left, was sent away, or has given up: `reason`
};
enum { WOBBLE_MAY_GRAB = 1 << 0, WOBBLE_MAY_CUT = 1 << 1, WOBBLE_MAY_PUSH = 1 << 2 };

typedef struct wobble_status {
  uint32_t struct_size;
  int32_t state;           // WOBBLE_JOINING ...
  int32_t ended_unasked;   // 1: has ended, and not by wobble_leave
  uint32_t client_id;      // of this player, as in events
  uint32_t own_body;       // 0: none
  uint32_t hands;          // what the scene lets players do: WOBBLE_MAY_GRAB ...
  float reach;             // of hands, from the own body's centroid; 0: any distance
  float pace;              // how fast the world runs; less than 1 when the server is overloaded
  const char* scene;       // its name. This text and the next two: valid until the next call with this client
  const char* reason;      // one line for people; "" when there is nothing to say
  const char* server_key;  // of the server, for wobble_connect_options the next time; "" before it plays
} wobble_status;
WOBBLE_API wobble_result wobble_read_status(const wobble_client* client, wobble_status* status);

// 3. Play.

enum { WOBBLE_JUMP = 1 << 0, WOBBLE_PUFF = 1 << 1, WOBBLE_STIFFEN = 1 << 2 };

typedef struct wobble_input {
  uint32_t struct_size;
  uint32_t buttons;  // WOBBLE_JUMP ...
  float move_x;      // along the world's x, -1 to 1
  float move_y;      // along the world's y, -1 to 1
} wobble_input;
// Holds until the next one, also when the client has joined again.
WOBBLE_API wobble_result wobble_set_input(wobble_client* client, const wobble_input* input);

// The vertices of a body around `vertex` are pulled so that it follows the target.
typedef struct wobble_hand {
  uint32_t struct_size;
  uint32_t body;
  uint32_t vertex;  // of the body, from 0
  float target[3];  // world
} wobble_hand;
// Grabs, or moves what is held; another body or vertex than before begins a new grip. hand NULL: lets go. Holds until
// the next one, or until another world begins. The server decides which bodies may be held and from how far away, and
// tells by WOBBLE_NOTICE why not; the same with push and cut.
WOBBLE_API wobble_result wobble_set_hand(wobble_client* client, const wobble_hand* hand);
// Pushes the vertices around this one, once. direction: world, of any length but 0.
WOBBLE_API wobble_result wobble_push(wobble_client* client, uint32_t body, uint32_t vertex, const float direction[3]);
// Cuts the springs of the body that pass through the triangle of these points of the world.
WOBBLE_API wobble_result wobble_cut(wobble_client* client, uint32_t body, const float eye[3], const float from[3],
                                    const float to[3]);

// 4. Sample, and draw.

// All bodies in arrays of yours, as a graphics card takes them. An array that is NULL is left out.
typedef struct wobble_frame {
  uint32_t struct_size;
  uint32_t vertex_capacity;  // vertices for which positions and normals have room
  uint32_t index_capacity;   // indices for which `indices` has room
  uint32_t body_count;       // the library writes this one and the next three
  uint32_t vertex_count;
  uint32_t index_count;  // three a triangle, counter-clockwise as seen from outside
  uint32_t layout;       // changes when the indices or the order of bodies are not those of the sample before
  uint32_t reserved;
  float* positions;   // three a vertex, world
  float* normals;     // three a vertex, unit length; 0 in bodies without faces
  uint32_t* indices;  // of the vertices in `positions`, from 0
} wobble_frame;
// Takes a sample of all bodies as they are to be shown at `now`, interpolated, a tenth of a second or so behind the
// server. There are none before the client plays; while it rejoins they stand still. WOBBLE_TOO_SMALL: the sample is
// taken and counted, but the arrays are as before. frame NULL: for wobble_read_body alone.
//
// To draw in one thread while another one samples, use two frames in turn. What wobble_read_body points to is there
// without a copy, and the library itself keeps it twice: it does not change during the next sample, and is
// overwritten by the one after that.
WOBBLE_API wobble_result wobble_sample(wobble_client* client, double now, wobble_frame* frame);

typedef struct wobble_body {
  uint32_t struct_size;
  uint32_t body;          // its number, as in wobble_status and events
  uint32_t first_vertex;  // where it begins in a frame
  uint32_t first_index;
  uint32_t vertex_count;
  uint32_t face_count;
  uint32_t edge_count;    // of a body without faces, to be drawn as lines; else 0
  int32_t changed;        // 0: all its vertices are where they were in the sample before
  int32_t held;           // 1: recent data is missing, so it is shown as it was last
  int32_t open;           // 1: the faces leave a rim, so that one sees their backs
  float age;              // of the newest data that is shown
  float centroid[3];      // world
  float rotation[4];      // unit quaternion, w x y z
  const char* blueprint;  // such as "ball". This pointer and the next four: see wobble_sample
  const float* positions;
  const float* normals;
  const uint16_t* faces;  // three vertices each, from 0 in this body
  const uint16_t* edges;  // two each
} wobble_body;
// index: from 0 to body_count - 1 of the last sample; bodies are in ascending order.
WOBBLE_API wobble_result wobble_read_body(const wobble_client* client, uint32_t index, wobble_body* body);

// What stands still. Plane: a is the outward normal, b[0] the offset (a . x = offset). Box, parallel to the axes: a is
// the centre, b the half extents. Sphere: a is the centre. Capsule: a and b are the ends of its axis.
enum { WOBBLE_PLANE = 0, WOBBLE_BOX = 1, WOBBLE_SPHERE = 2, WOBBLE_CAPSULE = 3 };
typedef struct wobble_obstacle {
  uint32_t struct_size;
  int32_t kind;  // WOBBLE_PLANE ...
  float a[3];
  float b[3];
  float radius;  // of sphere and capsule
} wobble_obstacle;
// index: from 0 on, until WOBBLE_BAD_INDEX.
WOBBLE_API wobble_result wobble_read_obstacle(const wobble_client* client, uint32_t index, wobble_obstacle* obstacle);

// Ground as heights over a grid, solid below: node (i, j) is at corner + cell_size (i, j).
typedef struct wobble_ground {
  uint32_t struct_size;
  uint32_t columns;  // along x, at least 2
  uint32_t rows;     // along y, at least 2
  float corner[2];   // x and y of the first node
  float cell_size;
  const float* heights;  // z, row by row, x running fastest; valid until the next wobble_update
} wobble_ground;
// index: from 0 on, until WOBBLE_BAD_INDEX.
WOBBLE_API wobble_result wobble_read_ground(const wobble_client* client, uint32_t index, wobble_ground* ground);

// 5. Events and statistics.

enum {
  WOBBLE_JOIN = 0,  // text: the player's name; body 0: a spectator
  WOBBLE_LEAVE = 1,
  WOBBLE_RESPAWN = 2,
  WOBBLE_BODY_REMOVED = 3,
  WOBBLE_FALL = 4,       // body has fallen off; client_id: who is said to have pushed it, or 0
  WOBBLE_NOTICE = 5,     // text: a line for the player, such as why something was not done
  WOBBLE_NEW_WORLD = 6,  // the server's next scene (text), or a return (""): bodies and clients have new numbers
  WOBBLE_GOAL = 7,       // body, the ball, is in a goal; client_id: who has scored it, or 0
  WOBBLE_CROWN = 8,      // client_id wears the crown, body, from now on
};

typedef struct wobble_event {
  uint32_t struct_size;
  int32_t kind;  // WOBBLE_JOIN ...; pass over those that you do not know
  uint32_t client_id;
  uint32_t body;
  const char* text;  // one line; valid until the next wobble_next_event with this client
} wobble_event;
// Takes the oldest event; WOBBLE_NO_EVENT when there is none. The newest 1024 are kept, so take them after each update.
WOBBLE_API wobble_result wobble_next_event(wobble_client* client, wobble_event* event);

// Of the present connection, unless said otherwise.
typedef struct wobble_statistics {
  uint32_t struct_size;
  uint32_t rejoins;            // since wobble_connect
  uint64_t snapshots;          // packets
  uint64_t bad_messages;       // that could not be read, of all kinds
  uint64_t bytes_received;     // payloads
  uint64_t stalls;             // times that a body began to be held
  uint64_t events_lost;        // since wobble_connect, because they were not taken
  double join_seconds;         // from the start until it played; 0 before
  double loss_share;           // of the last 64 snapshot packets
  double snapshot_age;         // of the last one when it arrived
  double input_to_snapshot;    // from an input to the first snapshot that shows it, as measured last
  double interpolation_delay;  // how far behind the server's time bodies are shown
  double server_time;          // of the world, as estimated for the last `now`
} wobble_statistics;
WOBBLE_API wobble_result wobble_read_statistics(const wobble_client* client, wobble_statistics* statistics);

#ifdef __cplusplus
}
#endif

#endif
