// An actor of Unreal Engine 5 that shows a world and plays in it, by the C interface.
#pragma once

#include "CoreMinimal.h"
#include "GameFramework/Actor.h"
#include "ProceduralMeshComponent.h"
#include "wobble.h"

#include "WobbleWorld.generated.h"

UCLASS()
class AWobbleWorld : public AActor {
  GENERATED_BODY()

 public:
  AWobbleWorld();
  virtual void BeginPlay() override;
  virtual void Tick(float DeltaSeconds) override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;

  UPROPERTY(EditAnywhere)
  FString Address = TEXT("127.0.0.1:7777");

  // Both sides of it are to be shown.
  UPROPERTY(EditAnywhere)
  UMaterialInterface* Material = nullptr;

 private:
  static constexpr int32 MostVertices = 1 << 16, MostIndices = 6 * MostVertices;  // a larger world is not drawn

  void Play();
  void TakeEvents();
  void Draw();

  UPROPERTY()
  UProceduralMeshComponent* Mesh = nullptr;

  wobble_client* Client = nullptr;
  double Now = 0;
  uint32 Layout = 0;
  bool bHasSection = false;
  TArray<float> Positions, Normals;
  TArray<uint32> Indices;
};
