# Blueprints, what bodies of one kind have in common: the rest shape is kept and the bases are passed over. Section 2
# of STANDARD.md, "Blueprints".
extends Reference

const FlatBuffer = preload("res://flat_buffer.gd")

var expected = 0  # the welcome's blueprint_count
var taken = 0  # bytes, as Input.downloaded counts them
var _entries = {}  # number -> { is_in_force, generation, bytes and stated of what is in progress, and what `find` has }
var _editions = 0


# { generation, exponent, patches, rest, low, high, is_round, edition } of a blueprint in force, else null. exponent: e of
# section 6. rest: places of the vertices, low, high: the corners around them, in the engine's axes. edition: another number whenever the rest is
# another.
func find(number):
	var entry = _entries.get(number)
	return entry if entry != null and entry.is_in_force else null


# Another scene follows. What has been taken counts on.
func forget():
	_entries.clear()


# A BlueprintChunk, by the five points of the standard. Nothing is kept from connections before, so a piece without
# bytes is dropped. False when the piece is dropped.
func take(message, body):
	var number = message.u8_field(body, 0)
	var hash_at = message.field(body, 1)
	var stated = [message.s64(hash_at) if hash_at > 0 else 0, message.u32_field(body, 2), message.u8_field(body, 5)]
	var offset = message.u32_field(body, 3)
	var found = message.vector_field(body, 4, 1)
	var count = found[1]
	if message.broken or count > 4096 or stated[1] > 512 * 1024 or stated[2] > 31 or offset + count > stated[1] or (
			count == 0 and offset != stated[1]):
		return false
	taken += int(max(count, 1))
	var is_first = offset == 0 or count == 0
	if number == 255 or (not is_first and not _entries.has(number) and number >= expected):
		return false
	if not _entries.has(number):
		_entries[number] = {"is_in_force": false, "generation": 0, "bytes": PoolByteArray(), "stated": []}
	var entry = _entries[number]
	if is_first:
		entry.bytes = PoolByteArray()
		if entry.is_in_force and entry.generation == stated[2]:
			return true
		entry.stated = stated
	if count == 0 or offset != entry.bytes.size() or stated != entry.stated:
		entry.bytes = PoolByteArray()
		return false
	entry.bytes += message.bytes(found[0], count)
	if entry.bytes.size() < stated[1]:
		return true
	var whole = entry.bytes
	entry.bytes = PoolByteArray()
	return _hash(whole) == stated[0] and _put_in_force(entry, FlatBuffer.new(whole), stated[2])


# FNV-1a; integers of GDScript have 64 bits and wrap.
static func _hash(bytes):
	var value = 0xCBF29CE4 << 32 | 0x84222325
	for byte in bytes:
		value = (value ^ byte) * 0x100000001B3
	return value


func _put_in_force(entry, blueprint, generation):
	var table = blueprint.root()
	var rest = blueprint.vector_field(table, 1, 12)
	var size = blueprint.float32(blueprint.field(table, 3))
	if blueprint.broken or rest[1] < 1 or rest[1] > 4096 or not (size >= 0.001 and size <= 8192):
		return false
	var vertices = PoolVector3Array()
	var low = blueprint.vector3(rest[0])
	var high = low
	var nearest = INF
	var farthest = 0.0
	for i in rest[1]:
		var vertex = blueprint.vector3(rest[0] + 12 * i)
		var away = vertex.length()
		if not away <= 8192 * sqrt(3):  # or it is no number
			return false
		vertices.append(vertex)
		low = Vector3(min(low.x, vertex.x), min(low.y, vertex.y), min(low.z, vertex.z))
		high = Vector3(max(high.x, vertex.x), max(high.y, vertex.y), max(high.z, vertex.z))
		nearest = min(nearest, away)
		farthest = max(farthest, away)
	_editions += 1
	entry.is_in_force = true
	entry.generation = generation
	entry.exponent = _find_exponent(size)
	entry.patches = (rest[1] + 511) / 512
	entry.rest = vertices
	entry.low = low
	entry.high = high
	entry.is_round = nearest > 0.9 * farthest and rest[1] > 8  # 8: a cube
	entry.edition = _editions
	return true


# The smallest integer e with size < 2^e.
static func _find_exponent(size):
	var exponent = -10
	while size >= pow(2, exponent):
		exponent += 1
	return exponent
