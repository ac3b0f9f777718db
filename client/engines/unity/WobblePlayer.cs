// A player in one world, by the five steps of client/wobble.h. It needs no engine: `now` is any clock's seconds.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Threading;

public sealed class WobblePlayer : IDisposable
{
    public WobbleNative.Status Status;
    public readonly List<WobbleNative.Body> Bodies = new List<WobbleNative.Body>(); // valid until the next Sample
    IntPtr client;

    // 1. Connect. address: "HOST:PORT". password: null for none.
    public WobblePlayer(string address, string name, string password, double now)
    {
        var options = new WobbleNative.ConnectOptions();
        options.structSize = WobbleNative.SizeOf<WobbleNative.ConnectOptions>();
        options.address = WobbleNative.ToUtf8(address);
        options.name = WobbleNative.ToUtf8(name);
        options.password = WobbleNative.ToUtf8(password);
        int result = WobbleNative.wobble_connect(ref options, now, out client);
        foreach (IntPtr text in new[] { options.address, options.name, options.password }) Marshal.FreeHGlobal(text);
        if (result != WobbleNative.Ok) throw new ArgumentException(WobbleNative.Describe(result));
        Status.structSize = WobbleNative.SizeOf<WobbleNative.Status>();
    }

    // 2. Update, once a frame; false when it has ended.
    public bool Update(double now)
    {
        WobbleNative.wobble_update(client, now);
        WobbleNative.wobble_read_status(client, ref Status);
        return Status.state != WobbleNative.Ended;
    }

    // 3. Play. moveX, moveY: along the world's x and y, -1 to 1.
    public void Play(float moveX, float moveY, uint buttons)
    {
        var input = new WobbleNative.PlayerInput { structSize = WobbleNative.SizeOf<WobbleNative.PlayerInput>() };
        input.moveX = moveX;
        input.moveY = moveY;
        input.buttons = buttons;
        WobbleNative.wobble_set_input(client, ref input);
    }

    // 4. Sample: `Bodies` are as they are to be drawn now.
    public void Sample(double now)
    {
        Bodies.Clear();
        if (WobbleNative.wobble_sample(client, now, IntPtr.Zero) != WobbleNative.Ok) return;
        var body = new WobbleNative.Body { structSize = WobbleNative.SizeOf<WobbleNative.Body>() };
        for (uint i = 0; WobbleNative.wobble_read_body(client, i, ref body) == WobbleNative.Ok; ++i) Bodies.Add(body);
    }

    // 5. Events, oldest first, after each Update; false when there is none. next.text is valid until the next one.
    public bool TakeEvent(out WobbleNative.Event next)
    {
        next = new WobbleNative.Event { structSize = WobbleNative.SizeOf<WobbleNative.Event>() };
        return WobbleNative.wobble_next_event(client, ref next) == WobbleNative.Ok;
    }

    // Says goodbye and waits for the answer: a round trip, half a second at most.
    public void Leave(double now)
    {
        WobbleNative.wobble_leave(client, now);
        for (int i = 0; i < 50 && Update(now + 0.01 * i); ++i) Thread.Sleep(10);
    }

    public string Reason => WobbleNative.FromUtf8(Status.reason);

    public void Dispose()
    {
        WobbleNative.wobble_destroy(client);
        client = IntPtr.Zero;
    }
}
