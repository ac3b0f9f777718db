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
  // Shows the own body as the server has it, like all others; otherwise it is shown ahead of them: wobble_body.lead.
  WOBBLE_NO_PREDICTION = 1 << 2,
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
enum { WOBBLE_MAY_GRAB = 1 << 0, WOBBLE_MAY_CUT = 1 << 1, WOBBLE_MAY_PUSH = 1 << 2, WOBBLE_MAY_BUILD = 1 << 3 };
enum { WOBBLE_MAY_SAY = 1 << 0, WOBBLE_MAY_EMOTE = 1 << 1 };
// A player may do what the scene lets players do; a moderator also give orders about players, and change what others
// have built; an owner everything.
enum { WOBBLE_RANK_WATCHER = 0, WOBBLE_RANK_PLAYER = 1, WOBBLE_RANK_MODERATOR = 2, WOBBLE_RANK_OWNER = 3 };

typedef struct wobble_status {
  uint32_t struct_size;
  int32_t state;            // WOBBLE_JOINING ...
  int32_t ended_unasked;    // 1: has ended, and not by wobble_leave
  uint32_t client_id;       // of this player, as in events
  uint32_t own_body;        // 0: none
  uint32_t hands;           // what the scene lets players do: WOBBLE_MAY_GRAB ...
  float reach;              // of hands, from the own body's centroid; 0: any distance
  float pace;               // how fast the world runs; less than 1 when the server is overloaded
  const char* scene;        // its name. This and the other texts: valid until the next call with this client
  const char* reason;       // one line for people; "" when there is nothing to say
  const char* server_key;   // of the server, for wobble_connect_options the next time; "" before it plays
  int32_t rank;             // of this player in the administration's eyes: WOBBLE_RANK_WATCHER ...
  uint32_t talk;            // what this player may tell the others: WOBBLE_MAY_SAY, WOBBLE_MAY_EMOTE
  const char* description;  // of the scene, one line; "" if it has none
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

// Says a line to everybody, of 1 to 200 bytes: one a second, and four at once. A notice tells when it was not sent.
WOBBLE_API wobble_result wobble_say(wobble_client* client, const char* text);
enum {
  WOBBLE_WAVE = 0,
  WOBBLE_LAUGH = 1,
  WOBBLE_LOVE = 2,
  WOBBLE_WOW = 3,
  WOBBLE_SAD = 4,
  WOBBLE_CHEER = 5,
};
// Shows a sign over the own body, WOBBLE_WAVE ... It counts as a line does.
WOBBLE_API wobble_result wobble_emote(wobble_client* client, int32_t emote);
// Another name, of 1 to 32 bytes, also for returns. WOBBLE_RENAMED tells when it is in force, and how it reads.
WOBBLE_API wobble_result wobble_rename(wobble_client* client, const char* name);

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
  // Of the own body: how far it is shown from where the server had it at the moment that is shown, by what the input
  // will do. It is in the centroid and the positions already.
  float lead[3];
  uint32_t reserved;
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
  WOBBLE_SAID = 7,       // text: a line that client_id said
  WOBBLE_EMOTED = 8,     // emote: what to show over the body for some seconds
  WOBBLE_RENAMED = 9,    // text: the name of client_id from now on
  WOBBLE_GOAL = 10,      // body, the ball, is in a goal; client_id: who has scored it, or 0
  WOBBLE_CROWN = 11,     // client_id wears the crown, body, from now on
};

