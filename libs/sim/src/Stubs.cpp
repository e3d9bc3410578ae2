#include "Traffic.h"
namespace dyslam::sim
{
struct Nop : Crowd::Group
{
  void step(double) override {}
};
std::unique_ptr<Crowd::Group> makeHighwayTraffic(Crowd&)
{
  return std::make_unique<Nop>();
}
std::unique_ptr<Crowd::Group> makeWalkers(Crowd&)
{
  return std::make_unique<Nop>();
}
std::unique_ptr<Crowd::Group> makeBicycles(Crowd&)
{
  return std::make_unique<Nop>();
}
std::unique_ptr<Crowd::Group> makePathEgo(Crowd&)
{
  return std::make_unique<Nop>();
}
void buildCampus(World&, const SimulatorOptions&) {}
void buildHighway(World&, const SimulatorOptions&) {}
void buildField(World&, const SimulatorOptions&) {}
}  // namespace dyslam::sim
