// SPDX-License-Identifier: BSD-3-Clause
#include "SavedFactor.h"

#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/backend/factors/ObservationFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>
#include <dyslam/base/Error.h>

#include <stdexcept>
#include <string>

namespace dyslam
{
SavedFactor savedFrom(const Factor* factor)
{
  SavedFactor saved;
  if (factor != nullptr)
  {
    saved.kind = factor->kind();
    saved.keys = factor->keys();
    saved.measurement = factor->measurement();
    saved.information = factor->information();
    if (saved.kind == FactorKind::object_motion)
    {
      saved.dt = static_cast<const ObjectMotionFactor&>(*factor).dt();
    }
    if (saved.kind == FactorKind::gnss)
    {
      saved.antenna = static_cast<const GnssFactor&>(*factor).antenna();
    }
    if (saved.kind == FactorKind::gravity)
    {
      saved.upwards = static_cast<const GravityFactor&>(*factor).upwards();
    }
  }
  return saved;
}

std::unique_ptr<const Factor> made(const SavedFactor& saved)
{
  if (saved.keys.empty())
  {
    return nullptr;
  }
  const auto index = [&](std::size_t i)
  { return static_cast<std::size_t>(saved.keys.at(i).index); };
  const auto object = [&] { return static_cast<int>(saved.keys.at(0).object); };
  try
  {
    switch (saved.kind)
    {
      case FactorKind::odometry:
        return std::make_unique<OdometryFactor>(index(0), index(1), saved.measurement,
                                                saved.information);
      case FactorKind::loop:
        return std::make_unique<LoopFactor>(index(0), index(1), saved.measurement,
                                            saved.information);
      case FactorKind::observation:
        return std::make_unique<ObservationFactor>(index(0), saved.keys.at(1), saved.measurement,
                                                   saved.information);
      case FactorKind::object_motion:
        return std::make_unique<ObjectMotionFactor>(object(), index(0), index(1), saved.dt,
                                                    saved.information);
      case FactorKind::smooth_motion:
        return std::make_unique<SmoothMotionFactor>(object(), index(0), index(1),
                                                    saved.information);
      case FactorKind::gnss:
        return std::make_unique<GnssFactor>(index(0), saved.measurement.translation(),
                                            saved.antenna, saved.information);
      case FactorKind::gravity:
        return std::make_unique<GravityFactor>(index(0), saved.upwards, saved.information);
      case FactorKind::localisation:
        return std::make_unique<LocalisationFactor>(index(1), saved.measurement, saved.information);
    }
  }
  catch (const std::logic_error& error)  // invalid_argument, out_of_range
  {
    throw UserError(std::string("the state of the run has an invalid factor: ") + error.what());
  }
  throw UserError("the state of the run has a factor of an unknown kind");
}
}  // namespace dyslam
