// Plays with what Unity uses (client/engines/unity), without Unity: headless.exe HOST:PORT SECONDS [PASSWORD]. Prints
// twice a second where its body is, from when it first has one: on a busy machine Mono needs a second to compile and to
// join. Exit code 2: sent away; 3: its name did not come back as it was sent; 4: its goodbye had no answer.
using System;
using System.Diagnostics;
using System.Runtime.InteropServices;
using System.Threading;

static class Headless
{
    static int Main(string[] words)
    {
        try
        {
            return Play(words, double.Parse(words[1]));
        }
        catch (ArgumentException error)
        {
            Console.Error.WriteLine("headless: " + error.Message);
            return 2;
        }
    }

    static int Play(string[] words, double seconds)
    {
        double begun = double.PositiveInfinity, printed = 0; // begun: when it first had a body
        var clock = Stopwatch.StartNew();
        using (var player = new WobblePlayer(words[0], "münchen", words.Length > 2 ? words[2] : null, 0))
        {
            bool hasJoined = false;
            for (; player.Update(clock.Elapsed.TotalSeconds); Thread.Sleep(15))
            {
                double now = clock.Elapsed.TotalSeconds;
                if (now - begun > seconds)
                {
                    player.Leave(now);
                    if (player.Status.state != WobbleNative.Ended) return 4;
                    break;
                }
                player.Play((float)Math.Cos(now), (float)Math.Sin(now), 0);
                while (player.TakeEvent(out WobbleNative.Event next))
                    hasJoined |= next.kind == WobbleNative.Join && WobbleNative.FromUtf8(next.text) == "münchen";
                player.Sample(now);
                if (now < printed + 0.5) continue;
                foreach (WobbleNative.Body body in player.Bodies)
                    if (body.body == player.Status.ownBody)
                    {
                        Print(body, player.Bodies.Count);
                        begun = Math.Min(begun, now);
                        printed = now;
                    }
            }
            if (player.Status.endedUnasked != 0) Console.Error.WriteLine("headless: " + player.Reason);
            return player.Status.endedUnasked != 0 ? 2 : hasJoined ? 0 : 3;
        }
    }

    static void Print(WobbleNative.Body body, int bodies)
    {
        var positions = new float[3 * body.vertexCount];
        Marshal.Copy(body.positions, positions, 0, positions.Length);
        double x = 0, y = 0, z = 0;
        for (int i = 0; i < positions.Length; i += 3)
        {
            x += positions[i] / body.vertexCount;
            y += positions[i + 1] / body.vertexCount;
            z += positions[i + 2] / body.vertexCount;
        }
        bool agrees = Math.Abs(x - body.x) + Math.Abs(y - body.y) + Math.Abs(z - body.z) < 0.1;
        string name = WobbleNative.FromUtf8(body.blueprint);
        string doubt = agrees ? "" : "  beside its pose";
        Console.WriteLine($"x {x:F2}  y {y:F2}  z {z:F2}  bodies {bodies}  {name} {body.vertexCount}{doubt}");
    }
}
