// client/wobble.h for C#: the functions of libwobble that a game needs first, and their structs, as 64-bit platforms
// have them. wobble.h says what each means.
using System;
using System.Runtime.InteropServices;
using System.Text;

public static class WobbleNative
{
    public const int Ok = 0, NoEvent = 1, TooSmall = 2;
    public const int Joining = 0, Playing = 1, Rejoining = 2, Ended = 3; // states
    public const uint Jump = 1, Puff = 2, Stiffen = 4;                   // buttons
    public const int Join = 0, Leave = 1, Respawn = 2, BodyRemoved = 3, Fall = 4, Notice = 5, NewWorld = 6;
    public const int Said = 7, Emoted = 8, Renamed = 9, Goal = 10, Crown = 11;

    [StructLayout(LayoutKind.Sequential)]
    public struct ConnectOptions
    {
        public uint structSize, flags;
        public IntPtr address, name, password, token, invite, serverKey; // UTF-8, see ToUtf8
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Status
    {
        public uint structSize;
        public int state, endedUnasked;
        public uint clientId, ownBody, hands;
        public float reach, pace;
        public IntPtr scene, reason, serverKey; // UTF-8, see FromUtf8
        public int rank;
        public uint talk;
        public IntPtr description;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct PlayerInput
    {
        public uint structSize, buttons;
        public float moveX, moveY;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Body
    {
        public uint structSize, body, firstVertex, firstIndex, vertexCount, faceCount, edgeCount;
        public int changed, held, open;
        public float age, x, y, z, rotationW, rotationX, rotationY, rotationZ;
        public IntPtr blueprint, positions, normals, faces, edges;
        public float leadX, leadY, leadZ;
        public uint reserved;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Event
    {
        public uint structSize;
        public int kind;
        public uint clientId, body;
        public IntPtr text;
        public int emote, reserved;
    }

    const string Library = "wobble"; // libwobble.so

    [DllImport(Library)] static extern IntPtr wobble_describe(int result);
    [DllImport(Library)]
    public static extern int wobble_connect(ref ConnectOptions options, double now, out IntPtr client);
    [DllImport(Library)] public static extern void wobble_destroy(IntPtr client);
    [DllImport(Library)] public static extern int wobble_update(IntPtr client, double now);
    [DllImport(Library)] public static extern int wobble_leave(IntPtr client, double now);
    [DllImport(Library)] public static extern int wobble_read_status(IntPtr client, ref Status status);
    [DllImport(Library)] public static extern int wobble_set_input(IntPtr client, ref PlayerInput input);
    [DllImport(Library)] public static extern int wobble_sample(IntPtr client, double now, IntPtr frame);
    [DllImport(Library)] public static extern int wobble_read_body(IntPtr client, uint index, ref Body body);
    [DllImport(Library)] public static extern int wobble_next_event(IntPtr client, ref Event next);

    public static uint SizeOf<T>() => (uint)Marshal.SizeOf(typeof(T));
    public static string Describe(int result) => FromUtf8(wobble_describe(result));

    // For the options; free it by Marshal.FreeHGlobal after the call. null stays the default.
    public static IntPtr ToUtf8(string text)
    {
        if (text == null) return IntPtr.Zero;
        byte[] bytes = Encoding.UTF8.GetBytes(text + "\0");
        IntPtr copy = Marshal.AllocHGlobal(bytes.Length);
        Marshal.Copy(bytes, 0, copy, bytes.Length);
        return copy;
    }

    public static string FromUtf8(IntPtr text)
    {
        if (text == IntPtr.Zero) return "";
        int length = 0;
        while (Marshal.ReadByte(text, length) != 0) ++length;
        byte[] bytes = new byte[length];
        Marshal.Copy(text, bytes, 0, length);
        return Encoding.UTF8.GetString(bytes);
    }
}
