// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/TextFile.h>

#include <cstdint>
#include <ostream>
#include <string>

#include "FactorGraphFormat.h"

namespace dyslam
{
std::string_view lineNameOf(VariableKind kind)
{
  switch (kind)
  {
    case VariableKind::ego_pose:
      return "EGO";
    case VariableKind::static_object:
      return "STATIC_OBJECT";
    case VariableKind::object_pose:
      return "OBJECT";
    case VariableKind::georeference:
      return "GEOREFERENCE";
    case VariableKind::vertical:
      return "VERTICAL";
    case VariableKind::accelerometer_bias:
      return "ACCELEROMETER_BIAS";
    case VariableKind::prior_map:
      return "PRIOR_MAP";
    case VariableKind::object_velocity:
      break;
  }
  return "VELOCITY";
}

namespace
{
constexpr int all_digits = 17;

void append(std::string& text, double value)
{
  text += ' ';
  appendNumber(text, value, all_digits);
}

void append(std::string& text, std::int64_t value)
{
  text += ' ' + std::to_string(value);
}

void append(std::string& text, const Key& key)
{
  text += lineNameOf(key.kind);
  if (key.isSingle())
  {
    return;
  }
  if (key.kind != VariableKind::ego_pose)
  {
    append(text, key.object);
  }
  append(text, key.index);
}

std::string variableLine(const Key& key, const FactorGraph::Variable& variable)
{
  std::string text;
  append(text, key);
  const int size = key.isPose() ? pose_block_size : velocity_block_size;
  for (int i = 0; i < size; ++i)
  {
    append(text, variable.block[static_cast<std::size_t>(i)]);
  }
  text += '\n';
  if (variable.fixed)
  {
    text += "FIX ";
    append(text, key);
    text += '\n';
  }
  return text;
}

void append(std::string& text, const Eigen::Vector3d& vector)
{
  for (const double value : vector)
  {
    append(text, value);
  }
}

void appendMeasurement(std::string& text, const Pose& pose)
{
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      append(text, pose(row, column));
    }
  }
}

std::string relativePoseName(const Factor& factor, bool left_out)
{
  if (factor.kind() == FactorKind::odometry)
  {
    return "ODOMETRY";
  }
  return left_out ? "LEFT_OUT_LOOP" : "LOOP";
}

std::string factorLine(const Factor& factor, bool left_out)
{
  const std::vector<Key>& keys = factor.keys();
  std::string text;
  switch (factor.kind())
  {
    case FactorKind::odometry:
    case FactorKind::loop:
      text = relativePoseName(factor, left_out);
      append(text, keys[0].index);
      append(text, keys[1].index);
      appendMeasurement(text, factor.measurement());
      break;
    case FactorKind::observation:
      text = "OBSERVATION";
      append(text, keys[0].index);
      text += ' ';
      append(text, keys[1]);
      appendMeasurement(text, factor.measurement());
      break;
    case FactorKind::localisation:
      text = "LOCALISATION";
      append(text, keys[1].index);
      appendMeasurement(text, factor.measurement());
      break;
    case FactorKind::gnss:
      text = "GNSS";
      append(text, keys[0].index);
      append(text, Eigen::Vector3d(factor.measurement().translation()));
      append(text, static_cast<const GnssFactor&>(factor).antenna());
      break;
    case FactorKind::gravity:
      text = "GRAVITY";
      append(text, keys[0].index);
      append(text, static_cast<const GravityFactor&>(factor).upwards());
      break;
    case FactorKind::object_motion:
    case FactorKind::smooth_motion:
      text = factor.kind() == FactorKind::object_motion ? "OBJECT_MOTION" : "SMOOTH_MOTION";
      append(text, keys[0].object);
      append(text, keys[0].index);
      append(text, keys[1].index);
      if (factor.kind() == FactorKind::object_motion)
      {
        append(text, static_cast<const ObjectMotionFactor&>(factor).dt());
      }
      break;
  }
  const Matrix6& information = factor.information();
  for (int row = 0; row < 6; ++row)
  {
    for (int column = row; column < 6; ++column)
    {
      append(text, information(row, column));
    }
  }
  return text + '\n';
}
}  // namespace

void writeFactorGraph(const FactorGraph& graph, const std::string& path)
{
  writeWhole(path,
             [&graph](std::ostream& out)
             {
               out << factor_graph_format << ' ' << factor_graph_version << '\n';
               for (const auto& [key, variable] : graph.variables())
               {
                 out << variableLine(key, variable);
               }
               for (const FactorGraph::FactorId id : graph.factorIds())
               {
                 out << factorLine(graph.factor(id), graph.isLeftOut(id));
               }
             });
}

}  // namespace dyslam
