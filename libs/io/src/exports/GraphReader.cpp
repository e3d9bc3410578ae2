// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/core/PoseInformation.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/mrpt/Conversions.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "RollYaw.h"

namespace dyslam
{
namespace
{
using Graph = mrpt::graphs::CNetworkOfPoses3DInf;
using mrpt::graphs::TNodeID;

/** The current line of a file, word by word; errors name file and line. */
class LineReader
{
 public:
  explicit LineReader(const TextFile& file) : file_(file) {}

  /** The next word; empty at the end of the line. */
  [[nodiscard]] std::string_view word()
  {
    const std::size_t at = next_++;
    return at < file_.fields().size() ? file_.fields()[at] : std::string_view();
  }

  [[nodiscard]] double number(const char* name)
  {
    const std::string_view text = word();
    const std::optional<double> value = parseNumber<double>(text);
    if (!value)
    {
      fail(name, text, "a number");
    }
    if (!std::isfinite(*value))
    {
      fail(name, text, "a finite number");
    }
    return *value;
  }

  [[nodiscard]] TNodeID id(const char* name)
  {
    const std::string_view text = word();
    TNodeID value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size())
    {
      fail(name, text, "a node number");
    }
    return value;
  }

  [[nodiscard]] bool atEnd() const
  {
    const auto& words = file_.fields();
    return next_ >= words.size() || words[next_].front() == '|' || words[next_].front() == '#';
  }

  void requireEnd()
  {
    if (!atEnd())
    {
      const std::string_view text = word();
      fail("end of line", text, "nothing more");
    }
  }

  [[noreturn]] void fail(const std::string& message) const { file_.fail(message); }

 private:
  [[noreturn]] void fail(const char* name, std::string_view text, const char* wanted) const
  {
    const std::string found = text.empty() ? "the line ends" : "'" + std::string(text) + "' stands";
    fail("field " + std::to_string(next_) + " (" + name + "): " + found + " where " + wanted +
         " should be");
  }

  const TextFile& file_;
  std::size_t next_ = 0;
};

Eigen::Vector3d readVector(LineReader& line, const std::array<const char*, 3>& names)
{
  Eigen::Vector3d v;
  for (Eigen::Index i = 0; i < 3; ++i)
  {
    v[i] = line.number(names[static_cast<std::size_t>(i)]);
  }
  return v;
}

Pose readQuaternionPose(LineReader& line)
{
  Pose pose = Pose::Identity();
  pose.translation() = readVector(line, {"x", "y", "z"});
  const Eigen::Vector3d vector_part = readVector(line, {"qx", "qy", "qz"});
  Eigen::Quaterniond q(line.number("qw"), vector_part.x(), vector_part.y(), vector_part.z());
  if (std::abs(q.norm() - 1) > 0.05)
  {
    line.fail("quaternion of length " + std::to_string(q.norm()) +
              "; a rotation has length 1 (order qx qy qz qw)");
  }
  pose.linear() = q.normalized().toRotationMatrix();
  return pose;
}

Pose readRollPitchYawPose(LineReader& line)
{
  const Eigen::Vector3d t = readVector(line, {"x", "y", "z"});
  const Eigen::Vector3d rpy = readVector(line, {"roll", "pitch", "yaw"});
  return poseFromYpr(t.x(), t.y(), t.z(), rpy.z(), rpy.y(), rpy.x());
}

Pose readPlanarPose(LineReader& line)
{
  const double x = line.number("x");
  const double y = line.number("y");
  return poseFromYpr(x, y, 0, line.number("heading"), 0, 0);
}

template <int N>
Eigen::Matrix<double, N, N> readUpperTriangle(LineReader& line)
{
  Eigen::Matrix<double, N, N> m;
  for (Eigen::Index r = 0; r < N; ++r)
  {
    for (Eigen::Index c = r; c < N; ++c)
    {
      const std::string name = "information " + std::to_string(r + 1) + "," + std::to_string(c + 1);
      m(r, c) = line.number(name.c_str());
      m(c, r) = m(r, c);
    }
  }
  return m;
}

/** The information of TORO's EDGE2: xx xy yy hh xh yh. Other programs write EDGE2 in the order of
 * EDGE_SE2, or the square root of the matrix. Their numbers, unless all are filled in, are not
 * positive definite in TORO's order. */
Eigen::Matrix3d readToroInformation(LineReader& line)
{
  constexpr std::array<std::array<Eigen::Index, 2>, 6> order = {
      {{0, 0}, {0, 1}, {1, 1}, {2, 2}, {0, 2}, {1, 2}}};
  Eigen::Matrix3d m;
  for (const auto& [r, c] : order)
  {
    const std::string name = "information " + std::to_string(r + 1) + "," + std::to_string(c + 1);
    m(r, c) = line.number(name.c_str());
    m(c, r) = m(r, c);
  }
  if (m.llt().info() != Eigen::Success)
  {
    line.fail(
        "the information of 'EDGE2' is not positive definite in TORO's order (xx xy yy hh xh yh), "
        "other programs have others; write VERTEX_SE2 and EDGE_SE2 (information xx xy xh yy yh hh) "
        "instead");
  }
  return m;
}

/** Information of a planar pose as one over the tangent in space. */
Matrix6 lifted(const Eigen::Matrix3d& planar)
{
  const std::array<Eigen::Index, 3> at = {0, 1, 5};
  Matrix6 information = Matrix6::Zero();
  for (Eigen::Index r = 0; r < 3; ++r)
  {
    for (Eigen::Index c = 0; c < 3; ++c)
    {
      information(at[static_cast<std::size_t>(r)], at[static_cast<std::size_t>(c)]) = planar(r, c);
    }
  }
  information(2, 2) = 0.5 * (planar(0, 0) + planar(1, 1));
  information(3, 3) = planar(2, 2);
  information(4, 4) = planar(2, 2);
  return information;
}

class GraphReader
{
 public:
  explicit GraphReader(const std::string& path) : path_(path) {}

