// Plays for five seconds: connects, rolls the own ball in a circle and prints where it is.
//
//   example [HOST [PORT]]
//
// All that a game needs of wobble is in these two headers. Show client.Sample() instead of printing and it is one.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "client/client.h"
#include "protocol/transport/enet_transport.h"

using namespace wobble;

// The library never looks at a clock: seconds since any fixed moment will do, as long as they only go forward.
static double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int main(int argc, char** argv) {
  const char* host = argc > 1 ? argv[1] : "127.0.0.1";
  const auto port = static_cast<std::uint16_t>(argc > 2 ? std::atoi(argv[2]) : 7777);

  std::string error;
  auto transport = transport::EnetTransport::Connect(host, port, error);
  if (transport == nullptr) {  // no such host; that nobody answers shows later, as the end of the client
    std::fprintf(stderr, "example: %s\n", error.c_str());
    return 1;
  }

  client::Client client(std::move(transport), {.name = "example"}, Now());

  std::vector<client::BodySample> bodies;
  double leaveAt = 0, printAt = 0;
  while (client.ReadState() != client::State::kEnded) {
    const double now = Now();
    client.Update(now);  // receives, answers and sends; call it once a frame
    if (client.ReadState() == client::State::kPlaying) {
      if (leaveAt == 0) leaveAt = now + 5;
      if (now >= leaveAt) client.Leave(now);  // says goodbye; the loop goes on until that has been heard

      // What the player asks for until told otherwise: right and forward, -1 to 1 each.
      const auto angle = static_cast<float>(2 * (leaveAt - now));
      client.SetInput({.moveX = std::cos(angle), .moveY = std::sin(angle)});

      // Every body as it is to be drawn now. kVertices instead fills body.vertices, with the faces in body.blueprint.
      client.Sample(now, client::Detail::kPosesOnly, bodies);
      for (const client::BodySample& body : bodies) {
        if (body.body != client.Welcome().ownBody || now < printAt) continue;
        const protocol::Vector3 place = body.pose.centroid;  // metres, z is up
        std::printf("x %6.2f  y %6.2f  z %6.2f\n", double{place.x}, double{place.y}, double{place.z});
        printAt = now + 0.5;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(16));
  }
  if (!client.EndedUnasked()) return 0;
  std::fprintf(stderr, "example: %s:%d: %s\n", host, port, client.EndReason().c_str());
  return 1;
}
