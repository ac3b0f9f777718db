# Grounds of heights, as they come in rows. Section 2 of STANDARD.md, "HeightRows".
extends Reference

const FlatBuffer = preload("res://flat_buffer.gd")

var taken = 0  # bytes, as Input.downloaded counts them
var _fields = []  # { corner, cell_size, low, step, columns, rows, heights }; of heights those that have come, m


# The height fields of a welcome: [place of the first, count]. False when one cannot be; then nothing has changed.
func begin(message, found):
	var fields = []
	for i in found[1]:
		var at = found[0] + 28 * i
		var numbers = []
		for j in 6:
			numbers.append(message.float32(at + 4 * j))
			if not abs(numbers[j]) <= 8192:  # or it is no number
				return false
		var field = {"corner": [numbers[0], numbers[1]], "cell_size": numbers[3], "low": numbers[2] + numbers[4],
			"step": numbers[5], "columns": message.u16(at + 24), "rows": message.u16(at + 26), "heights": []}
		if field.columns < 2 or field.columns > 128 or field.rows < 2 or field.rows > 128 or field.cell_size <= 0:
			return false
		fields.append(field)
	_fields = fields
	return not message.broken


# HeightRows. False when they are dropped.
func take(message, body):
	var number = message.u16_field(body, 0)
	var first = message.u16_field(body, 1)
	var heights = message.vector_field(body, 2, 2)
	if message.broken:
		return false
	taken += 2 * heights[1]
	if number >= _fields.size():
		return false
	var field = _fields[number]
	var all = field.columns * field.rows
	if heights[1] % field.columns != 0 or first * field.columns != field.heights.size() or (
			field.heights.size() + heights[1] > all):
		return false
	for i in heights[1]:
		field.heights.append(field.low + field.step * message.u16(heights[0] + 2 * i))
	return true


func are_complete():
	for field in _fields:
		if field.heights.size() < field.columns * field.rows:
			return false
	return true


# One mesh for each ground, in the engine's axes.
func make_meshes():
	var meshes = []
	for field in _fields:
		var surface = SurfaceTool.new()
		surface.begin(Mesh.PRIMITIVE_TRIANGLES)
		for i in field.heights.size():
			surface.add_vertex(FlatBuffer.turn(field.corner[0] + field.cell_size * (i % field.columns),
				field.corner[1] + field.cell_size * (i / field.columns), field.heights[i]))
		for i in field.heights.size() - field.columns:
			if (i + 1) % field.columns > 0:
				var above = i + field.columns
				for corner in [i, above, i + 1, i + 1, above, above + 1]:  # clockwise as seen from above
					surface.add_index(corner)
		surface.generate_normals()
		meshes.append(surface.commit())
	return meshes
