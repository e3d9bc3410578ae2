// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/FactorType.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "FactorGraphFormat.h"

namespace dyslam
{
namespace
{
constexpr std::size_t measurement_size = 12;  // a 3x4 matrix by rows
constexpr double unit_tolerance = 1e-6;       // tolerance of quaternions and rotation matrices

/** Thrown for a factor that is left out. */
class UnusableFactor : public std::invalid_argument
{
 public:
  using std::invalid_argument::invalid_argument;
};

/** Reads the fields of a line one after the other. */
class LineReader
{
 public:
  explicit LineReader(const TextFile& file) : file_(file) {}

  std::string_view word()
  {
    requireMore();
    return file_.fields()[next_++];
  }
  int integer()
  {
    requireMore();
    return file_.integer(next_++);
  }
  std::size_t index()
  {
    const int value = integer();
    if (value < 0)
    {
      file_.fail("'" + std::to_string(value) + "' must be 0 or more");
    }
    return static_cast<std::size_t>(value);
  }
  double number()
  {
    requireMore();
    return file_.number(next_++);
  }
  /** A number of a factor; the factor is left out if it is not finite. */
  double measured()
  {
    requireMore();
    std::string text(file_.fields()[next_]);
    text.erase(0, text.find_first_not_of("+-"));
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (text == "nan" || text == "inf" || text == "infinity")
    {
      ++next_;
      finite_ = false;
      return 0;
    }
    return file_.number(next_++);
  }
  Key key()
  {
    const std::string_view kind = word();
    if (kind == lineNameOf(VariableKind::ego_pose))
    {
      return Key::ego(index());
    }
    for (const Key& single :
         {Key::georeference(), Key::vertical(), Key::accelerometerBias(), Key::priorMap()})
    {
      if (kind == lineNameOf(single.kind))
      {
        return single;
      }
    }
    for (const VariableKind known :
         {VariableKind::static_object, VariableKind::object_pose, VariableKind::object_velocity})
    {
      if (kind == lineNameOf(known))
      {
        const int object = integer();
        return {known, object, static_cast<std::int64_t>(index())};
      }
    }
    file_.fail("'" + std::string(kind) +
               "' is no kind of variable; use EGO, STATIC_OBJECT, OBJECT, VELOCITY, GEOREFERENCE, "
               "VERTICAL, ACCELEROMETER_BIAS or PRIOR_MAP");
  }
  Pose measurement()
  {
    Pose pose = Pose::Identity();
    for (std::size_t i = 0; i < measurement_size; ++i)
    {
      pose(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = measured();
    }
    is_rotation_ = (pose.linear() * pose.linear().transpose())
                       .isApprox(Eigen::Matrix3d::Identity(), unit_tolerance) &&
                   pose.linear().determinant() > 0;
    return pose;
  }
  /** \param size its first rows and columns are read, the others are zero */
  Matrix6 information(int size)
  {
    Matrix6 information = Matrix6::Zero();
    for (int row = 0; row < size; ++row)
    {
      for (int column = row; column < size; ++column)
      {
        information(row, column) = information(column, row) = measured();
      }
    }
    return information;
  }
  /** Checks that there is no further field. */
  void finish() const
  {
    if (next_ != file_.fields().size())
    {
      file_.fail("has " + counted(file_.fields().size(), "field") + ", needs " +
                 std::to_string(next_));
    }
    if (!finite_)
    {
      throw UnusableFactor("has numbers that are not finite");
    }
    if (!is_rotation_)
    {
      throw UnusableFactor("its measurement is no rotation and translation");
    }
  }

 private:
  void requireMore() const
  {
    if (next_ >= file_.fields().size())
    {
      file_.fail("ends after " + counted(next_, "field") + "; the line is cut off");
    }
  }

  const TextFile& file_;
  std::size_t next_ = 0;
  bool finite_ = true;
  bool is_rotation_ = true;
};

void readVariable(const TextFile& file, FactorGraph& graph)
{
  LineReader line(file);
  const Key key = line.key();
  std::array<double, pose_block_size> block{};
  const int size = key.isPose() ? pose_block_size : velocity_block_size;
  for (int i = 0; i < size; ++i)
  {
    block[static_cast<std::size_t>(i)] = line.number();
  }
  line.finish();
  if (graph.contains(key))
  {
    file.fail(toString(key) + " is there twice; remove one of the two");
  }
  if (key.isPose() &&
      std::abs(Eigen::Map<const Eigen::Vector4d>(block.data() + 3).norm() - 1) > unit_tolerance)
  {
    file.fail("the quaternion of " + toString(key) + " is not of unit length");
  }
  graph.addBlock(key, block);
}

void readFixed(const TextFile& file, FactorGraph& graph)
{
  LineReader line(file);
  (void)line.word();
  const Key key = line.key();
  line.finish();
  if (!graph.contains(key))
  {
    file.fail("fixes " + toString(key) + ", which no line before gives a value");
  }
  graph.setFixed(key, true);
}

class FieldsReader final : public FactorFields
{
 public:
  explicit FieldsReader(LineReader& line) : line_(line) {}

