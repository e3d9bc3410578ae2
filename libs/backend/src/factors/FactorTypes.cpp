// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/backend/factors/ObservationFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>
#include <dyslam/base/Error.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace dyslam
{
// The position of a row is its number in checkpoints: new rows go to the end.
FactorTypes::FactorTypes(const std::vector<const FactorType*>& further)
    : rows_{
          &OdometryFactor::factor_type,      //
          &LoopFactor::factor_type,          //
          &ObservationFactor::factor_type,   //
          &ObjectMotionFactor::factor_type,  //
          &SmoothMotionFactor::factor_type,  //
          &GnssFactor::factor_type,          //
          &GravityFactor::factor_type,       //
          &LocalisationFactor::factor_type,  //
      }
{
  for (const FactorType* type : further)
  {
    if (find(type->line) != nullptr ||
        (type->left_out_line != nullptr && find(type->left_out_line) != nullptr))
    {
      throw std::invalid_argument(std::string("factor type ") + type->name +
                                  ": the word of its line is taken by another type");
    }
    if (type->dimension < 1 || type->dimension > 6)
    {
      throw std::invalid_argument(std::string("factor type ") + type->name +
                                  ": its dimension must be 1 to 6");
    }
    rows_.push_back(type);
  }
  if (rows_.size() > std::numeric_limits<std::uint8_t>::max())
  {
    throw std::invalid_argument("there are too many types of factor for a checkpoint");
  }
}

const FactorType* FactorTypes::find(std::string_view line) const
{
  const auto found = std::find_if(rows_.begin(), rows_.end(),
                                  [line](const FactorType* type) {
                                    return line == type->line || (type->left_out_line != nullptr &&
                                                                  line == type->left_out_line);
                                  });
  return found == rows_.end() ? nullptr : *found;
}

bool FactorTypes::contains(const FactorType& type) const
{
  return std::find(rows_.begin(), rows_.end(), &type) != rows_.end();
}

std::uint8_t FactorTypes::numberOf(const FactorType& type) const
{
  const auto found = std::find(rows_.begin(), rows_.end(), &type);
  if (found == rows_.end())
  {
    throw std::invalid_argument(std::string("factor type ") + type.name +
                                ": is not in the table of the graph's types");
  }
  return static_cast<std::uint8_t>(found - rows_.begin());
}

std::unique_ptr<const Factor> FactorTypes::make(std::uint8_t number, const FactorData& data) const
{
  if (data.keys.empty())
  {
    return nullptr;
  }
  if (number >= rows_.size())
  {
    throw UserError("the state of the run has a factor of an unknown kind");
  }
  try
  {
    return rows_[number]->make(data);
  }
  catch (const std::logic_error& error)  // invalid_argument, out_of_range
  {
    throw UserError(std::string("the state of the run has an invalid factor: ") + error.what());
  }
}

void FactorFields::vector(double* values)
{
  for (int i = 0; i < 3; ++i)
  {
    number(values[i]);
  }
}
}  // namespace dyslam
