# A player in one world, over a gateway's WebSocket: section 2 of STANDARD.md, from hello to goodbye.
#
# Call `update` once a frame; `sample` then tells where each of `bodies` is to be drawn. Places and directions are in the
# engine's axes. It is one connection (lasting.gd joins again), keeps no blueprints, and opens no lanes.
extends Reference

const Body = preload("res://body.gd")
const Blueprints = preload("res://blueprints.gd")
const FlatBuffer = preload("res://flat_buffer.gd")
const Grounds = preload("res://grounds.gd")
const Snapshots = preload("res://snapshots.gd")

enum { JOINING, PLAYING, ENDED }  # states
enum { JUMP = 1, PUFF = 2, STIFFEN = 4 }  # buttons
enum { MAY_GRAB = 1, MAY_CUT = 2, MAY_PUSH = 4 }  # hands

# The first 8 bytes of the SHA-256 of protocol/messages.fbs: another one has another hash, and the server says so.
const SCHEMA_HASH = 0xdbf71404 << 32 | 0x127bea27
const SILENCE = 8.0  # s without a message, after which the other end is gone
const DELAY = 0.1  # s of the world by which bodies are shown late, so that a pose after that moment is mostly there
const MOST_NAME = 32  # bytes
const REASONS = ["left", "the server is closing", "the server is full", "the server speaks another version",
	"the server has another schema", "no hello in time", "silent for too long", "too many bad messages",
	"the server is too busy, try later", "too much was sent", "kicked", "banned",
	"the password, invite or token is missing or not valid", "too many from this address"]
const PASSING_REASONS = [1, 2, 5, 6, 8, 13]  # after which a new connection may fare better
const FINAL_CODES = [4000, 4001]  # of the gateway: no such world, or not with this password

var state = JOINING
var reason = ""  # why it has ended
var failed = false  # it has ended, and not by `leave`
var may_rejoin = false  # it has ended, and a new connection may fare better
var scene = ""
var own_body = 0
var worlds = 0  # that it has been welcomed to; another number means other bodies, obstacles and grounds
var obstacles = []  # { kind, a, b, radius } as messages.fbs has them; to be drawn
var grounds = Grounds.new()
var hands = 0  # what players may do here: MAY_GRAB ...
var reach = 0.0  # of hands, from the own body's middle, m; 0: any distance
var bodies = {}  # number -> body.gd
var notices = []  # lines for the player, to be taken
var refused = 0  # messages, packets and records that could not be read
var move_x = 0.0  # along the world's x and y, -1 to 1
var move_y = 0.0
var buttons = 0

var _socket = WebSocketClient.new()
var _snapshots = Snapshots.new()
var _name = ""
var _url = ""
var _welcome = null
var _is_first_scene = true
var _blueprints = Blueprints.new()
var _removed = {}  # body -> tick
var _clock = 0.0  # of the world as its newest snapshots show it, s
var _pace = 1.0
var _newest_tick = 0
var _acked = 0
var _history = 0
var _frames = []  # of input, newest first: [tick, x, y, buttons]
var _input_due = 0.0
var _silence = 0.0
var _leaving = false
var _hand = null  # [body, vertex, target]
var _grip = 0


# url: ws://HOST:PORT/play or /play/WORLD. credential: what the gateway's WebSocket takes, such as "password." and
# base64url of the password; "" for none.
func connect_to(url, name, credential = ""):
	_url = url
	_name = name
	while _name.to_utf8().size() > MOST_NAME:
		_name = _name.left(_name.length() - 1)
	_socket.set_buffers(256, 1024, 64, 256)  # KiB and messages: one of the server's is 64 KiB at most
	_socket.connect("connection_established", self, "_on_open")
	_socket.connect("connection_error", self, "_on_error")
	_socket.connect("server_close_request", self, "_on_close_request")
	_socket.connect("connection_closed", self, "_on_closed")
	_socket.connect("data_received", self, "_on_data")
	var protocols = ["wobble.%d" % Snapshots.VERSION]
	if credential != "":
		protocols.append(credential)
	if _socket.connect_to_url(url, PoolStringArray(protocols)) != OK:
		_on_error()


# delta: seconds since the last call. Receives, and sends the input that is due.
func update(delta):
	if state == ENDED:
		return
	_silence += delta
	_clock += delta * _pace
	_socket.poll()
	if _welcome != null and state != ENDED and not _leaving:
		_input_due += delta * _welcome.tick_hz
		if _input_due >= 1:
			_input_due = min(_input_due - 1, 1)
			_send_input()
	if _silence > SILENCE:
		_end("no answer from %s" % _url if _welcome == null else "the server has been silent for %d s" % SILENCE, true)


# Says goodbye. Go on with `update` until the state is ENDED.
func leave():
	if state == ENDED or _leaving:
		return
	_leaving = true
	_silence = SILENCE - 1  # the answer may take 1 s
	_send(0, FlatBuffer.build(3, [[1, 0], [0, PoolByteArray(), 0]]))
	_socket.disconnect_from_host()


