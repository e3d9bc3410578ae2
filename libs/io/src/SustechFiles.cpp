// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/io/KittiFiles.h>

#include <boost/property_tree/json_parser.hpp>
#include <cmath>
#include <sstream>

#include "TextFile.h"

namespace dyslam
{
namespace
{
constexpr double pi = 3.14159265358979323846;
using boost::property_tree::ptree;

Eigen::Vector3d vectorAt(const ptree& object, const std::string& path)
{
  return {object.get<double>(path + ".x"), object.get<double>(path + ".y"),
          object.get<double>(path + ".z")};
}

LabelledBox boxFrom(const ptree& object, int frame)
{
  LabelledBox box;
  box.frame = frame;
  box.id = object.get<int>("obj_id");
  box.type = object.get<std::string>("obj_type");
  box.object_class = objectClassFromString(box.type);
  box.box.center = vectorAt(object, "psr.position");
  box.box.size = vectorAt(object, "psr.scale");
  box.box.yaw = std::remainder(object.get<double>("psr.rotation.z"), 2 * pi);
  return box;
}
}  // namespace

std::vector<LabelledBox> readSustechJson(const std::string& path, int frame)
{
  std::istringstream text(readWhole(path));
  std::vector<LabelledBox> boxes;
  try
  {
    ptree root;
    boost::property_tree::read_json(text, root);
    for (const auto& [key, object] : root)
    {
      boxes.push_back(boxFrom(object, frame));
    }
  }
  catch (const boost::property_tree::json_parser_error& error)
  {
    throw UserError(path + ":" + std::to_string(error.line()) + ": " + error.message());
  }
  catch (const boost::property_tree::ptree_error& error)
  {
    throw UserError(path + ": box " + std::to_string(boxes.size()) + ": " + error.what());
  }
  return boxes;
}
}  // namespace dyslam
