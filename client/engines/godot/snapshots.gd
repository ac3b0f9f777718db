# Snapshot packets and the poses in them: sections 5 and 6 of STANDARD.md. Of a shape's payload only the head is
# decoded, which says where the body is and how it is turned; for the vertices one needs the bases as well.
extends Reference

const VERSION = 6
const GRID_FREQUENCIES = [30, 60, 200, 700, 1500, 1200, 250, 80, 40, 36]
const LENGTH_FREQUENCIES = [40, 20, 20, 20, 24, 32, 44, 60, 90, 140, 220, 350, 520, 680, 640, 480, 300, 170, 90, 50,
	30, 20, 14, 10, 8, 6, 4, 4, 4, 2, 2, 2]
const MODE_FREQUENCIES = [64, 1900, 32, 1600, 32, 200, 32, 236]

var _bytes = PoolByteArray()
var _at = 0
var _end = 0
var _code = 0
var _range = 0


# { sequence, tick, pace, records: [{ body, blueprint, patch, generation, rest, payload: [begin, end] }] }; null when
# the packet is to be refused whole.
func read(bytes):
	if bytes.size() < 16 or bytes.size() > 1176 or bytes[0] != 0x57 or bytes[1] != VERSION:
		return null
	_bytes = bytes
	_end = bytes.size()
	var pace = (bytes[10] | bytes[11] << 8) / 65535.0
	var packet = {"sequence": _u32(2), "tick": _u32(6), "pace": pace, "records": []}
	if packet.sequence == 0:
		return null
	_at = 16
	while _at < _end:
		var record = _read_record()
		if record == null or record.rest > packet.tick:
			return null
		packet.records.append(record)
	return packet


func _u32(at):
	return _bytes[at] | _bytes[at + 1] << 8 | _bytes[at + 2] << 16 | _bytes[at + 3] << 24


func _read_record():
	var record = {"body": _read_varint(), "patch": 0, "generation": 0, "rest": 0}
	var blueprint = _read_byte()
	record.blueprint = blueprint & 127
	if record.blueprint == 127:
		record.blueprint = _read_byte()
		if record.blueprint < 127:
			return null
	if blueprint & 128:
		var both = _read_byte()
		record.patch = both & 7
		record.generation = both >> 3
		record.rest = _read_varint()
		if record.rest < 0 or (both == 0 and record.rest == 0):
			return null
	var length = _read_varint()
	if record.body <= 0 or length <= 0 or length > _end - _at:
		return null
	record.payload = [_at, _at + length]
	_at += length
	return record


# 0 past the end, where a record is refused by its length.
func _read_byte():
	_at += 1
	return _bytes[_at - 1] if _at <= _end else 0


# -1 when it is longer than needed or than 5 bytes, too large, or cut off.
func _read_varint():
	var value = 0
	for i in 5:
		if _at >= _end:
			return -1
		var byte = _read_byte()
		value |= (byte & 127) << 7 * i
		if byte < 128:
			return -1 if (byte == 0 and i > 0) or value >= 1 << 32 else value
	return -1


# { place: [x, y, z], rotation: [w, x, y, z] } in the world's axes, of a record of the packet that was read last; null
# when it is to be refused. exponent: e of section 6, of the blueprint's size.
func read_pose(record, exponent):
	_begin(record.payload)
	if _read_symbol(MODE_FREQUENCIES) & 3 == 2:
		return null
	var grid = _read_symbol(GRID_FREQUENCIES)
	grid = _read_uniform(32) if grid == 9 else grid + 8 - exponent
	if grid < 0 or grid > 17:
		return null
	_read_uniform(64)  # the step of the shape
	var place = [0.0, 0.0, 0.0]
	for axis in 3:
		place[axis] = _read_coordinate() / float(1 << grid)
		if abs(place[axis]) > 8192:
			return null
	var largest = _read_uniform(4)
	var turn = int(clamp(grid + exponent + 1, 7, 16))
	var half = (46341 >> (16 - turn)) + 1
	var rotation = []
	var left = 1.0
	for i in 3:
		rotation.append((_read_uniform(2 * half + 1) - half) / float(1 << turn))
		left -= rotation[i] * rotation[i]
	if left <= 0.2 or _at > _end + 4:
		return null
	rotation.insert(largest, sqrt(left))  # w, x, y, z
	return {"place": place, "rotation": rotation}


# The range decoder.
func _begin(payload):
	_at = payload[0]
	_end = payload[1]
	_range = 0xFFFFFFFF
	_code = 0
	for i in 4:
		_code = _code << 8 | _read_byte()


func _read_symbol(frequencies):
	_range /= 4096
	var place = min(_code / _range, 4095)
	var symbol = 0
	var start = 0
	while start + frequencies[symbol] <= place:
		start += frequencies[symbol]
		symbol += 1
	_code -= start * _range
	_range *= frequencies[symbol]
	_refill()
	return symbol


func _read_uniform(count):
	_range /= count
	var value = int(min(_code / _range, count - 1))
	_code -= value * _range
	_refill()
	return value


func _refill():
	_code &= 0xFFFFFFFF
	while _range < 1 << 24:
		_code = (_code << 8 | _read_byte()) & 0xFFFFFFFF
		_range <<= 8


func _read_coordinate():
	var length = _read_symbol(LENGTH_FREQUENCIES)
	if length == 0:
		return 0
	var magnitude = 1 << (length - 1)
	var shift = 0
	var left = length - 1
	while left > 16:
		magnitude |= _read_uniform(1 << 16) << shift
		shift += 16
		left -= 16
	magnitude |= _read_uniform(1 << left) << shift
	return -magnitude if _read_uniform(2) == 1 else magnitude