  /** Number of edges without an information matrix. */
  [[nodiscard]] std::size_t edgesWithoutInformation() const { return edges_without_information_; }

  Graph read()
  {
    for (TextFile file(path_, " \t\r"); file.next();)
    {
      readLine(LineReader(file));
    }
    if (graph_.nodes.empty() && graph_.edges.empty())
    {
      throw UserError(path_ + ": has no VERTEX or EDGE line; is it a .graph or .g2o file?");
    }
    setRoot();
    return std::move(graph_);
  }

 private:
  void readLine(LineReader line)
  {
    if (line.atEnd())
    {
      return;
    }
    const std::string_view key = line.word();
    if (key == "VERTEX_SE3:QUAT")
    {
      readVertex(line, readQuaternionPose);
    }
    else if (key == "VERTEX_SE2" || key == "VERTEX2")
    {
      readVertex(line, readPlanarPose);
    }
    else if (key == "VERTEX3")
    {
      readVertex(line, readRollPitchYawPose);
    }
    else if (key == "EDGE_SE3:QUAT" || key == "EDGE_SE2" || key == "EDGE3" || key == "EDGE2")
    {
      readEdge(line, key);
    }
    else if (key == "FIX")
    {
      readFix(line);
    }
    else if (key.substr(0, 7) != "PARAMS_")
    {
      failUnknown(line, key);
    }
  }

  template <typename ReadPose>
  void readVertex(LineReader& line, ReadPose read_pose)
  {
    const TNodeID id = line.id("id");
    const Pose pose = read_pose(line);
    line.requireEnd();
    if (!graph_.nodes.emplace(id, toMrpt(pose)).second)
    {
      line.fail("vertex " + std::to_string(id) + " is there twice; keep one of them");
    }
  }

  /** The information matrix of an edge; the identity if the line has none, as in MRPT and g2o. */
  template <typename Matrix>
  Matrix informationOf(LineReader& line, Matrix (*read)(LineReader&))
  {
    if (!line.atEnd())
    {
      return read(line);
    }
    ++edges_without_information_;
    return Matrix::Identity();
  }

