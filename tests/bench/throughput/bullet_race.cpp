#include <cstdio>
#include "tests/bench/throughput/bullet.h"
#include "tests/bench/throughput/experiments.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {
using namespace physics;
void MeasureBulletApart(Bench&) {}
void MeasureBulletTouching(Bench&) {
  const std::size_t n=16;
  for (bool fixed : {true, false}) {
  const auto world = MakeBallsInFunnel(n, fixed ? FixSubsteps(4) : WorldSettings{}, 0);
  for (int i=0;i<180;++i){ double b=ReadThreadTime(); auto r=world->Step(); if (i%10==0) std::printf("%d %.3f ms %.2f %.2f awake %d\n", i, 1e3*(ReadThreadTime()-b), r.substeps/(double)n, r.allSubsteps/(double)n, r.awake);}
  double h=0; for (auto& b : world->Bodies()) h+=world->FindCentre(b).z()/n;
  std::printf("height %.3f\n", h);
  }
  const auto fresh=MakeBallsInFunnel(n, FixSubsteps(4),0);
  for (double m : {0.25,0.1,0.02}) for (auto c : {BulletSettings::Contacts::kVertexFace, BulletSettings::Contacts::kClusters}) {
  BulletWorld b(*fresh, {.contacts=c,.margin=m}); for (int i=0;i<140;++i){ double t=ReadThreadTime(); b.Step(); if (i%20==10) std::printf("%g %d %d %.3f ms %zu height %.3f\n", m,(int)c, i, 1e3*(ReadThreadTime()-t), b.CountContacts(), b.FindMeanHeight());}
  }
}
}
