// What client/engines/gdextension names of godot-cpp, which Debian does not have: as much as its syntax and its calls
// of the C interface need to be compiled. That it fits the real godot-cpp, this does not show.
#pragma once

#include <cstddef>
#include <cstdint>

#define GDCLASS(Class, Parent)
#define GDE_EXPORT
#define D_METHOD(...) #__VA_ARGS__
#define ADD_PROPERTY(...) godot::AddProperty(__VA_ARGS__)

using GDExtensionBool = unsigned char;
struct GDExtensionInitialization {};
using GDExtensionInterfaceGetProcAddress = void (*)();
using GDExtensionClassLibraryPtr = void*;

namespace godot {

struct CharString {
  const char* get_data() const;
};
struct String {
  String(const char* text = "");
  CharString utf8() const;
  static String utf8(const char* text);
};
struct Variant {
  enum Type { STRING };
  template <typename Value>
  Variant& operator=(const Value& value);
};
struct PropertyInfo {
  PropertyInfo(Variant::Type type, const char* name);
};
void AddProperty(const PropertyInfo& property, const char* setter, const char* getter);
struct Vector3 {
  Vector3(float x = 0, float y = 0, float z = 0);
};
template <typename Value>
struct PackedArray {
  void resize(int64_t count);
  Value* ptrw();
};
using PackedVector3Array = PackedArray<Vector3>;
using PackedInt32Array = PackedArray<int32_t>;
struct Array {
  void resize(int64_t count);
  Variant& operator[](int64_t index);
};
template <typename Value>
struct Ref {
  void instantiate();
  Value* operator->() const;
};
struct Mesh {
  enum ArrayType { ARRAY_VERTEX = 0, ARRAY_NORMAL = 1, ARRAY_INDEX = 12, ARRAY_MAX = 13 };
  enum PrimitiveType { PRIMITIVE_TRIANGLES = 3 };
};
struct ArrayMesh : Mesh {
  void clear_surfaces();
  void add_surface_from_arrays(PrimitiveType primitive, const Array& arrays);
};
struct MeshInstance3D {
  virtual ~MeshInstance3D() = default;
  virtual void _ready();
  virtual void _process(double delta);
  virtual void _exit_tree();
  void set_mesh(const Ref<ArrayMesh>& mesh);
};
struct Engine {
  static Engine* get_singleton();
  bool is_editor_hint() const;
};
struct Input {
  static Input* get_singleton();
  double get_axis(const char* negative, const char* positive) const;
  bool is_action_pressed(const char* action) const;
};
struct UtilityFunctions {
  template <typename... Values>
  static void print(const Values&... values);
  template <typename... Values>
  static void printerr(const Values&... values);
};
enum ModuleInitializationLevel { MODULE_INITIALIZATION_LEVEL_SCENE };
struct ClassDB {
  template <typename Method>
  static void bind_method(const char* name, Method method);
  template <typename Class>
  static void register_class();
};
struct GDExtensionBinding {
  struct InitObject {
    InitObject(GDExtensionInterfaceGetProcAddress, GDExtensionClassLibraryPtr, GDExtensionInitialization*);
    void register_initializer(void (*callback)(ModuleInitializationLevel)) const;
    void register_terminator(void (*callback)(ModuleInitializationLevel)) const;
    void set_minimum_library_initialization_level(ModuleInitializationLevel level) const;
    GDExtensionBool init() const;
  };
};

}  // namespace godot
