# A player who stays: joins again when it was cut off, by a new client for each try. Until that one plays, `current` is the
# client of before, whose world stands still.
#
# The waits double, up to a longest one, and each is shortened by chance, to half of it at most: the players of a server
# that was restarted all lose it at the same moment.
extends Reference

const Client = preload("res://client.gd")

enum { JOINING, PLAYING, REJOINING, ENDED }  # states

const FIRST_WAIT = 0.25  # s before the first try
const LONGEST_WAIT = 4.0
const SETTLED = 10.0  # s of play after which the next loss counts as a new one

var patience = 60.0  # s without play after which it gives up; 0: it never joins again
var state = JOINING
var reason = ""  # why the connection was lost, or why it has ended
var failed = false  # it has ended, and not by `leave`
var current = null  # the client that plays; another one after each return
var rejoins = 0

var _arguments = []
var _next = null  # the try that is under way
var _wait = 0.0
var _due = 0.0  # s until the next try
var _left = 0.0  # s of patience
var _played = 0.0  # s since it plays
var _leaving = false


# As `connect_to` of the client.
func connect_to(url, name, credential = ""):
	_arguments = [url, name, credential]
	randomize()
	current = _dial()


func update(delta):
	match state:
		JOINING, PLAYING:
			current.update(delta)
			_played += delta
			if state == JOINING and current.state == Client.PLAYING:
				_note_playing()
			if current.state == Client.ENDED:
				_note_loss()
		REJOINING:
			_try_again(delta)


# Says goodbye. Go on with `update` until the state is ENDED.
func leave():
	_leaving = true
	if state == REJOINING:
		_end("left")
	elif state != ENDED:
		current.leave()


func _dial():
	var client = Client.new()
	client.connect_to(_arguments[0], _arguments[1], _arguments[2])
	return client


func _note_playing():
	state = PLAYING
	_played = 0.0


func _note_loss():
	if state == JOINING or _leaving or not current.may_rejoin or patience <= 0:
		return _end(current.reason)
	if _wait == 0 or _played >= SETTLED:
		_wait = 0.0
		_left = patience
	state = REJOINING
	reason = current.reason
	_plan_try()


func _plan_try():
	_next = null
	_wait = FIRST_WAIT if _wait == 0 else min(2 * _wait, LONGEST_WAIT)
	_due = _wait * rand_range(0.5, 1)


func _try_again(delta):
	_left -= delta
	if _left <= 0:
		return _end("%s; gave up joining again after %d s" % [reason, patience])
	if _next == null:
		_due -= delta
		if _due > 0:
			return
		_next = _dial()
	_next.update(delta)
	if _next.state == Client.PLAYING:
		current = _next
		_next = null
		rejoins += 1
		reason = ""
		_note_playing()
	elif _next.state == Client.ENDED:
		if not _next.may_rejoin:
			return _end(_next.reason)
		_plan_try()


func _end(why):
	state = ENDED
	_next = null
	reason = why
	failed = not _leaving
