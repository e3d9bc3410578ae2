// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/PacketScans.h>
#include <dyslam/packets/VelodyneModels.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
using Calibration = mrpt::obs::VelodyneCalibration;

constexpr const char* automatic_name = "auto";
constexpr std::array<std::pair<VelodyneModel, VelodyneTraits>, 6> models{{
    {VelodyneModel::vlp16, {"VLP16", 16, 0.002, 55.296e-6, 2.304e-6, 1}},
    {VelodyneModel::vlp16_hires, {"VLP16HR", 16, 0.002, 55.296e-6, 2.304e-6, 1}},
    {VelodyneModel::hdl32e, {"HDL32E", 32, 0.002, 46.08e-6, 1.152e-6, 1}},
    // Both banks at a time; spread evenly, which is within 0.05 ms of the real pattern.
    {VelodyneModel::hdl64e, {"HDL64E", 64, 0.002, 48.0e-6, 48.0e-6 / 32.0, 2}},
    {VelodyneModel::vlp32c, {"VLP32C", 32, 0.004, 55.296e-6, 2.304e-6, 2}},
    {VelodyneModel::vls128, {"VLS128", 128, 0.004, 53.3e-6, 2.665e-6, 8}},
}};

/** Vertical angles of the lasers [deg], VLP-16 User Manual (Puck Hi-Res). */
constexpr std::array<double, 16> hires_elevations{-10, 0.667, -8.667, 2, -7.333, 3.333,
                                                  -6,  4.667, -4.667, 6, -3.333, 7.333,
                                                  -2,  8.667, -0.667, 10};

/** Vertical angles of the lasers [deg], VLP-32C User Manual. */
constexpr std::array<double, 32> vlp32c_elevations{
    -25,    -1,     -1.667, -15.639, -11.31, 0,      -0.667, -8.843, -7.254, 0.333,  -0.333,
    -6.148, -5.333, 1.333,  0.667,   -4,     -4.667, 1.667,  1,      -3.667, -3.333, 3.333,
    2.333,  -2.667, -3,     7,       4.667,  -2.333, -2,     15,     10.333, -1.333};
/** Their azimuths from that of the block [deg], VLP-32C User Manual. */
constexpr std::array<double, 32> vlp32c_azimuths{
    1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
    1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4};

/** Vertical angles of the lasers [deg], VLS-128 User Manual. */
constexpr std::array<double, 128> vls128_elevations{
    -11.742, -1.99,   3.4,   -5.29,   -0.78, 4.61,  -4.08,   1.31,   -6.5,  -1.11,   4.28,  -4.41,
    0.1,     6.48,    -3.2,  2.19,    -3.86, 1.53,  -9.244,  -1.77,  2.74,  -5.95,   -0.56, 4.83,
    -2.98,   2.41,    -6.28, -0.89,   3.62,  -5.07, 0.32,    7.58,   -0.34, 5.18,    -3.64, 1.75,
    -25,     -2.43,   2.96,  -5.73,   0.54,  9.7,   -2.76,   2.63,   -7.65, -1.55,   3.84,  -4.85,
    3.18,    -5.51,   -0.12, 5.73,    -4.3,  1.09,  -16.042, -2.21,  4.06,  -4.63,   0.76,  15,
    -3.42,   1.97,    -6.85, -1.33,   -5.62, -0.23, 5.43,    -3.53,  0.98,  -19.582, -2.32, 3.07,
    -4.74,   0.65,    11.75, -2.65,   1.86,  -7.15, -1.44,   3.95,   -2.1,  3.29,    -5.4,  -0.01,
    4.5,     -4.19,   1.2,   -13.565, -1.22, 4.17,  -4.52,   0.87,   6.08,  -3.31,   2.08,  -6.65,
    1.42,    -10.346, -1.88, 3.51,    -6.06, -0.67, 4.72,    -3.97,  2.3,   -6.39,   -1,    4.39,
    -5.18,   0.21,    6.98,  -3.09,   4.98,  -3.75, 1.64,    -8.352, -2.54, 2.85,    -5.84, -0.45,
    8.43,    -2.87,   2.52,  -6.17,   -1.66, 3.73,  -4.96,   0.43};
/** Azimuths of each eight lasers from that of the block [deg], VLS-128 User Manual. */
constexpr std::array<double, 8> vls128_azimuths{6.354,  4.548,  2.732,  0.911,
                                                -0.911, -2.732, -4.548, -6.354};