# Holds the body at this vertex, or moves what is held: the vertex follows the target. The server decides what may be held.
func hold(body, vertex, target):
	if _hand == null or _hand[0] != body or _hand[1] != vertex:
		_grip = _grip % 65535 + 1
	_hand = [body, vertex, target]


func release():
	_hand = null


# Shoves the vertices near this one, once. direction: of any length but 0.
func push(body, vertex, direction):
	_ask(4, [[4, body], [2, vertex], [12, FlatBuffer.pack_vectors([direction])]])


# Cuts the springs of a body that pass through the triangle of these points.
func cut(body, eye, from, to):
	_ask(5, [[4, body], [12, FlatBuffer.pack_vectors([eye])], [12, FlatBuffer.pack_vectors([from])],
		[12, FlatBuffer.pack_vectors([to])]])


# The vertex of a body's rest shape that is nearest to a point, to hold or push it there; -1 when that is not known.
func find_vertex(body, point):
	var where = sample(body)
	var blueprint = find_blueprint(body) if where != null else null
	if blueprint == null:
		return -1
	var local = where.affine_inverse().xform(point)
	var nearest = 0
	for i in blueprint.rest.size():
		if local.distance_squared_to(blueprint.rest[i]) < local.distance_squared_to(blueprint.rest[nearest]):
			nearest = i
	return nearest


# Where a body is to be shown now; null when that is not known.
func sample(number):
	return bodies[number].find((_clock - DELAY) * _welcome.tick_hz) if bodies.has(number) else null


# The blueprint of a body, for its size: blueprints.gd. null when there is none.
func find_blueprint(number):
	return _blueprints.find(bodies[number].blueprint)


func _end(why, may_return = false):
	if state == ENDED:
		return
	state = ENDED
	reason = "left" if _leaving else why
	failed = not _leaving
	may_rejoin = failed and may_return


func _on_open(_protocol):
	_silence = 0.0
	_socket.get_peer(1).set_write_mode(WebSocketPeer.WRITE_MODE_BINARY)
	_say_hello()


func _on_error():
	_end("%s: nobody answers, or the gateway refuses: no such world, or too many joins" % _url, true)


func _on_close_request(code, why):
	_end(FlatBuffer.make_line(why) if why != "" else "closed by the gateway, code %d" % code,
		not FINAL_CODES.has(code))


func _on_closed(_was_clean):
	_end("the connection to %s was lost" % _url, true)


func _say_hello():
	var name = _name.to_utf8()
	var fields = [[2, Snapshots.VERSION], [8, SCHEMA_HASH], [0, name, name.size()], [1, 0]]
	_send(0, FlatBuffer.build(1, fields))


func _send_input():
	var tick = int(max(min(_clock * _welcome.tick_hz, _newest_tick + _welcome.tick_hz / 2), 1))
	if _frames.empty() or tick > _frames[0][0]:
		_frames.push_front([tick, _to_byte(move_x), _to_byte(move_y), buttons & 7])
		_frames = _frames.slice(0, 3)
	var bytes = StreamPeerBuffer.new()
	for frame in _frames:
		bytes.put_u32(frame[0])
		bytes.put_8(frame[1])
		bytes.put_8(frame[2])
		bytes.put_u16(frame[3])  # and a byte that pads
	_send(1, FlatBuffer.build(2, [[0, bytes.data_array, _frames.size()], [4, _acked], [8, _history], _pack_hand(), null,
		[4, (grounds.taken + _blueprints.taken) & 0xFFFFFFFF]]))


func _pack_hand():
	if _hand == null or state != PLAYING:
		return null
	var bytes = StreamPeerBuffer.new()
	bytes.put_data(FlatBuffer.pack_vectors([_hand[2]]))
	bytes.put_u32(_hand[0])
	bytes.put_u16(_hand[1])
	bytes.put_u16(_grip)
	return [20, bytes.data_array]


# A command, of a client that plays.
func _ask(type, fields):
	if state == PLAYING and not _leaving:
		_send(0, FlatBuffer.build(type, fields))


func _to_byte(share):
	return int(round(clamp(share, -1, 1) * 127))


func _send(channel, bytes):
	_socket.get_peer(1).put_packet(PoolByteArray([channel]) + bytes)


func _on_data():
	var message = _socket.get_peer(1).get_packet()
	if state == ENDED or message.size() < 2:
		return
	if not _leaving:
		_silence = 0.0
	var was_read = true
	match message[0]:
		0: was_read = _take_control(FlatBuffer.new(message.subarray(1, -1)))
		2: was_read = _take_snapshot(message.subarray(1, -1))
	if not was_read:
		refused += 1