typedef struct wobble_event {
  uint32_t struct_size;
  int32_t kind;  // WOBBLE_JOIN ...; pass over those that you do not know
  uint32_t client_id;
  uint32_t body;
  const char* text;  // one line; valid until the next wobble_next_event with this client
  int32_t emote;     // WOBBLE_WAVE ...; pass over those that you do not know
  int32_t reserved;
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

// 6. Build, tune, keep the score, and ask the administration. The server decides what it allows, and tells by
// WOBBLE_NOTICE why not.

// The body that players build together from particles and springs, as the last sample shows it. What stands at an index
// may be another one after the next sample; `number` is a part's own for as long as the part is there.
typedef struct wobble_workshop {
  uint32_t struct_size;
  uint32_t body;            // 0: the scene has none, and nobody may build
  uint32_t particle_count;  // 0 before the sample has the body
  uint32_t spring_count;
} wobble_workshop;
WOBBLE_API wobble_result wobble_read_workshop(const wobble_client* client, wobble_workshop* workshop);

typedef struct wobble_particle {
  uint32_t struct_size;
  uint32_t number;
  uint32_t owner;  // client_id of the player who has built it; 0: the scene
  int32_t fixed;   // 1: stays where it is
  float mass;      // kg
} wobble_particle;
// index: from 0 to particle_count - 1, also that of the vertex in the body's positions.
WOBBLE_API wobble_result wobble_read_particle(const wobble_client* client, uint32_t index, wobble_particle* particle);

typedef struct wobble_spring {
  uint32_t struct_size;
  uint32_t number;
  uint32_t owner;
  uint32_t ends[2];   // indices of particles
  float stiffness;    // N/m
  float damping;      // N s/m
  float rest_length;  // m
} wobble_spring;
// index: from 0 to spring_count - 1.
WOBBLE_API wobble_result wobble_read_spring(const wobble_client* client, uint32_t index, wobble_spring* spring);

enum {
  WOBBLE_ADD_PARTICLE = 0,     // at, mass, fixed
  WOBBLE_ADD_SPRING = 1,       // a and b: its ends; stiffness, damping, rest_length
  WOBBLE_SET_PARTICLE = 2,     // a; mass, fixed
  WOBBLE_SET_SPRING = 3,       // a; stiffness, damping, rest_length
  WOBBLE_REMOVE_PARTICLE = 4,  // a
  WOBBLE_REMOVE_SPRING = 5,    // a
};
typedef struct wobble_change {
  uint32_t struct_size;
  int32_t kind;  // WOBBLE_ADD_PARTICLE ..., which names the fields that count
  uint32_t a;    // numbers of particles and springs
  uint32_t b;
  float at[3];        // world
  float mass;         // kg
  int32_t fixed;      // 0 or 1
  float stiffness;    // N/m
  float damping;      // N s/m
  float rest_length;  // m; 0: as far as the ends are apart
} wobble_change;
// Changes one part of the workshop's body, once.
WOBBLE_API wobble_result wobble_build(wobble_client* client, const wobble_change* change);

enum { WOBBLE_MAY_TUNE_GRAVITY = 1 << 0, WOBBLE_MAY_TUNE_STIFFNESS = 1 << 1, WOBBLE_MAY_TUNE_TIME = 1 << 2 };

// What holds for everybody in the world.
typedef struct wobble_tuning {
  uint32_t struct_size;
  uint32_t may;      // what this player may tune: WOBBLE_MAY_TUNE_GRAVITY ...
  float gravity[3];  // m/s²
  float stiffness;   // times every spring's stiffness and damping
  float time_rate;   // seconds of the world a second
} wobble_tuning;
WOBBLE_API wobble_result wobble_read_tuning(const wobble_client* client, wobble_tuning* tuning);

enum {
  WOBBLE_TUNE_GRAVITY = 0,
  WOBBLE_TUNE_STIFFNESS = 1,  // value[0]
  WOBBLE_TUNE_TIME_RATE = 2,  // value[0]
  WOBBLE_JUMP_AHEAD = 3,      // value[0]: seconds of the world, played as fast as the server can
};
// kind: WOBBLE_TUNE_GRAVITY ...; value: in the units of wobble_tuning.
WOBBLE_API wobble_result wobble_tune(wobble_client* client, int32_t kind, const float value[3]);

// A match: lobby, then for each round kick-off, playing, golden (the next point wins) where rounds can be drawn, won;
// and over, with the final board.
enum {
  WOBBLE_ROUND_PLAYING = 0,
  WOBBLE_ROUND_WON = 1,
  WOBBLE_LOBBY = 2,
  WOBBLE_KICK_OFF = 3,
  WOBBLE_GOLDEN = 4,
  WOBBLE_MATCH_OVER = 5,
};

// Of a scene that has a game.
typedef struct wobble_scoreboard {
  uint32_t struct_size;
  int32_t phase;  // WOBBLE_ROUND_PLAYING ...
  uint32_t round;
  uint32_t seconds_left;  // of the phase
  uint32_t points_to_win;
  uint32_t winner;  // client_id of the last round's, or the match's; 0: nobody
  uint32_t score_count;
  uint32_t rounds;          // that make a match; 0: it never ends
  const char* game;         // its name; "": none. Valid until the next call with this client
  uint32_t winning_side;    // as `winner`, where there are sides; 0: none
  uint32_t side_points[2];  // of sides 1 and 2, in this round; 0 where there are none
  uint32_t side_rounds[2];  // that they have won
  uint32_t object;          // body of the ball or the crown; 0: none
  uint32_t bearer;          // client_id of who wears the crown; 0: nobody
  uint32_t reserved;
} wobble_scoreboard;
WOBBLE_API wobble_result wobble_read_scoreboard(const wobble_client* client, wobble_scoreboard* scoreboard);

typedef struct wobble_score {
  uint32_t struct_size;
  uint32_t client_id;
  uint32_t points;  // in this round
  uint32_t rounds;  // that the player has won
  uint32_t side;    // 1 or 2; 0: the game has none
  int32_t ready;    // 1: for the match
  int32_t bot;      // 1: no person plays
} wobble_score;
// index: from 0 to score_count - 1.
WOBBLE_API wobble_result wobble_read_score(const wobble_client* client, uint32_t index, wobble_score* score);

// A line to the server's administration, such as a moderator's "kick 7" or a player's "ready"; 1 to 200 bytes.
// The answer comes as WOBBLE_NOTICE.
WOBBLE_API wobble_result wobble_order(wobble_client* client, const char* line);

#ifdef __cplusplus
}
#endif

#endif
