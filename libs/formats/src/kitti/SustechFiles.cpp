// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/SustechFiles.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace dyslam
{
namespace
{
using nlohmann::json;

/** The message without the library's "[json.exception.type_error.302] ". */
std::string reasonOf(const std::exception& error)
{
  const std::string text = error.what();
  const auto end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

Eigen::Vector3d vectorFrom(const json& object)
{
  return {object.at("x").get<double>(), object.at("y").get<double>(), object.at("z").get<double>()};
}

/** The tool writes the number of an object as text, and nothing where it has none.
 * \return -1 for what is no number. */
int numberFrom(const json& object)
{
  const auto value = object.find("obj_id");
  if (value == object.end())
  {
    return -1;
  }
  const std::string text = value->is_string() ? value->get<std::string>() : value->dump();
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size() && number >= 0;
  return whole ? number : -1;
}

LabelledBox boxFrom(const json& object, int frame)
{
  LabelledBox box;
  box.frame = frame;
  box.id = numberFrom(object);
  box.type = object.at("obj_type").get<std::string>();
  box.object_class = objectClassFromString(box.type);
  const json& psr = object.at("psr");
  box.box.centre = vectorFrom(psr.at("position"));
  box.box.size = vectorFrom(psr.at("scale"));
  box.box.yaw = wrapAngle(psr.at("rotation").at("z").get<double>());
  return box;
}
}  // namespace

std::vector<LabelledBox> readSustechJson(const std::string& path, int frame)
{
  const std::string text = readWhole(path);
  if (isNestedDeeper(text))
  {
    throw UserError(path + ": is nested too deeply for a list of boxes");
  }
  std::vector<LabelledBox> boxes;
  json root;
  try
  {
    root = json::parse(text);
  }
  catch (const json::exception& error)
  {
    throw UserError(path + ": " + reasonOf(error));
  }
  if (!root.is_array())
  {
    throw UserError(path + ": is not a list of boxes, as SUSTechPOINTS writes it");
  }
  try
  {
    for (const json& object : root)
    {
      boxes.push_back(boxFrom(object, frame));
    }
  }
  catch (const std::exception& error)
  {
    throw UserError(path + ": box " + std::to_string(boxes.size() + 1) + ": " + reasonOf(error));
  }
  return boxes;
}
}  // namespace dyslam
