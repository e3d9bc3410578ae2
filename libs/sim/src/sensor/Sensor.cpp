// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/core/VelodyneLasers.h>
#include <dyslam/sim/Sensor.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace dyslam::sim
{
namespace
{
constexpr double kPi = M_PI;
constexpr double kDegree = kPi / 180;

struct Name
{
  SensorKind kind;
  const char* text;
};
constexpr std::array<Name, 11> kNames{{{SensorKind::hdl64e, "HDL64E"},
                                       {SensorKind::hdl32e, "HDL32E"},
                                       {SensorKind::vlp16, "VLP16"},
                                       {SensorKind::vlp32c, "VLP32C"},
                                       {SensorKind::vls128, "VLS128"},
                                       {SensorKind::os1_32, "OS1-32"},
                                       {SensorKind::os1_64, "OS1-64"},
                                       {SensorKind::os1_128, "OS1-128"},
                                       {SensorKind::pandar64, "PANDAR64"},
                                       {SensorKind::xt32, "XT32"},
                                       {SensorKind::avia, "AVIA"}}};

// Upper block: 32 lasers at steps of 1/3 degree from +2; lower block: 32 lasers at 1/2 degree, seen
// from the origin as if they began higher: the lowest ring of real scans from 1.73 m above the road
// lies at -23.6 degrees. One firing sequence takes 48 us of the 50 us between columns.
SensorModel hdl64e()
{
  constexpr double kLowerBlock = 0.06;  // m
  SensorModel m;
  for (int i = 0; i < 32; ++i)
  {
    m.beams.push_back({(-24.33 + 0.5 * i) * kDegree, 0, 1.5e-6 * i, kLowerBlock});
  }
  for (int i = 0; i < 32; ++i)
  {
    m.beams.push_back({(-8.333 + i / 3.0) * kDegree, 0, 1.5e-6 * i, 0});
  }
  m.columns = 2083;
  m.period = 0.1;
  m.min_range = 0.9;
  m.max_range = 120;
  m.range_noise = 0.01;
  m.range_resolution = 0.002;
  m.reference_range = 62;
  m.divergence = 0.001;
  m.beam_range_bias = 0.012;
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
    m.beams.push_back({(lowest + step * ring) * kDegree, 0, fire * id, 0});
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

/** \param azimuths of the lasers that fire together, repeated for all, clockwise [deg] \param fire
 * time between firings \param cycle time of a column [s] */
template <typename Elevations, typename Azimuths>
SensorModel velodyneIrregular(const Elevations& elevations,
                              const Azimuths& azimuths,
                              std::size_t fired_together,
                              double fire,
                              double cycle)
{
  SensorModel m;
  for (std::size_t id = 0; id < elevations.size(); ++id)
  {
    m.beams.push_back({elevations[id] * kDegree, -azimuths[id % azimuths.size()] * kDegree,
                       fire * static_cast<double>(id / fired_together), 0});
  }
  std::sort(m.beams.begin(), m.beams.end(),
            [](const Beam& a, const Beam& b) { return a.elevation < b.elevation; });
  m.period = 0.1;
  m.columns = static_cast<int>(std::lround(m.period / cycle));
  return m;
}

// From -25 to 15 degrees: 1/3 degree apart between -4 and 1.67, coarser outside.
SensorModel vlp32c()
{
  SensorModel m = velodyneIrregular(velodyne::vlp32c_elevations, velodyne::vlp32c_azimuths, 2,
                                    2.304e-6, 55.296e-6);
  m.min_range = 1;
  m.max_range = 200;
  m.range_noise = 0.012;
  m.range_resolution = 0.004;
  m.reference_range = 100;
  m.divergence = 0.0015;
  m.beam_range_bias = 0.006;
  return m;
}

// From -25 to 15 degrees: 0.11 degrees apart between -6.5 and 5, coarser outside.
SensorModel vls128()
{
  SensorModel m = velodyneIrregular(velodyne::vls128_elevations, velodyne::vls128_azimuths, 8,
                                    2.665e-6, 53.3e-6);
  m.min_range = 0.4;
  m.max_range = 245;
  m.range_noise = 0.012;
  m.range_resolution = 0.004;
  m.reference_range = 220;
  m.divergence = 0.001;
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
    m.beams.push_back({elevation * kDegree, stagger * kDegree, 0, 0});
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

// From -25 to 15 degrees: steps of 1/6 degree between -6 and 2, coarser ones outside.
SensorModel pandar64()
{
  SensorModel m;
  std::vector<double> elevations{-25, -19};
  for (int e = -14; e < -6; ++e)
  {
    elevations.push_back(e);
  }
  for (int i = 0; i <= 48; ++i)
  {
    elevations.push_back(-6 + i / 6.0);
  }
  elevations.insert(elevations.end(), {3, 5, 8, 11, 15});
  for (std::size_t i = 0; i < elevations.size(); ++i)
  {
    m.beams.push_back({elevations[i] * kDegree, 0, 0.66e-6 * static_cast<double>(i), 0});
  }
  m.columns = 1800;
  m.min_range = 0.3;
  m.max_range = 200;
  m.range_noise = 0.01;
  m.range_resolution = 0.004;
  m.reference_range = 200;
  m.divergence = 0.001;
  m.beam_range_bias = 0.005;
  return m;
}

// From -16 to 15 degrees, one degree apart.
SensorModel xt32()
{
  SensorModel m;
  for (int i = 0; i < 32; ++i)
  {
    m.beams.push_back({(i - 16) * kDegree, 0, 1.512e-6 * i, 0});
  }
  m.columns = 2000;
  m.min_range = 0.05;
  m.max_range = 120;
  m.range_noise = 0.005;
  m.range_resolution = 0.004;
  m.reference_range = 80;
  m.divergence = 0.001;
  m.beam_range_bias = 0.003;
  return m;
}

// 70.4 degrees wide and 77.2 high, 240000 points per second by six lasers.
SensorModel avia()
{
  constexpr int kLasers = 6;
  constexpr double kWidth = 70.4, kHeight = 77.2;
  SensorModel m;
  for (int i = 0; i < kLasers; ++i)
  {
    const double along = static_cast<double>(i) / (kLasers - 1) - 0.5;
    m.beams.push_back({along * (kHeight - kWidth) * kDegree, 0, 1e-6 * i, 0});
  }
  m.prisms = {0.25 * kWidth * kDegree, 121.57, -77.73};
  m.columns = 4000;
  m.min_range = 1;
  m.max_range = 200;
  m.range_noise = 0.02;
  m.range_resolution = 0.001;
  m.reference_range = 190;
  m.divergence = 0.0024;
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

RayAngles SensorModel::throughPrisms(double time, const Beam& beam) const
{
  const double first = 2 * kPi * prisms.first_rate * time;
  const double second = 2 * kPi * prisms.second_rate * time;
  const double left = prisms.deflection * (std::cos(first) + std::cos(second));
  const double up = prisms.deflection * (std::sin(first) + std::sin(second)) + beam.elevation;
  // Deflections are angles from the axis.
  const double angle = std::hypot(left, up);
  const double sine = angle > 0 ? std::sin(angle) / angle : 1;
  return {std::atan2(sine * left, std::cos(angle)), std::asin(sine * up)};
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
    case SensorKind::vlp32c:
      model = vlp32c();
      break;
    case SensorKind::vls128:
      model = vls128();
      break;
    case SensorKind::os1_32:
      model = os1(32);
      break;
    case SensorKind::os1_64:
      model = os1(64);
      break;
    case SensorKind::os1_128:
      model = os1(128);
      break;
    case SensorKind::pandar64:
      model = pandar64();
      break;
    case SensorKind::xt32:
      model = xt32();
      break;
    case SensorKind::avia:
      model = avia();
      break;
  }
  model.name = toString(kind);
  return model;
}

std::vector<std::string> sensorNames()
{
  std::vector<std::string> names;
  for (const auto& n : kNames)
  {
    names.emplace_back(n.text);
  }
  return names;
}

SensorKind sensorKindFromString(const std::string& name)
{
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const auto& n : kNames)
  {
    if (upper == n.text)
    {
      return n.kind;
    }
  }
  throw UserError(unknownWord("sensor", upper, sensorNames()));
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
