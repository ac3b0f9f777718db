#include "WobbleWorld.h"

#include "GameFramework/PlayerController.h"
#include "HAL/PlatformProcess.h"
#include "InputCoreTypes.h"

AWobbleWorld::AWobbleWorld() {
  PrimaryActorTick.bCanEverTick = true;
  Mesh = CreateDefaultSubobject<UProceduralMeshComponent>(TEXT("Mesh"));
  RootComponent = Mesh;
  Positions.SetNumZeroed(3 * MostVertices);
  Normals.SetNumZeroed(3 * MostVertices);
  Indices.SetNumZeroed(MostIndices);
}

// 1. Connect.
void AWobbleWorld::BeginPlay() {
  Super::BeginPlay();
  const FTCHARToUTF8 AddressText(*Address);
  wobble_connect_options Options{};
  Options.struct_size = sizeof Options;
  Options.address = AddressText.Get();
  Options.name = "unreal";
  const wobble_result Result = wobble_connect(&Options, Now, &Client);
  if (Result != WOBBLE_OK) UE_LOG(LogTemp, Error, TEXT("wobble: %s"), UTF8_TO_TCHAR(wobble_describe(Result)));
}

// 2. Update. The clock is the sum of the frames.
void AWobbleWorld::Tick(float DeltaSeconds) {
  Super::Tick(DeltaSeconds);
  if (Client == nullptr) return;
  Now += DeltaSeconds;
  wobble_update(Client, Now);
  wobble_status Status{};
  Status.struct_size = sizeof Status;
  wobble_read_status(Client, &Status);
  if (Status.state == WOBBLE_ENDED) {
    UE_LOG(LogTemp, Warning, TEXT("wobble: %s"), UTF8_TO_TCHAR(Status.reason));
    wobble_destroy(Client);
    Client = nullptr;
    return;
  }
  Play();
  TakeEvents();
  Draw();
}

// 3. Play.
void AWobbleWorld::Play() {
  const APlayerController* Player = GetWorld()->GetFirstPlayerController();
  if (Player == nullptr) return;
  const auto Hold = [Player](const FKey& Key) { return Player->IsInputKeyDown(Key) ? 1.0f : 0.0f; };
  wobble_input Input{};
  Input.struct_size = sizeof Input;
  Input.move_x = Hold(EKeys::D) - Hold(EKeys::A);
  Input.move_y = Hold(EKeys::W) - Hold(EKeys::S);
  Input.buttons = Player->IsInputKeyDown(EKeys::SpaceBar) ? WOBBLE_JUMP : 0;
  wobble_set_input(Client, &Input);
}

// 4. Sample and draw: all bodies are one section of one mesh.
void AWobbleWorld::Draw() {
  wobble_frame Frame{};
  Frame.struct_size = sizeof Frame;
  Frame.vertex_capacity = MostVertices;
  Frame.index_capacity = MostIndices;
  Frame.positions = Positions.GetData();
  Frame.normals = Normals.GetData();
  Frame.indices = Indices.GetData();
  if (wobble_sample(Client, Now, &Frame) != WOBBLE_OK) return;

  TArray<FVector> Vertices, Directions;
  for (int32 V = 0; V < static_cast<int32>(Frame.vertex_count);
       ++V) {  // metres to centimetres, right-handed to left-handed
    const float *P = &Positions[3 * V], *N = &Normals[3 * V];
    Vertices.Add(FVector(100 * P[0], -100 * P[1], 100 * P[2]));
    Directions.Add(FVector(N[0], -N[1], N[2]));
  }
  if (bHasSection && Frame.layout == Layout) {
    Mesh->UpdateMeshSection_LinearColor(0, Vertices, Directions, {}, {}, {});
    return;
  }
  TArray<int32> Triangles;
  for (int32 I = 0; I < static_cast<int32>(Frame.index_count); ++I) Triangles.Add(static_cast<int32>(Indices[I]));
  Mesh->CreateMeshSection_LinearColor(0, Vertices, Triangles, Directions, {}, {}, {}, false);
  Mesh->SetMaterial(0, Material);
  Layout = Frame.layout;
  bHasSection = true;
}

// 5. Events, and leave.
void AWobbleWorld::TakeEvents() {
  wobble_event Event{};
  Event.struct_size = sizeof Event;
  while (wobble_next_event(Client, &Event) == WOBBLE_OK) {
    if (Event.kind == WOBBLE_NOTICE) UE_LOG(LogTemp, Log, TEXT("%s"), UTF8_TO_TCHAR(Event.text));
  }
}

void AWobbleWorld::EndPlay(const EEndPlayReason::Type Reason) {
  if (Client != nullptr) {
    wobble_leave(Client, Now);
    wobble_status Status{};
    Status.struct_size = sizeof Status;
    for (int I = 0; I < 50 && Status.state != WOBBLE_ENDED; ++I) {  // the answer takes a round trip
      wobble_update(Client, Now += 0.01);
      wobble_read_status(Client, &Status);
      FPlatformProcess::Sleep(0.01f);
    }
    wobble_destroy(Client);
    Client = nullptr;
  }
  Super::EndPlay(Reason);
}
