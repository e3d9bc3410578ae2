// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/sim/Sensor.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace dyslam::sim
{
namespace
{
constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;

struct Name
{
  SensorKind kind;
  const char* text;
};
constexpr std::array<Name, 5> kNames{{{SensorKind::hdl64e, "HDL64E"},
                                      {SensorKind::hdl32e, "HDL32E"},
                                      {SensorKind::vlp16, "VLP16"},
                                      {SensorKind::os1_64, "OS1-64"},
                                      {SensorKind::os1_128, "OS1-128"}}};

// Upper block: 32 lasers at steps of 1/3 degree from +2; lower block: 32 lasers at 1/2 degree. One
// firing sequence takes 48 us of the 50 us between columns.
SensorModel hdl64e()
{
  SensorModel m;
  for (int i = 0; i < 32; ++i)
  {
    m.beams.push_back({(-24.33 + 0.5 * i) * kDegree, 0, 1.5e-6 * i});
  }
  for (int i = 0; i < 32; ++i)
  {
    m.beams.push_back({(-8.333 + i / 3.0) * kDegree, 0, 1.5e-6 * i});
  }
  m.columns = 2083;
  m.period = 0.1;
  m.min_range = 0.9;
  m.max_range = 120;
  m.range_noise = 0.007;
  m.range_resolution = 0.002;
  m.reference_range = 62;
  m.divergence = 0.001;
  m.beam_range_bias = 0.004;
  m.beam_angle_error = 0.02 * kDegree;
  return m;
}

// Lasers fire in the order of their ids, which alternates between the lower and the upper half.
SensorModel velodyneInterleaved(int lasers, double lowest, double step, double fire, double cycle)
{
  SensorModel m;
  for (int ring = 0; ring < lasers; ++ring)
  {
    const int id = ring < lasers / 2 ? 2 * ring : 2 * (ring - lasers / 2) + 1;
    m.beams.push_back({(lowest + step * ring) * kDegree, 0, fire * id});
  }
  m.period = 0.1;
  m.columns = static_cast<int>(std::lround(m.period / cycle));
  return m;
}

SensorModel vlp16()
{
  SensorModel m = velodyneInterleaved(16, -15, 2, 2.304e-6, 55.296e-6);
  m.min_range = 0.4;
  m.max_range = 100;
  m.range_noise = 0.012;
  m.range_resolution = 0.002;
  m.reference_range = 60;
  m.divergence = 0.0015;
  m.beam_range_bias = 0.006;
  return m;
}

SensorModel hdl32e()
{
  SensorModel m = velodyneInterleaved(32, -30.67, 4.0 / 3, 1.152e-6, 46.08e-6);
  m.min_range = 0.9;
  m.max_range = 100;
  m.range_noise = 0.012;
  m.range_resolution = 0.002;
  m.reference_range = 60;
  m.divergence = 0.0014;
  m.beam_range_bias = 0.006;
  return m;
}

// 45 degrees vertical field of view; azimuth offsets in a cycle of four beams.
SensorModel os1(int lasers)
{
  constexpr std::array<double, 4> kStagger{{3.164, 1.055, -1.055, -3.164}};
  SensorModel m;
  for (int ring = 0; ring < lasers; ++ring)
  {
    const double elevation = -22.5 + 45.0 * ring / (lasers - 1);
    const double stagger = kStagger[static_cast<std::size_t>((lasers - 1 - ring) % 4)];
    m.beams.push_back({elevation * kDegree, stagger * kDegree, 0});
  }
  m.columns = 1024;
  m.min_range = 0.3;
  m.max_range = 120;
  m.range_noise = 0.018;
  m.range_resolution = 0.001;
  m.reference_range = 55;
  m.divergence = 0.0016;
  m.beam_range_bias = 0.004;
  return m;
}
}  // namespace

double SensorModel::azimuth(double column) const
{
  return kPi - 2 * kPi * column / columns;
}

double SensorModel::columnTime(double column) const
{
  return period * (column / columns - 0.5);
}

SensorModel sensorModel(SensorKind kind)
{
  SensorModel model;
  switch (kind)
  {
    case SensorKind::hdl64e:
      model = hdl64e();
      break;
    case SensorKind::hdl32e:
      model = hdl32e();
      break;
    case SensorKind::vlp16:
      model = vlp16();
      break;
    case SensorKind::os1_64:
      model = os1(64);
      break;
    case SensorKind::os1_128:
      model = os1(128);
      break;
  }
  model.name = toString(kind);
  return model;
}

SensorKind sensorKindFromString(const std::string& name)
{
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::vector<std::string> words;
  for (const auto& n : kNames)
  {
    if (upper == n.text)
    {
      return n.kind;
    }
    words.emplace_back(n.text);
  }
  const std::string near = nearestWord(upper, words);
  throw UserError("sensor: '" + name + "' is none of HDL64E, HDL32E, VLP16, OS1-64, OS1-128" +
                  (near.empty() ? "" : "; did you mean " + near + "?"));
}

std::string toString(SensorKind kind)
{
  for (const auto& n : kNames)
  {
    if (n.kind == kind)
    {
      return n.text;
    }
  }
  return "?";
}
}  // namespace dyslam::sim
