// Plays for five seconds: connects, rolls its own ball in a circle and prints where the ball is.
//
//   example [HOST [PORT]]
//
// A game needs no more of wobble than these two headers. Client::Sample fills in every body as it is to be drawn. When
// the server is restarted, the player joins again.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>

#include "client/lasting_client.h"
#include "protocol/transport/enet_transport.h"

using namespace wobble;

// The library reads no clock. It takes seconds since any fixed moment, which never go back.
static double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int main(int argc, char** argv) {
  const char* host = argc > 1 ? argv[1] : "127.0.0.1";
  const auto port = static_cast<std::uint16_t>(argc > 2 ? std::atoi(argv[2]) : 7777);

  client::LastingOptions options;
  options.client.name = "example";
  options.rejoin.seed = std::random_device{}();
  options.connect = [&](std::string& error) { return transport::EnetTransport::Connect(host, port, error); };

  std::string error;
  auto transport = options.connect(error);
  if (transport == nullptr) {  // no such host; a server that does not answer ends the player later
    std::fprintf(stderr, "example: %s\n", error.c_str());
    return 1;
  }

  client::LastingClient player(std::move(transport), options, Now());
  for (int frame = 0; player.ReadState() != client::LastingState::kEnded;) {
    player.Update(Now());  // receives, answers and sends
    if (player.ReadState() == client::LastingState::kPlaying) {
      client::Client& client = player.Current();
      const float angle = 0.03F * static_cast<float>(++frame);
      client.SetInput({.moveX = std::cos(angle), .moveY = std::sin(angle)});  // along the world's x and y, each -1 to 1

      const auto pose = client.NewestPose(client.Welcome().ownBody);  // nullopt before the first snapshot
      if (pose && frame % 30 == 0) {
        const auto [x, y, z] = pose->centroid;  // metres, z is up
        std::printf("x %6.2f  y %6.2f  z %6.2f\n", double{x}, double{y}, double{z});
      }
      if (frame == 300) player.Leave(Now());  // the loop goes on until the server has answered the goodbye
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(16));
  }
  if (!player.EndedUnasked()) return 0;
  std::fprintf(stderr, "example: %s:%d: %s\n", host, port, player.Reason().c_str());
  return 1;
}