/** \param azimuths of the lasers, clockwise; repeated if there are fewer [deg]. */
template <typename Elevations, typename Azimuths>
Calibration calibrationOf(const Elevations& elevations, const Azimuths& azimuths)
{
  Calibration calibration;
  calibration.laser_corrections.resize(elevations.size());
  for (std::size_t i = 0; i < elevations.size(); ++i)
  {
    auto& laser = calibration.laser_corrections[i];
    laser = {};
    laser.verticalCorrection = elevations[i];
    laser.azimuthCorrection = -azimuths[i % azimuths.size()];
  }
  return calibration;
}
}  // namespace

const VelodyneTraits& traitsOf(VelodyneModel model)
{
  const auto* found = std::find_if(models.begin(), models.end(),
                                   [model](const auto& entry) { return entry.first == model; });
  if (found == models.end())
  {
    throw std::invalid_argument("no model of a Velodyne");
  }
  return found->second;
}

std::optional<VelodyneModel> velodyneModelNamed(const std::string& name)
{
  std::string plain = name;
  plain.erase(std::remove(plain.begin(), plain.end(), '-'), plain.end());
  for (const auto& [model, traits] : models)
  {
    if (plain == traits.name)
    {
      return model;
    }
  }
  return name.empty() || name == automatic_name ? std::optional(VelodyneModel::automatic)
                                                : std::nullopt;
}

VelodyneModel givenVelodyneModel(const std::string& sensor)
{
  if (const auto model = velodyneModelNamed(sensor))
  {
    return *model;
  }
  throw UserError("--sensor " + sensor + ": is no Velodyne whose packets can be read; use " +
                  velodyneModelNames() + ", or leave it out for a Hesai or an Ouster");
}

void describeVelodyneModel(OptionsVisitor& visitor,
                           const char* key,
                           VelodyneModel& model,
                           const char* help)
{
  std::vector<std::string> words{automatic_name};
  for (const auto& entry : models)
  {
    words.emplace_back(entry.second.name);
  }
  std::string word = model == VelodyneModel::automatic ? automatic_name : traitsOf(model).name;
  visitor.word(key, word, words, help);
  model = velodyneModelNamed(word).value_or(VelodyneModel::automatic);
}

std::string velodyneModelNames()
{
  std::string names;
  for (const auto& [model, traits] : models)
  {
    names += names.empty() ? "" : model == models.back().first ? " or " : ", ";
    names += traits.name;
  }
  return names;
}

std::optional<VelodyneModel> velodyneModelOf(std::uint8_t model_byte)
{
  switch (model_byte)
  {
    case 0x21:
      return VelodyneModel::hdl32e;
    case 0x22:
      return VelodyneModel::vlp16;
    case 0x24:
      return VelodyneModel::vlp16_hires;
    case 0x28:
      return VelodyneModel::vlp32c;
    case 0xA1:
      return VelodyneModel::vls128;
    default:
      return std::nullopt;
  }
}

std::optional<VelodyneModel> velodyneModelOf(std::size_t lasers, std::uint8_t model_byte)
{
  const auto stated = velodyneModelOf(model_byte);
  if (stated && traitsOf(*stated).lasers == lasers)
  {
    return stated;
  }
  for (const auto& [model, traits] : models)
  {
    if (traits.lasers == lasers)
    {
      return model;
    }
  }
  return std::nullopt;
}

Calibration usualCalibration(VelodyneModel model)
{
  switch (model)
  {
    case VelodyneModel::vlp16:
      return Calibration::LoadDefaultCalibration("VLP16");
    case VelodyneModel::hdl32e:
      return Calibration::LoadDefaultCalibration("HDL32");
    case VelodyneModel::vlp16_hires:
      return calibrationOf(hires_elevations, std::array<double, 1>{0});
    case VelodyneModel::vlp32c:
      return calibrationOf(vlp32c_elevations, vlp32c_azimuths);
    case VelodyneModel::vls128:
      return calibrationOf(vls128_elevations, vls128_azimuths);
    default:
      // Every HDL-64E differs, and MRPT's common calibration of it cannot be loaded in 2.5.8.
      throw std::invalid_argument("no calibration that holds for all of the model");
  }
}

std::vector<std::uint16_t> ringsOf(const Calibration& calibration)
{
  std::vector<double> elevations;
  for (const auto& laser : calibration.laser_corrections)
  {
    elevations.push_back(laser.verticalCorrection);
  }
  return ringsByElevation(elevations);
}
}  // namespace dyslam