  void readEdge(LineReader& line, std::string_view key)
  {
    const TNodeID from = line.id("from");
    const TNodeID to = line.id("to");
    if (from == to)
    {
      line.fail("edge from node " + std::to_string(from) + " to itself; remove it");
    }
    Pose mean;
    Matrix6 information_ypr;
    if (key == "EDGE_SE2")
    {
      mean = readPlanarPose(line);
      information_ypr = informationToYpr(mean, lifted(informationOf(line, readUpperTriangle<3>)));
    }
    else if (key == "EDGE2")
    {
      mean = readPlanarPose(line);
      information_ypr = swappedRollYaw(lifted(informationOf(line, readToroInformation)));
    }
    else if (key == "EDGE3")
    {
      mean = readRollPitchYawPose(line);
      information_ypr = swappedRollYaw(informationOf(line, readUpperTriangle<6>));
    }
    else
    {
      mean = readQuaternionPose(line);
      information_ypr = informationToYpr(
          mean, informationFromQuaternion(informationOf(line, readUpperTriangle<6>)));
    }
    line.requireEnd();
    const mrpt::poses::CPose3DPDFGaussianInf edge(toMrpt(mean),
                                                  mrpt::math::CMatrixDouble66(information_ypr));
    graph_.insertEdge(from, to, edge);
  }

  void readFix(LineReader& line)
  {
    const TNodeID id = line.id("id");
    line.requireEnd();
    if (root_ && *root_ != id)
    {
      line.fail("a second FIX; only one node can be the root, remove this line or that of node " +
                std::to_string(*root_));
    }
    root_ = id;
  }

  static void failUnknown(LineReader& line, std::string_view key)
  {
    const std::string word(key);
    if (std::any_of(word.begin(), word.end(),
                    [](char c) { return static_cast<unsigned char>(c) < ' '; }))
    {
      line.fail("is not text; give a .graph or .g2o file, unpacked if it is compressed");
    }
    if (word == "EDGE" || word == "ODOMETRY" || word == "VERTEX")
    {
      line.fail("'" + word + "' is read differently by different programs; write VERTEX_SE2 and " +
                "EDGE_SE2 (information xx xy xh yy yh hh) instead");
    }
    const std::vector<std::string> known = {"VERTEX_SE3:QUAT", "VERTEX_SE2",    "VERTEX3",
                                            "VERTEX2",         "EDGE_SE3:QUAT", "EDGE_SE2",
                                            "EDGE3",           "EDGE2",         "FIX"};
    constexpr std::size_t misspelt = 2;  // edits
    const bool looks_like_type = word.front() >= 'A' && word.front() <= 'Z';
    if (looks_like_type && editDistance(word, nearestWord(word, known)) > misspelt)
    {
      line.fail("'" + word + "' is not supported, only poses and edges between two of them (" +
                joined(known) + "); remove the lines of this type");
    }
    line.fail(unknownWord("entry", word, known));
  }

  void setRoot()
  {
    std::set<TNodeID> ids;
    for (const auto& [id, pose] : graph_.nodes)
    {
      ids.insert(id);
    }
    for (const auto& [pair, edge] : graph_.edges)
    {
      ids.insert({pair.first, pair.second});
    }
    if (root_ && ids.count(*root_) == 0)
    {
      throw UserError(path_ + ": FIX " + std::to_string(*root_) +
                      " names a node without VERTEX and EDGE; correct or remove the line");
    }
    graph_.root = root_.value_or(*ids.begin());
  }

  const std::string& path_;
  Graph graph_;
  std::optional<TNodeID> root_;
  std::size_t edges_without_information_ = 0;
};

}  // namespace

Graph readPoseGraph(const std::string& path, std::vector<std::string>* warnings)
{
  GraphReader reader(path);
  Graph graph = reader.read();
  if (warnings != nullptr && reader.edgesWithoutInformation() > 0)
  {
    warnings->push_back(path + ": " + counted(reader.edgesWithoutInformation(), "edge") +
                        " without an information matrix; the identity was used");
  }
  return graph;
}

}  // namespace dyslam
