# One FlatBuffer: reads the fields that the client needs, and builds messages of one table. Section 3 of STANDARD.md.
#
# There is no FlatBuffers for GDScript. Of the standard's checks this reader makes those that keep it within the
# buffer: each place, offset, vtable and vector that it reads. After a place that is not there it reads 0 and `broken`
# is true, so the caller reads all that it wants, and drops the message when `broken` is set. Absent fields read as 0.
extends Reference

var broken = false
var size = 0
var _buffer = StreamPeerBuffer.new()


func _init(bytes):
	size = bytes.size()
	_buffer.data_array = bytes


# The table that the buffer begins with.
func root():
	return follow(0)


func u8(at):
	return _buffer.get_u8() if _goes_to(at, 1, 1) else 0


func u16(at):
	return _buffer.get_u16() if _goes_to(at, 2, 2) else 0


func u32(at):
	return _buffer.get_u32() if _goes_to(at, 4, 4) else 0


func s64(at):
	return _buffer.get_64() if _goes_to(at, 8, 8) else 0


# Three floats, in the engine's axes.
func vector3(at):
	if not _goes_to(at, 12, 4):
		return Vector3()
	var x = _buffer.get_float()
	var y = _buffer.get_float()
	return turn(x, y, _buffer.get_float())


func float32(at):
	return _buffer.get_float() if _goes_to(at, 4, 4) else 0.0


func bytes(at, count):
	return _buffer.get_data(count)[1] if count > 0 and _goes_to(at, count, 1) else PoolByteArray()


# wobble's z is up, Godot's y is: x, z, -y.
static func turn(x, y, z):
	return Vector3(x, z, -y)


# The way back: vectors of the engine as floats in wobble's axes.
static func pack_vectors(vectors):
	var out = StreamPeerBuffer.new()
	for vector in vectors:
		out.put_float(vector.x)
		out.put_float(-vector.z)
		out.put_float(vector.y)
	return out.data_array


# Where field number `slot` of a table lies; 0 when it is absent, and reads there give 0.
func field(table, slot):
	var distance = u32(table)
	var vtable = table - (distance if distance < 1 << 31 else distance - (1 << 32))
	var vtable_size = u16(vtable)
	if not _goes_to(vtable, vtable_size, 2) or vtable_size < 6 + 2 * slot:
		return 0
	var offset = u16(vtable + 4 + 2 * slot)
	return table + offset if offset > 0 else 0


func u8_field(table, slot):
	var at = field(table, slot)
	return u8(at) if at > 0 else 0


func u16_field(table, slot):
	var at = field(table, slot)
	return u16(at) if at > 0 else 0


func u32_field(table, slot):
	var at = field(table, slot)
	return u32(at) if at > 0 else 0


func float32_field(table, slot):
	var at = field(table, slot)
	return float32(at) if at > 0 else 0.0


# The place that an offset points to.
func follow(at):
	var offset = u32(at)
	if offset == 0 or offset >= size:
		broken = true
	return at + offset


# The table in this field; 0 and broken when it is absent.
func table_field(table, slot):
	var at = field(table, slot)
	if at == 0:
		broken = true
		return 0
	return follow(at)


# A vector, or a string, of elements of `each` bytes: [place of the first, count]. `needed`: it must be there.
func vector_field(table, slot, each, needed = true):
	var at = field(table, slot)
	if at == 0:
		broken = broken or needed
		return [0, 0]
	var start = follow(at)
	var count = u32(start)
	if count > size or not _goes_to(start, 4 + count * each, 4):
		broken = true
		return [0, 0]
	return [start + 4, count]


# A text of a stranger as one line without control characters.
func text_field(table, slot):
	var found = vector_field(table, slot, 1)
	return make_line(bytes(found[0], found[1]).get_string_from_utf8())


# Direction marks and invisible characters are left out with the control characters.
static func make_line(text):
	var line = ""
	for i in text.length():
		var code = text.ord_at(i)
		var is_control = code < 32 or (code >= 127 and code < 160) or code == 0x2028 or code == 0x2029
		var is_format = code == 0xAD or (code >= 0x200B and code <= 0x200F) or (code >= 0x202A and code <= 0x202E) or (
			code >= 0x2060 and code <= 0x206F) or code == 0xFEFF or code == 0x61C
		if not is_format:
			line += " " if is_control else text[i]
	return line


func _goes_to(at, count, alignment):
	if at < 0 or at % alignment != 0 or at + count > size:
		broken = true
		return false
	_buffer.seek(at)
	return true


# Builds ClientMessage { body } of this type. fields: by slot, null or [bytes, number] of a number, [0, bytes, count] of
# a vector or string, [12 or 20, bytes] of a Vec3 or Hand. In the buffer come the message's table, the body's vtable, its table from the widest field to
# the narrowest, and its vectors.
static func build(type, fields):
	var places = []
	var at = 4  # in the body's table, behind the distance to its vtable
	for width in [8, 20, 12, 4, 0, 2, 1]:
		for slot in fields.size():
			if fields[slot] != null and fields[slot][0] == width:
				places.append([slot, at])
				at += width if width > 0 else 4
	var table = 24 + 4 + 2 * fields.size()
	table += (12 - table % 8) % 8  # its first field lies at a multiple of 8
	var vectors = (table + at + 3) & ~3

	var out = StreamPeerBuffer.new()
	for value in [12, 0x000C0008, 0x00040008, 8, table - 16, type]:
		out.put_u32(value)
	out.put_u16(4 + 2 * fields.size())
	out.put_u16(at)
	for slot in fields.size():
		var offset = 0
		for place in places:
			if place[0] == slot:
				offset = place[1]
		out.put_u16(offset)
	_pad(out, table)
	out.put_u32(table - 24)
	for place in places:
		var value = fields[place[0]]
		match value[0]:
			20, 12: out.put_data(value[1])
			8: out.put_64(value[1])
			4: out.put_u32(value[1])
			2: out.put_u16(value[1])
			1: out.put_u8(value[1])
			0:
				out.put_u32(vectors - out.get_position())
				vectors = (vectors + 4 + value[1].size() + 1 + 3) & ~3
	for place in places:
		var value = fields[place[0]]
		if value[0] == 0:
			_pad(out, (out.get_position() + 3) & ~3)
			out.put_u32(value[2])
			out.put_data(value[1])
			out.put_u8(0)
	_pad(out, (out.get_position() + 7) & ~7)
	return out.data_array


static func _pad(out, to):
	while out.get_position() < to:
		out.put_u8(0)
