# A player in one world, over a gateway's WebSocket: section 2 of STANDARD.md, from hello to goodbye.
#
# Call `update` once a frame; `sample` then tells where each of `bodies` is to be drawn. It does not join again by
# itself when the connection is lost, keeps no blueprints, and opens no lanes; the other clients of wobble do.
extends Reference

const Blueprints = preload("res://blueprints.gd")
const FlatBuffer = preload("res://flat_buffer.gd")
const Snapshots = preload("res://snapshots.gd")

enum { JOINING, PLAYING, ENDED }  # states
enum { JUMP = 1, PUFF = 2, STIFFEN = 4 }  # buttons

# The first 8 bytes of the SHA-256 of protocol/messages.fbs: another one has another hash, and the server says so.
const SCHEMA_HASH = 0x61561083 << 32 | 0x745c6920
const SILENCE = 8.0  # s without a message, after which the other end is gone
const DELAY = 0.1  # s of the world by which bodies are shown late, so that a pose after that moment is mostly there
const MOST_NAME = 32  # bytes
const POSES = 8  # that are kept of a body
const REASONS = ["left", "the server is closing", "the server is full", "the server speaks another version",
	"the server has another schema", "no hello in time", "silent for too long", "too many bad messages",
	"the server is too busy, try later", "too much was sent", "kicked", "banned",
	"the password, invite or token is missing or not valid", "too many from this address"]

var state = JOINING
var reason = ""  # why it has ended
var failed = false  # it has ended, and not by `leave`
var scene = ""
var own_body = 0
var obstacles = []  # { kind, a, b, radius } in the world's axes, as messages.fbs has them; to be drawn
var bodies = {}  # number -> { blueprint, poses: [{ tick, place, rotation, rests }], respawn }
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
var _heights_missing = []  # by field
var _blueprints = Blueprints.new()
var _removed = {}  # body -> tick
var _clock = 0.0  # of the world as its newest snapshots show it, s
var _pace = 1.0
var _newest_tick = 0
var _acked = 0
var _history = 0
var _heights_taken = 0  # bytes
var _frames = []  # of input, newest first: [tick, x, y, buttons]
var _input_due = 0.0
var _silence = 0.0
var _leaving = false


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
		_end("no answer from %s" % _url if _welcome == null else "the server has been silent for %d s" % SILENCE)


# Says goodbye. Go on with `update` until the state is ENDED.
func leave():
	if state == ENDED or _leaving:
		return
	_leaving = true
	_silence = SILENCE - 1  # the answer may take 1 s
	_send(0, FlatBuffer.build(3, [[1, 0], [0, PoolByteArray(), 0]]))
	_socket.disconnect_from_host()


# Where a body is to be shown now; null when that is not known.
func sample(number):
	if not bodies.has(number) or bodies[number].poses.empty():
		return null
	var poses = bodies[number].poses
	var tick = (_clock - DELAY) * _welcome.tick_hz
	var after = 0
	while after < poses.size() and poses[after].tick < tick:
		after += 1
	var b = poses[min(after, poses.size() - 1)]
	var a = poses[max(after - 1, 0)]
	var share = clamp((tick - a.tick) / max(b.tick - a.tick, 1), 0, 1)
	return Transform(Basis(a.rotation.slerp(b.rotation, share)), a.place.linear_interpolate(b.place, share))


# The blueprint of a body, for its size: blueprints.gd. null when there is none.
func find_blueprint(number):
	return _blueprints.find(bodies[number].blueprint)


func _end(why):
	if state == ENDED:
		return
	state = ENDED
	reason = "left" if _leaving else why
	failed = not _leaving


func _on_open(_protocol):
	_silence = 0.0
	_socket.get_peer(1).set_write_mode(WebSocketPeer.WRITE_MODE_BINARY)
	_say_hello()


func _on_error():
	_end("%s: nobody answers, or the gateway refuses: no such world, or too many joins" % _url)


