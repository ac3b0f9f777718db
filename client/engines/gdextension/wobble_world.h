// A node of Godot 4 that shows a world and plays in it, by the C interface.
#pragma once

#include <wobble.h>

#include <godot_cpp/classes/array_mesh.hpp>
#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <vector>

class WobbleWorld : public godot::MeshInstance3D {
  GDCLASS(WobbleWorld, godot::MeshInstance3D)

 public:
  void _ready() override;
  void _process(double delta) override;
  void _exit_tree() override;

  void set_address(const godot::String& address) { m_address = address; }
  godot::String get_address() const { return m_address; }

 protected:
  static void _bind_methods();

 private:
  static constexpr uint32_t kVertices = 1 << 16, kIndices = 6 * kVertices;  // a larger world is not drawn

  void Play();
  void TakeEvents();
  void Draw();

  godot::String m_address = "127.0.0.1:7777";
  wobble_client* m_client = nullptr;
  double m_now = 0;
  std::vector<float> m_positions = std::vector<float>(3 * kVertices), m_normals = m_positions;
  std::vector<uint32_t> m_indices = std::vector<uint32_t>(kIndices);
  godot::Ref<godot::ArrayMesh> m_mesh;
};
