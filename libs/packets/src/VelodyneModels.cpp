// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/VelodyneLasers.h>
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
      return calibrationOf(velodyne::hires_elevations, std::array<double, 1>{0});
    case VelodyneModel::vlp32c:
      return calibrationOf(velodyne::vlp32c_elevations, velodyne::vlp32c_azimuths);
    case VelodyneModel::vls128:
      return calibrationOf(velodyne::vls128_elevations, velodyne::vls128_azimuths);
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
