// Shows a world in Unity and plays in it: put it on an empty object and give it a material.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using UnityEngine;

public class WobbleWorld : MonoBehaviour
{
    public string address = "127.0.0.1:7777";
    public string playerName = "unity";
    public Material material;

    WobblePlayer player;
    readonly Dictionary<uint, Mesh> meshes = new Dictionary<uint, Mesh>();
    float[] floats = new float[0];

    void Start() => player = new WobblePlayer(address, playerName, null, Time.realtimeSinceStartupAsDouble);

    void Update()
    {
        if (player == null) return;
        double now = Time.realtimeSinceStartupAsDouble;
        if (!player.Update(now))
        {
            Debug.Log("wobble: " + player.Reason);
            OnDestroy();
            return;
        }
        player.Play(Input.GetAxis("Horizontal"), Input.GetAxis("Vertical"),
                    Input.GetKey(KeyCode.Space) ? WobbleNative.Jump : 0);
        while (player.TakeEvent(out WobbleNative.Event next))
        {
            if (next.kind == WobbleNative.Notice) Debug.Log(WobbleNative.FromUtf8(next.text));
            if (next.kind == WobbleNative.NewWorld) Clear();
            if (next.kind == WobbleNative.BodyRemoved) Remove(next.body);
        }
        player.Sample(now);
        foreach (WobbleNative.Body body in player.Bodies) Show(body);
    }

    void Show(WobbleNative.Body body)
    {
        if (!meshes.TryGetValue(body.body, out Mesh mesh))
        {
            var shown = new GameObject("body " + body.body, typeof(MeshFilter), typeof(MeshRenderer));
            shown.transform.parent = transform;
            shown.GetComponent<MeshRenderer>().material = material;
            mesh = meshes[body.body] = shown.GetComponent<MeshFilter>().mesh;
        }
        int count = (int)body.vertexCount;
        if (body.changed == 0 && mesh.vertexCount == count) return;
        bool isOther = mesh.vertexCount != count || mesh.triangles.Length != 3 * body.faceCount;
        if (isOther) mesh.Clear(); // a torn body has other vertices
        mesh.vertices = Read(body.positions, count);
        if (isOther) mesh.triangles = ReadFaces(body);
        mesh.normals = Read(body.normals, count);
        mesh.RecalculateBounds();
    }

    // wobble's z is up and its axes are right-handed; Unity's y is up and its axes are left-handed.
    Vector3[] Read(IntPtr from, int count)
    {
        if (floats.Length < 3 * count) floats = new float[3 * count];
        Marshal.Copy(from, floats, 0, 3 * count);
        var vectors = new Vector3[count];
        for (int i = 0; i < count; ++i) vectors[i] = new Vector3(floats[3 * i], floats[3 * i + 2], floats[3 * i + 1]);
        return vectors;
    }

    // Seen from outside they are counter-clockwise in wobble, and clockwise in Unity.
    static int[] ReadFaces(WobbleNative.Body body)
    {
        var shorts = new short[3 * body.faceCount];
        if (shorts.Length > 0) Marshal.Copy(body.faces, shorts, 0, shorts.Length);
        var faces = new int[shorts.Length];
        for (int i = 0; i < faces.Length; ++i) faces[i] = (ushort)shorts[i - i % 3 + (3 - i % 3) % 3];
        return faces;
    }

    void Remove(uint body)
    {
        if (!meshes.TryGetValue(body, out Mesh mesh)) return;
        meshes.Remove(body);
        foreach (MeshFilter shown in GetComponentsInChildren<MeshFilter>())
            if (shown.sharedMesh == mesh) Destroy(shown.gameObject);
        Destroy(mesh);
    }

    void Clear()
    {
        foreach (uint body in new List<uint>(meshes.Keys)) Remove(body);
    }

    void OnDestroy()
    {
        if (player == null) return;
        player.Leave(Time.realtimeSinceStartupAsDouble);
        player.Dispose();
        player = null;
        Clear();
    }
}
