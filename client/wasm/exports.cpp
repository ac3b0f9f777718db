// The functions that the page's script calls: C functions of addresses and numbers only. The code that embind generates
// for the same functions is larger than the decoder. layout.h describes the structs behind the addresses.
//
// The script writes texts, messages and structs at the address that PrepareInput returns, then calls the function that
// uses them.
#include <emscripten/emscripten.h>

#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/wasm/session.h"

using wobble::client::Hand;
using wobble::protocol::Vector3;
using wobble::wasm::KeptBytes;
using wobble::wasm::Session;

extern "C" {

// Kept blueprints are gathered first: AddKept returns the address of one more of so many bytes, which the script then
// writes. CreateSession takes them over.
EMSCRIPTEN_KEEPALIVE KeptBytes* CreateKept() { return new KeptBytes; }
EMSCRIPTEN_KEEPALIVE std::uint8_t* AddKept(KeptBytes* kept, std::size_t size) {
  return kept->emplace_back(size).data();
}
EMSCRIPTEN_KEEPALIVE Session* CreateSession(const char* name, std::size_t size, bool isSpectator, KeptBytes* kept,
                                            double now) {
  const std::unique_ptr<KeptBytes> owned(kept);
  return new Session(std::string(name, size), isSpectator, std::move(*owned), now);
}
EMSCRIPTEN_KEEPALIVE void DestroySession(Session* session) { delete session; }
EMSCRIPTEN_KEEPALIVE std::uint8_t* PrepareInput(Session* session, std::size_t size) {
  return session->PrepareInput(size);
}

EMSCRIPTEN_KEEPALIVE int ReadProtocolVersion() { return wobble::protocol::kProtocolVersion; }

// The socket; see web_socket_transport.h.
EMSCRIPTEN_KEEPALIVE void OpenSocket(Session* session) { session->Transport().Open(); }
EMSCRIPTEN_KEEPALIVE void CloseSocket(Session* session) { session->Transport().Close(); }
EMSCRIPTEN_KEEPALIVE void ReceiveMessage(Session* session, std::size_t size) {
  session->Transport().Receive(session->Input(size));
}
EMSCRIPTEN_KEEPALIVE const std::uint8_t* FindOutgoing(Session* session) {
  return session->Transport().FindOutgoing().data();
}
EMSCRIPTEN_KEEPALIVE std::size_t FindOutgoingSize(Session* session) {
  return session->Transport().FindOutgoing().size();
}
EMSCRIPTEN_KEEPALIVE void TakeOutgoing(Session* session) { session->Transport().TakeOutgoing(); }
EMSCRIPTEN_KEEPALIVE bool IsCloseAsked(Session* session) { return session->Transport().IsCloseAsked(); }
EMSCRIPTEN_KEEPALIVE void SetRoundTrip(Session* session, double seconds) { session->Transport().SetRoundTrip(seconds); }

// The client; see client.h.
EMSCRIPTEN_KEEPALIVE void Update(Session* session, double now) { session->Client().Update(now); }
EMSCRIPTEN_KEEPALIVE void Leave(Session* session, double now) { session->Client().Leave(now); }
EMSCRIPTEN_KEEPALIVE int ReadState(Session* session) { return static_cast<int>(session->Client().ReadState()); }
EMSCRIPTEN_KEEPALIVE const char* ReadEndReason(Session* session) { return session->Client().EndReason().c_str(); }
EMSCRIPTEN_KEEPALIVE bool IsCompleting(Session* session) { return session->Client().IsCompleting(); }
EMSCRIPTEN_KEEPALIVE bool MayRejoin(Session* session) { return session->Client().MayRejoin(); }
EMSCRIPTEN_KEEPALIVE const void* ReadWelcome(Session* session) { return &session->MakeWelcome(); }
EMSCRIPTEN_KEEPALIVE unsigned CountNextScenes(Session* session) { return session->CountNextScenes(); }
EMSCRIPTEN_KEEPALIVE const void* ReadStatistics(Session* session, double now) { return &session->MakeStatistics(now); }
EMSCRIPTEN_KEEPALIVE const void* TakeEvent(Session* session) { return session->TakeEvent(); }

EMSCRIPTEN_KEEPALIVE void Sample(Session* session, double now) { session->Sample(now); }
EMSCRIPTEN_KEEPALIVE const void* ReadBodies(Session* session) { return session->Bodies().Views().data(); }
EMSCRIPTEN_KEEPALIVE std::size_t ReadBodyCount(Session* session) { return session->Bodies().Views().size(); }
EMSCRIPTEN_KEEPALIVE const void* FindBlueprint(Session* session, std::uint32_t number) {
  return session->Bodies().FindBlueprint(number);
}

// buttons: bit 0 jump, 1 puff, 2 stiffen.
EMSCRIPTEN_KEEPALIVE void SetInput(Session* session, float moveX, float moveY, unsigned buttons) {
  session->Client().SetInput({.moveX = moveX,
                              .moveY = moveY,
                              .jump = (buttons & 1) != 0,
                              .puff = (buttons & 2) != 0,
                              .stiffen = (buttons & 4) != 0});
}
EMSCRIPTEN_KEEPALIVE void SetPredicts(Session* session, bool predicts) { session->Client().SetPredicts(predicts); }

// Reports of the server.
EMSCRIPTEN_KEEPALIVE const void* TakeNotice(Session* session) { return session->TakeNotice(); }
EMSCRIPTEN_KEEPALIVE const void* TakeDownload(Session* session) { return session->TakeDownload(); }
EMSCRIPTEN_KEEPALIVE const void* ReadTuning(Session* session) { return &session->MakeTuning(); }
EMSCRIPTEN_KEEPALIVE const void* ReadScoreboard(Session* session) { return &session->MakeScoreboard(); }
EMSCRIPTEN_KEEPALIVE const void* ReadForces(Session* session) { return &session->MakeForces(); }

// Hands and commands.
EMSCRIPTEN_KEEPALIVE void SetHand(Session* session, std::uint32_t body, unsigned vertex, float x, float y, float z) {
  session->Client().SetHand(Hand{body, static_cast<std::uint16_t>(vertex), {x, y, z}});
}
EMSCRIPTEN_KEEPALIVE void OpenHand(Session* session) { session->Client().SetHand(std::nullopt); }
EMSCRIPTEN_KEEPALIVE void Push(Session* session, std::uint32_t body, unsigned vertex, float x, float y, float z) {
  session->Client().Push(body, static_cast<std::uint16_t>(vertex), {x, y, z});
}
// The input holds nine floats: the eye, the beginning and the end of the stroke.
EMSCRIPTEN_KEEPALIVE void Cut(Session* session, std::uint32_t body) {
  std::array<Vector3, 3> corners;
  const auto input = session->Input(sizeof corners);
  if (input.size() == sizeof corners) std::memcpy(corners.data(), input.data(), sizeof corners);
  session->Client().Cut(body, corners[0], corners[1], corners[2]);
}
// Lines and names are at the address of PrepareInput.
EMSCRIPTEN_KEEPALIVE void Order(Session* session, std::size_t size) { session->Client().Order(session->Line(size)); }
EMSCRIPTEN_KEEPALIVE void Say(Session* session, std::size_t size) { session->Client().Say(session->Line(size)); }
EMSCRIPTEN_KEEPALIVE void Rename(Session* session, std::size_t size) { session->Client().Rename(session->Line(size)); }
EMSCRIPTEN_KEEPALIVE void Emote(Session* session, unsigned kind) {
  session->Client().Emote(static_cast<wobble::protocol::wire::EmoteKind>(kind));
}
EMSCRIPTEN_KEEPALIVE void Inspect(Session* session, std::uint32_t body) { session->Client().Inspect(body); }
EMSCRIPTEN_KEEPALIVE void Tune(Session* session, unsigned kind, float x, float y, float z) {
  session->Client().Tune(static_cast<wobble::protocol::wire::TuneKind>(kind), {x, y, z});
}
// The input holds a BuildRequest.
EMSCRIPTEN_KEEPALIVE void Build(Session* session) {
  wobble::wasm::BuildRequest request;
  const auto input = session->Input(sizeof request);
  if (input.size() == sizeof request) std::memcpy(&request, input.data(), sizeof request);
  session->Build(request);
}

// For tests: the hash over everything decoded so far, 64 bits in two halves.
EMSCRIPTEN_KEEPALIVE void RestartDecodedHash(Session* session) { session->RestartDecodedHash(); }
EMSCRIPTEN_KEEPALIVE std::uint32_t ReadDecodedHash(Session* session, bool upper) {
  return static_cast<std::uint32_t>(session->DecodedHash() >> (upper ? 32 : 0));
}

}  // extern "C"