# The members of ServerBody by number. Those that are not here, the client has no use for.
func _take_control(message):
	var root = message.root()
	var type = message.u8_field(root, 0)
	var body = message.table_field(root, 1)
	if message.broken:
		return false
	match type:
		1: return _take_welcome(message, body)
		2: return _take_chunk(message, body)
		3: return _take_event(message, body)
		4:
			var number = message.u8_field(body, 0)
			var detail = message.text_field(body, 1)
			if message.broken or number >= REASONS.size():
				return false
			_end(REASONS[number] + (": " + detail if detail != "" else ""), PASSING_REASONS.has(number))
		5: return _take_heights(message, body)
		9:
			notices.append(message.text_field(body, 0))
		10:
			if _welcome != null:
				_forget_scene()
				if not _leaving:
					_say_hello()
	return not message.broken


func _forget_scene():
	_welcome = null
	_is_first_scene = false
	state = JOINING
	_blueprints.forget()
	_hand = null
	for each in [bodies, _removed, obstacles]:
		each.clear()


func _take_welcome(message, body):
	var welcome = {"tick": message.u32_field(body, 2), "tick_hz": message.u16_field(body, 3),
		"snapshot_hz": message.u16_field(body, 4), "blueprints": message.u16_field(body, 6),
		"own_blueprint": message.u8_field(body, 13), "hands": message.u8_field(body, 9),
		"reach": message.float32_field(body, 10)}
	var name = message.text_field(body, 5)
	var surfaces = message.vector_field(body, 7, 32)
	var fields = message.vector_field(body, 8, 28)
	var own = message.u32_field(body, 1)
	if message.broken or _welcome != null or welcome.tick_hz == 0 or welcome.snapshot_hz == 0 or (
			surfaces[1] > 1024 or fields[1] > 16):
		return false
	if not grounds.begin(message, fields):
		return false
	for i in surfaces[1]:
		var at = surfaces[0] + 32 * i
		obstacles.append({"kind": message.u8(at), "a": message.vector3(at + 4), "b": message.vector3(at + 16),
			"radius": message.float32(at + 28)})
	_welcome = welcome
	worlds += 1
	hands = welcome.hands
	reach = welcome.reach
	_blueprints.expected = welcome.blueprints
	scene = name
	own_body = own
	_newest_tick = welcome.tick
	_clock = welcome.tick / float(welcome.tick_hz)
	_play_when_complete()
	return true


func _take_heights(message, body):
	if _welcome == null or not grounds.take(message, body):
		return false
	_play_when_complete()
	return true


func _play_when_complete():
	if grounds.are_complete() and (_welcome.blueprints == 0 or _blueprints.find(_welcome.own_blueprint) != null):
		state = PLAYING


func _take_chunk(message, body):
	if _welcome == null or not _blueprints.take(message, body):
		return false
	_play_when_complete()
	return true


func _take_event(message, body):
	var kind = message.u8_field(body, 0)
	var tick = message.u32_field(body, 1)
	var number = message.u32_field(body, 3)
	if message.broken or kind > 7:
		return false
	if kind == 2 and bodies.has(number):
		bodies[number].note_respawn(tick)
	elif kind == 3:
		bodies.erase(number)
		_removed[number] = tick
	return true


func _take_snapshot(bytes):
	var packet = _snapshots.read(bytes)
	if packet == null:
		return false
	if not _note_arrival(packet.sequence):
		return true
	if _welcome == null or (not _is_first_scene and packet.tick <= _welcome.tick):
		return true
	var time = packet.tick / float(_welcome.tick_hz)
	_pace = packet.pace
	_newest_tick = max(_newest_tick, packet.tick)
	_clock += (time - _clock) * (0.1 if abs(time - _clock) < 0.5 else 1.0)
	for record in packet.records:
		_take_record(record, packet.tick)
	return true


# Section 4. False for a packet that came before, or too late.
func _note_arrival(sequence):
	var ahead = sequence - _acked
	if ahead > 0:
		_history = (_history << ahead | (1 << (ahead - 1) if _acked > 0 else 0)) if ahead < 64 else (
			1 << 63 if ahead == 64 and _acked > 0 else 0)
		_acked = sequence
		return true
	if ahead == 0 or ahead < -64 or _history >> (-ahead - 1) & 1:
		return false
	_history |= 1 << (-ahead - 1)
	return true


# A body of several patches is shown by the pose of its first.
func _take_record(record, tick):
	var blueprint = _blueprints.find(record.blueprint)
	if blueprint == null or blueprint.generation != record.generation:
		return
	if record.patch >= blueprint.patches:
		refused += 1
		return
	if record.patch > 0 or tick <= _removed.get(record.body, -1):
		return
	var pose = _snapshots.read_pose(record, blueprint.exponent)
	if pose == null:
		refused += 1
		return
	if not bodies.has(record.body):
		bodies[record.body] = Body.new()
	bodies[record.body].blueprint = record.blueprint
	var interval = max(_welcome.tick_hz / _welcome.snapshot_hz, 1)
	bodies[record.body].add(tick, pose, record.rest > 0, interval)
