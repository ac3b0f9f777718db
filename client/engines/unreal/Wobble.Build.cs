// Of the module that has WobbleWorld.cpp; wobble.h and libwobble.so.0 lie in its folder ThirdParty.
using System.IO;
using UnrealBuildTool;

public class Wobble : ModuleRules
{
    public Wobble(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        PublicDependencyModuleNames.AddRange(
            new[] { "Core", "CoreUObject", "Engine", "InputCore", "ProceduralMeshComponent" });
        string library = Path.Combine(ModuleDirectory, "ThirdParty", "libwobble.so.0");
        PublicIncludePaths.Add(Path.Combine(ModuleDirectory, "ThirdParty"));
        PublicAdditionalLibraries.Add(library);
        RuntimeDependencies.Add(library);
    }
}
