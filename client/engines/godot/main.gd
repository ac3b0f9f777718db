# Shows a world by spheres and boxes, and plays in it: arrow keys or WASD move, space jumps, E puffs up, F stiffens; G
# holds the nearest body overhead, V pushes it away. When it is cut off it tries to come back for --rejoin seconds, 60.
#
#   godot3 --path client/engines/godot [--url=ws://localhost:8080/play] [--name=NAME] [--password=WORD] [--rejoin=60]
#   godot3-server --path client/engines/godot --for=SECONDS ...    without a screen: rolls in a circle, then leaves
#
# With --for it prints twice a second where its own body is, in the world's axes, and how many bodies it sees; with --hold=1
# it also holds the nearest body, and prints where that is. Exit code 2: it did not get in, or was sent away.
extends Spatial

const Client = preload("res://client.gd")
const Lasting = preload("res://lasting.gd")
const OVERHEAD = Vector3(0, 1.5, 0)

var player = Lasting.new()
var client = null  # the player's present one
var was_cut_off = false
var seconds = 0.0  # of play without a player; 0: until the window is closed
var played = 0.0
var printed = 0.0
var meshes = {}  # body -> MeshInstance
var ground = null  # what stands still, of this world:
var drawn_world = ""
var held = 0  # body; 0: none
var held_vertex = 0
var always_holds = false
var camera = Camera.new()


func _ready():
	get_tree().set_auto_accept_quit(false)
	var options = {"url": "ws://localhost:8080/play", "name": "godot", "password": "", "for": "0", "rejoin": "60",
		"hold": "0"}
	for word in OS.get_cmdline_args():
		var parts = word.split("=", true, 1)
		var key = parts[0].trim_prefix("--")
		if parts.size() == 2 and parts[0].begins_with("--") and options.has(key):
			options[key] = parts[1]
	seconds = float(options["for"])
	always_holds = options.hold == "1"
	player.patience = float(options.rejoin)
	var credential = ""
	if options.password != "":
		var code = Marshalls.utf8_to_base64(options.password)
		credential = "password." + code.replace("+", "-").replace("/", "_").replace("=", "")
	player.connect_to(options.url, options.name, credential)
	var key = InputEventKey.new()
	key.scancode = KEY_V
	InputMap.add_action("push")
	InputMap.action_add_event("push", key)
	camera.far = 500
	add_child(camera)
	var light = DirectionalLight.new()
	light.rotation_degrees = Vector3(-60, 30, 0)
	add_child(light)


func _notification(what):
	if what == NOTIFICATION_WM_QUIT_REQUEST:
		player.leave()


func _process(delta):
	player.update(delta)
	client = player.current
	while not client.notices.empty():
		print(client.notices.pop_front())
	if player.state == Lasting.ENDED:
		if player.failed:
			printerr("wobble: " + player.reason)
		print("left; %d messages refused" % client.refused)
		get_tree().quit(2 if player.failed else 0)
		set_process(false)
		return
	var is_cut_off = player.state == Lasting.REJOINING
	if is_cut_off != was_cut_off:
		was_cut_off = is_cut_off
		print("cut off: " + player.reason if is_cut_off else "plays again")
	if client.state == Client.PLAYING:
		play(delta)
		draw()


func play(delta):
	played += delta
	if seconds > 0:
		client.move_x = cos(played)
		client.move_y = sin(played)
		if played > seconds:
			player.leave()
	else:
		client.move_x = hold(KEY_D, KEY_RIGHT) - hold(KEY_A, KEY_LEFT)
		client.move_y = hold(KEY_W, KEY_UP) - hold(KEY_S, KEY_DOWN)
		client.buttons = (Client.JUMP * hold(KEY_SPACE, KEY_SPACE) + Client.PUFF * hold(KEY_E, KEY_E) +
			Client.STIFFEN * hold(KEY_F, KEY_F))
	use_hands()
	var own = client.sample(client.own_body)
	if seconds > 0 and played >= printed + 0.5 and own != null:
		printed = played
		print("x %.3f  y %.3f  z %.3f  bodies %d" % [own.origin.x, -own.origin.z, own.origin.y, client.bodies.size()])
		var there = client.sample(held) if held > 0 else null
		if there != null:
			print("holds %d  z %.3f" % [held, there.origin.y])


