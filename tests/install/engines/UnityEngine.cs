// What client/engines/unity names of Unity, which Debian does not have: as much as the compiler needs to check its
// syntax and what it calls of WobblePlayer. That it fits the real engine, this does not show.
using System;

namespace UnityEngine
{
    public struct Vector3 { public Vector3(float x, float y, float z) { } }
    public class Object { public static void Destroy(Object other) { } }
    public class Material : Object { }
    public class Mesh : Object
    {
        public int vertexCount;
        public Vector3[] vertices, normals;
        public int[] triangles;
        public void Clear() { }
        public void RecalculateBounds() { }
    }
    public class GameObject : Object
    {
        public Transform transform;
        public GameObject(string name, params Type[] components) { }
        public T GetComponent<T>() => throw new NotSupportedException();
    }
    public class Component : Object
    {
        public GameObject gameObject;
        public Transform transform;
        public T[] GetComponentsInChildren<T>() => throw new NotSupportedException();
    }
    public class Transform : Component { public Transform parent; }
    public class MeshFilter : Component { public Mesh mesh, sharedMesh; }
    public class MeshRenderer : Component { public Material material; }
    public class MonoBehaviour : Component { }
    public static class Debug { public static void Log(object message) { } }
    public static class Time { public static double realtimeSinceStartupAsDouble; }
    public enum KeyCode { Space }
    public static class Input
    {
        public static float GetAxis(string name) => 0;
        public static bool GetKey(KeyCode key) => false;
    }
}
