#include "wobble_world.h"

#include <chrono>
#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/input.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/godot.hpp>
#include <godot_cpp/variant/utility_functions.hpp>
#include <thread>

using namespace godot;

void WobbleWorld::_bind_methods() {
  ClassDB::bind_method(D_METHOD("set_address", "address"), &WobbleWorld::set_address);
  ClassDB::bind_method(D_METHOD("get_address"), &WobbleWorld::get_address);
  ADD_PROPERTY(PropertyInfo(Variant::STRING, "address"), "set_address", "get_address");
}

// 1. Connect.
void WobbleWorld::_ready() {
  if (Engine::get_singleton()->is_editor_hint()) return;
  const CharString address = m_address.utf8();
  wobble_connect_options options{};
  options.struct_size = sizeof options;
  options.address = address.get_data();
  options.name = "godot";
  const wobble_result result = wobble_connect(&options, m_now, &m_client);
  if (result != WOBBLE_OK) UtilityFunctions::printerr("wobble: ", wobble_describe(result));
  m_mesh.instantiate();
  set_mesh(m_mesh);
}

// 2. Update. The clock is the sum of the frames.
void WobbleWorld::_process(double delta) {
  if (m_client == nullptr) return;
  m_now += delta;
  wobble_update(m_client, m_now);
  wobble_status status{};
  status.struct_size = sizeof status;
  wobble_read_status(m_client, &status);
  if (status.state == WOBBLE_ENDED) {
    UtilityFunctions::print("wobble: ", String::utf8(status.reason));
    wobble_destroy(m_client);
    m_client = nullptr;
    return;
  }
  Play();
  TakeEvents();
  Draw();
}

// 3. Play, by the actions that each project of Godot has.
void WobbleWorld::Play() {
  const Input* keys = Input::get_singleton();
  wobble_input input{};
  input.struct_size = sizeof input;
  input.move_x = static_cast<float>(keys->get_axis("ui_left", "ui_right"));
  input.move_y = static_cast<float>(keys->get_axis("ui_down", "ui_up"));
  input.buttons = keys->is_action_pressed("ui_accept") ? WOBBLE_JUMP : 0;
  wobble_set_input(m_client, &input);
}

// 4. Sample and draw: all bodies are one mesh.
void WobbleWorld::Draw() {
  m_mesh->clear_surfaces();
  wobble_frame frame{};
  frame.struct_size = sizeof frame;
  frame.vertex_capacity = kVertices;
  frame.index_capacity = kIndices;
  frame.positions = m_positions.data();
  frame.normals = m_normals.data();
  frame.indices = m_indices.data();
  if (wobble_sample(m_client, m_now, &frame) != WOBBLE_OK || frame.index_count == 0) return;

  PackedVector3Array vertices, normals;
  PackedInt32Array indices;
  vertices.resize(frame.vertex_count);
  normals.resize(frame.vertex_count);
  indices.resize(frame.index_count);
  for (uint32_t v = 0; v < frame.vertex_count; ++v) {  // wobble's z is up, Godot's y is
    const float *p = &m_positions[3 * v], *n = &m_normals[3 * v];
    vertices.ptrw()[v] = Vector3(p[0], p[2], -p[1]);
    normals.ptrw()[v] = Vector3(n[0], n[2], -n[1]);
  }
  for (uint32_t i = 0; i < frame.index_count; i += 3) {  // a front face is clockwise in Godot
    indices.ptrw()[i] = static_cast<int32_t>(m_indices[i]);
    indices.ptrw()[i + 1] = static_cast<int32_t>(m_indices[i + 2]);
    indices.ptrw()[i + 2] = static_cast<int32_t>(m_indices[i + 1]);
  }
  Array surface;
  surface.resize(Mesh::ARRAY_MAX);
  surface[Mesh::ARRAY_VERTEX] = vertices;
  surface[Mesh::ARRAY_NORMAL] = normals;
  surface[Mesh::ARRAY_INDEX] = indices;
  m_mesh->add_surface_from_arrays(Mesh::PRIMITIVE_TRIANGLES, surface);
}

// 5. Events, and leave.
void WobbleWorld::TakeEvents() {
  wobble_event event{};
  event.struct_size = sizeof event;
  while (wobble_next_event(m_client, &event) == WOBBLE_OK) {
    if (event.kind == WOBBLE_NOTICE) UtilityFunctions::print(String::utf8(event.text));
  }
}

void WobbleWorld::_exit_tree() {
  if (m_client == nullptr) return;
  wobble_leave(m_client, m_now);
  wobble_status status{};
  status.struct_size = sizeof status;
  for (int i = 0; i < 50 && status.state != WOBBLE_ENDED; ++i) {  // the answer takes a round trip
    wobble_update(m_client, m_now += 0.01);
    wobble_read_status(m_client, &status);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  wobble_destroy(m_client);
  m_client = nullptr;
}

// wobble.gdextension names this function.
extern "C" GDExtensionBool GDE_EXPORT wobble_init(GDExtensionInterfaceGetProcAddress get_proc_address,
                                                  GDExtensionClassLibraryPtr library,
                                                  GDExtensionInitialization* initialization) {
  const GDExtensionBinding::InitObject binding(get_proc_address, library, initialization);
  binding.register_initializer([](ModuleInitializationLevel level) {
    if (level == MODULE_INITIALIZATION_LEVEL_SCENE) ClassDB::register_class<WobbleWorld>();
  });
  binding.register_terminator([](ModuleInitializationLevel) {});
  binding.set_minimum_library_initialization_level(MODULE_INITIALIZATION_LEVEL_SCENE);
  return binding.init();
}
