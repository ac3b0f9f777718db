// What client/engines/unreal names of Unreal Engine, which Debian does not have: as much as its syntax and its calls of
// the C interface need to be compiled. That it fits the real engine, this does not show.
#pragma once

#include <cstdint>
#include <initializer_list>

#define UCLASS(...)
#define UPROPERTY(...)
#define GENERATED_BODY() using Super = AActor;
#define TEXT(text) u##text
#define UTF8_TO_TCHAR(text) ConvertToTchar(text)
#define UE_LOG(category, verbosity, format, ...) Log(format __VA_OPT__(, ) __VA_ARGS__)

using int32 = int32_t;
using uint32 = uint32_t;
using TCHAR = char16_t;
const TCHAR* ConvertToTchar(const char* text);
template <typename... Values>
void Log(const TCHAR* format, const Values&... values);

struct FPlatformProcess {
  static void Sleep(float seconds);
};
struct FString {
  FString(const TCHAR* text);
  const TCHAR* operator*() const;
};
struct FTCHARToUTF8 {
  explicit FTCHARToUTF8(const TCHAR* text);
  const char* Get() const;
};
template <typename Value>
struct TArray {
  TArray() = default;
  TArray(std::initializer_list<Value> values);
  void SetNumZeroed(int32 count);
  void Add(const Value& value);
  Value* GetData();
  Value& operator[](int32 index);
};
struct FVector {
  FVector(double x, double y, double z);
};
struct FVector2D {};
struct FLinearColor {};
struct FProcMeshTangent {};
struct FKey {};
namespace EKeys {
extern const FKey A, D, S, W, SpaceBar;
}
namespace EEndPlayReason {
enum Type { Destroyed };
}
struct UMaterialInterface {};
struct APlayerController {
  bool IsInputKeyDown(FKey key) const;
};
struct UWorld {
  APlayerController* GetFirstPlayerController() const;
};
struct UProceduralMeshComponent {
  void CreateMeshSection_LinearColor(int32 section, const TArray<FVector>& vertices, const TArray<int32>& triangles,
                                     const TArray<FVector>& normals, const TArray<FVector2D>& uv,
                                     const TArray<FLinearColor>& colours, const TArray<FProcMeshTangent>& tangents,
                                     bool createCollision);
  void UpdateMeshSection_LinearColor(int32 section, const TArray<FVector>& vertices, const TArray<FVector>& normals,
                                     const TArray<FVector2D>& uv, const TArray<FLinearColor>& colours,
                                     const TArray<FProcMeshTangent>& tangents);
  void SetMaterial(int32 section, UMaterialInterface* material);
};
struct AActor {
  struct {
    bool bCanEverTick;
  } PrimaryActorTick;
  UProceduralMeshComponent* RootComponent = nullptr;
  virtual ~AActor() = default;
  virtual void BeginPlay();
  virtual void Tick(float deltaSeconds);
  virtual void EndPlay(const EEndPlayReason::Type reason);
  UWorld* GetWorld() const;
  template <typename Component>
  Component* CreateDefaultSubobject(const TCHAR* name);
};
