# Where one body has been lately, so that it can be shown between two snapshots.
extends Reference

const FlatBuffer = preload("res://flat_buffer.gd")

const MOST = 8  # poses

var blueprint = 0
var _poses = []  # { tick, place, rotation, rests }, the oldest first
var _respawn = 0  # tick


# pose: as snapshots.gd reads it. rests: it lies there. interval: ticks between two snapshots. A pose that is not newer
# than all others is passed over.
func add(tick, pose, rests, interval):
	if not _poses.empty() and tick <= _poses.back().tick:
		return
	if not _poses.empty() and _poses.back().rests and tick - _poses.back().tick > interval:
		var still = _poses.back().duplicate()  # it has lain there until about now
		still.tick = tick - interval
		_poses.append(still)
	var p = pose.place
	var q = pose.rotation
	var axis = FlatBuffer.turn(q[1], q[2], q[3])
	_poses.append({"tick": tick, "place": FlatBuffer.turn(p[0], p[1], p[2]),
		"rotation": Quat(axis.x, axis.y, axis.z, q[0]).normalized(), "rests": rests})
	while _poses.size() > MOST:
		_poses.pop_front()
	_forget_before_respawn()


func note_respawn(tick):
	_respawn = tick
	_forget_before_respawn()


# The Transform at a tick, which may be a fraction; null when nothing is known.
func find(tick):
	if _poses.empty():
		return null
	var after = 0
	while after < _poses.size() and _poses[after].tick < tick:
		after += 1
	var b = _poses[min(after, _poses.size() - 1)]
	var a = _poses[max(after - 1, 0)]
	var share = clamp((tick - a.tick) / max(b.tick - a.tick, 1), 0, 1)
	return Transform(Basis(a.rotation.slerp(b.rotation, share)), a.place.linear_interpolate(b.place, share))


# Once there is a pose from after the respawn, nothing is shown between the two.
func _forget_before_respawn():
	if _poses.empty() or _poses.back().tick < _respawn:
		return
	while _poses[0].tick < _respawn:
		_poses.pop_front()