  void object(std::int64_t& id) override { id = line_.integer(); }
  void index(std::int64_t& index) override { index = static_cast<std::int64_t>(line_.index()); }
  void key(Key& key) override { key = line_.key(); }
  void number(double& value) override { value = line_.measured(); }
  void pose(Pose& pose) override { pose = line_.measurement(); }

 private:
  LineReader& line_;
};

std::unique_ptr<const Factor> readFactor(const FactorType& type, LineReader& line)
{
  FactorData data;
  FieldsReader fields(line);
  type.exchangeFields(data, fields);
  data.information = line.information(type.dimension);
  line.finish();
  return type.make(data);
}

/** \param warnings of factors that are left out; null: such a factor is an error */
void readLine(const TextFile& file, FactorGraph& graph, std::vector<std::string>* warnings)
{
  const std::string kind(file.fields().front());
  const auto is = [&kind](std::initializer_list<const char*> kinds)
  { return std::find(kinds.begin(), kinds.end(), kind) != kinds.end(); };
  if (kind == "FIX")
  {
    readFixed(file, graph);
    return;
  }
  if (is({"EGO", "STATIC_OBJECT", "OBJECT", "VELOCITY", "GEOREFERENCE", "VERTICAL",
          "ACCELEROMETER_BIAS", "PRIOR_MAP"}))
  {
    readVariable(file, graph);
    return;
  }
  const FactorType* type = graph.types().find(kind);
  if (type == nullptr)
  {
    file.fail("'" + kind + "' is no kind of variable or factor of a factor graph");
  }
  try
  {
    LineReader line(file);
    (void)line.word();
    const FactorGraph::FactorId id = graph.add(readFactor(*type, line));
    if (type->left_out_line != nullptr && kind == type->left_out_line)
    {
      graph.leaveOut(id);
    }
  }
  catch (const std::invalid_argument& error)
  {
    if (warnings == nullptr)
    {
      file.fail(std::string(error.what()) + "; correct or remove the line");
    }
    warnings->push_back(file.position() + ": left out: " + error.what());
  }
}

FactorGraph readFile(const std::string& path,
                     std::vector<std::string>* warnings,
                     const FactorTypes& types)
{
  TextFile file(path);
  const std::string header =
      std::string(factor_graph_format) + " " + std::to_string(factor_graph_version);
  if (!file.next() || file.fields().size() != 2 || file.fields()[0] != factor_graph_format)
  {
    throw UserError(path + ": is no factor graph; its first line must be '" + header + "'");
  }
  if (file.integer(1) != factor_graph_version)
  {
    file.fail("version " + std::string(file.fields()[1]) + " is not known; this is version " +
              std::to_string(factor_graph_version));
  }
  FactorGraph graph(types);
  while (file.next())
  {
    readLine(file, graph, warnings);
  }
  return graph;
}
}  // namespace

FactorGraph readFactorGraph(const std::string& path,
                            std::vector<std::string>& warnings,
                            const FactorTypes& types)
{
  return readFile(path, &warnings, types);
}

FactorGraph readFactorGraph(const std::string& path, const FactorTypes& types)
{
  return readFile(path, nullptr, types);
}

bool isFactorGraphFile(const std::string& path)
{
  TextFile file(path);
  return file.next() && file.fields().front() == factor_graph_format;
}
}  // namespace dyslam