func use_hands():
	var own = client.sample(client.own_body)
	var wants = always_holds or Input.is_key_pressed(KEY_G)
	if own == null or (held > 0 and not client.bodies.has(held)) or not wants:
		held = 0
		client.release()
	if own == null:
		return
	if wants and held == 0 and client.hands & Client.MAY_GRAB:
		held = find_nearest(own.origin)
		held_vertex = client.find_vertex(held, own.origin + OVERHEAD) if held > 0 else -1
		held = held if held_vertex >= 0 else 0
	if held > 0:
		client.hold(held, held_vertex, own.origin + OVERHEAD)
	if Input.is_action_just_pressed("push") and client.hands & Client.MAY_PUSH:
		var near = find_nearest(own.origin)
		var vertex = client.find_vertex(near, own.origin) if near > 0 else -1
		if vertex >= 0:
			client.push(near, vertex, client.sample(near).origin - own.origin)


# The body within reach, 0 for none.
func find_nearest(point):
	var nearest = 0
	var least = client.reach if client.reach > 0 else INF
	for number in client.bodies:
		var where = client.sample(number)
		if number != client.own_body and where != null and where.origin.distance_to(point) < least:
			least = where.origin.distance_to(point)
			nearest = number
	return nearest


func hold(key, other):
	return int(Input.is_key_pressed(key) or Input.is_key_pressed(other))


func draw():
	var world = "%d %d" % [client.get_instance_id(), client.worlds]
	if drawn_world != world:
		drawn_world = world
		for number in meshes:
			meshes[number].queue_free()
		meshes.clear()
		draw_ground()
	for number in meshes.keys():
		if not client.bodies.has(number):
			meshes[number].queue_free()
			meshes.erase(number)
	for number in client.bodies:
		var where = client.sample(number)
		var blueprint = client.find_blueprint(number)
		if where == null or blueprint == null:
			continue
		if not meshes.has(number):
			meshes[number] = MeshInstance.new()
			meshes[number].set_meta("edition", 0)
			add_child(meshes[number])
		if meshes[number].get_meta("edition") != blueprint.edition:
			meshes[number].set_meta("edition", blueprint.edition)
			meshes[number].mesh = make_mesh(blueprint, number == client.own_body)
		var middle = Transform(Basis(), (blueprint.low + blueprint.high) / 2)
		meshes[number].transform = where * middle
	var own = client.sample(client.own_body)
	var at = own.origin if own != null else Vector3()
	camera.look_at_from_position(at + Vector3(0, 7, 10), at, Vector3.UP)


func make_mesh(blueprint, is_own):
	var extent = blueprint.high - blueprint.low
	var mesh = SphereMesh.new() if blueprint.is_round else CubeMesh.new()
	if blueprint.is_round:
		mesh.radius = extent.y / 2
		mesh.height = extent.y
	else:
		mesh.size = Vector3(max(extent.x, 0.05), max(extent.y, 0.05), max(extent.z, 0.05))
	mesh.material = make_material(Color.orange if is_own else Color.steelblue)
	return mesh


func make_material(colour):
	var material = SpatialMaterial.new()
	material.albedo_color = colour
	return material


# Planes that face up, boxes, and grounds of heights; a plane as a square of 100 m.
func draw_ground():
	if ground != null:
		ground.free()
	ground = Spatial.new()
	add_child(ground)
	for obstacle in client.obstacles:
		var shown = MeshInstance.new()
		if obstacle.kind == 0 and obstacle.a.y > 0.5:
			shown.mesh = PlaneMesh.new()
			shown.mesh.size = Vector2(100, 100)
			shown.transform.origin = obstacle.a * obstacle.b.x
		elif obstacle.kind == 1:
			shown.mesh = CubeMesh.new()
			shown.mesh.size = 2 * obstacle.b.abs()
			shown.transform.origin = obstacle.a
		else:
			continue
		shown.mesh.material = make_material(Color(0.35, 0.4, 0.35))
		ground.add_child(shown)
	for mesh in client.grounds.make_meshes():
		var shown = MeshInstance.new()
		shown.mesh = mesh
		shown.material_override = make_material(Color(0.35, 0.4, 0.35))
		ground.add_child(shown)