func _on_close_request(code, why):
	_end(FlatBuffer.make_line(why) if why != "" else "closed by the gateway, code %d" % code)


func _on_closed(_was_clean):
	_end("the connection to %s was lost" % _url)


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
	_send(1, FlatBuffer.build(2, [[0, bytes.data_array, _frames.size()], [4, _acked], [8, _history], null, null,
		[4, (_heights_taken + _blueprints.taken) & 0xFFFFFFFF]]))


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
			_end(REASONS[number] + (": " + detail if detail != "" else ""))
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
	for each in [bodies, _removed, obstacles]:
		each.clear()


func _take_welcome(message, body):
	var welcome = {"tick": message.u32_field(body, 2), "tick_hz": message.u16_field(body, 3),
		"snapshot_hz": message.u16_field(body, 4), "blueprints": message.u16_field(body, 6),
		"own_blueprint": message.u8_field(body, 13)}
	var name = message.text_field(body, 5)
	var surfaces = message.vector_field(body, 7, 32)
	var fields = message.vector_field(body, 8, 28)
	var own = message.u32_field(body, 1)
	if message.broken or _welcome != null or welcome.tick_hz == 0 or welcome.snapshot_hz == 0 or (
			surfaces[1] > 1024 or fields[1] > 16):
		return false
	_heights_missing = []
	for i in fields[1]:
		var at = fields[0] + 28 * i
		_heights_missing.append(message.u16(at + 24) * message.u16(at + 26))
	for i in surfaces[1]:
		var at = surfaces[0] + 32 * i
		obstacles.append({"kind": message.u8(at), "a": message.vector3(at + 4), "b": message.vector3(at + 16),
			"radius": message.float32(at + 28)})
	_welcome = welcome
	_blueprints.expected = welcome.blueprints
	scene = name
	own_body = own
	_newest_tick = welcome.tick
	_clock = welcome.tick / float(welcome.tick_hz)
	_play_when_complete()
	return true


func _take_heights(message, body):
	var field = message.u16_field(body, 0)
	var heights = message.vector_field(body, 2, 2)
	if message.broken or _welcome == null:
		return false
	_heights_taken += 2 * heights[1]
	if field >= _heights_missing.size():
		return false
	_heights_missing[field] -= heights[1]
	_play_when_complete()
	return true


func _play_when_complete():
	for missing in _heights_missing:
		if missing > 0:
			return
	if _welcome.blueprints == 0 or _blueprints.find(_welcome.own_blueprint) != null:
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
	if message.broken or kind > 4:
		return false
	if kind == 2 and bodies.has(number):
		bodies[number].respawn = tick
		_forget_before_respawn(bodies[number])
	elif kind == 3:
		bodies.erase(number)
		_removed[number] = tick
	return true


# Once there is a pose from after the respawn, nothing is shown between the two.
func _forget_before_respawn(body):
	if body.poses.empty() or body.poses.back().tick < body.respawn:
		return
	while body.poses[0].tick < body.respawn:
		body.poses.pop_front()


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
		bodies[record.body] = {"blueprint": 0, "poses": [], "respawn": 0}
	var body = bodies[record.body]
	var poses = body.poses
	if not poses.empty() and tick <= poses.back().tick:
		return
	var interval = max(_welcome.tick_hz / _welcome.snapshot_hz, 1)
	if not poses.empty() and poses.back().rests and tick - poses.back().tick > interval:
		var still = poses.back().duplicate()  # it has lain there until about now
		still.tick = tick - interval
		poses.append(still)
	var p = pose.place
	var q = pose.rotation
	var axis = FlatBuffer.turn(q[1], q[2], q[3])
	poses.append({"tick": tick, "place": FlatBuffer.turn(p[0], p[1], p[2]),
		"rotation": Quat(axis.x, axis.y, axis.z, q[0]).normalized(), "rests": record.rest > 0})
	while poses.size() > POSES:
		poses.pop_front()
	body.blueprint = record.blueprint
	_forget_before_respawn(body)
