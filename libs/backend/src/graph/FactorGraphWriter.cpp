// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/FactorType.h>
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

class FieldsWriter final : public FactorFields
{
 public:
  explicit FieldsWriter(std::string& text) : text_(text) {}

  void object(std::int64_t& id) override { append(text_, id); }
  void index(std::int64_t& index) override { append(text_, index); }
  void key(Key& key) override
  {
    text_ += ' ';
    append(text_, key);
  }
  void number(double& value) override { append(text_, value); }
  void pose(Pose& pose) override
  {
    for (int row = 0; row < 3; ++row)
    {
      for (int column = 0; column < 4; ++column)
      {
        append(text_, pose(row, column));
      }
    }
  }

 private:
  std::string& text_;
};

std::string factorLine(const Factor& factor, bool left_out)
{
  const FactorType& type = factor.type();
  std::string text = left_out && type.left_out_line != nullptr ? type.left_out_line : type.line;
  FactorData data = factor.data();
  FieldsWriter fields(text);
  type.exchangeFields(data, fields);
  const Matrix6& information = factor.information();
  for (int row = 0; row < type.dimension; ++row)
  {
    for (int column = row; column < type.dimension; ++column)
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
