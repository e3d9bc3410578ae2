// SPDX-License-Identifier: BSD-3-Clause
// A reader of ROS 2 messages for tests, which knows nothing of the types but their definitions.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam::test
{
/** A message in little-endian CDR, decoded by the definition of its type as mcap files have it.
 * Fields are named by their path: "markers[1].pose.position.x". */
class DecodedMessage
{
 public:
  /** \param type "sensor_msgs/msg/Imu" \param definition as rosDefinition() \param data message */
  DecodedMessage(std::string type, const std::string& definition, std::string_view data)
      : data_(data)
  {
    type.erase(type.find("/msg/"), 4);
    parse(type, definition);
    EXPECT_EQ(std::string_view("\0\1\0\0", 4), data.substr(0, 4));
    at_ = 4;
    walk(type, "");
    EXPECT_EQ(data_.size(), at_) << type << ": bytes of the message and of its definition";
  }

  [[nodiscard]] double number(const std::string& path) const
  {
    const auto found = numbers_.find(path);
    EXPECT_TRUE(found != numbers_.end()) << "no field " << path;
    return found == numbers_.end() ? 0 : found->second;
  }
  /** A string, or a sequence of bytes. */
  [[nodiscard]] std::string text(const std::string& path) const
  {
    const auto found = texts_.find(path);
    EXPECT_TRUE(found != texts_.end()) << "no text " << path;
    return found == texts_.end() ? "" : found->second;
  }
  /** Number of elements of a sequence. */
  [[nodiscard]] std::size_t count(const std::string& path) const
  {
    const auto found = counts_.find(path);
    EXPECT_TRUE(found != counts_.end()) << "no sequence " << path;
    return found == counts_.end() ? 0 : found->second;
  }

 private:
  struct Field
  {
    std::string type;
    std::string name;
  };

  void parse(const std::string& root, const std::string& definition)
  {
    std::istringstream lines(definition);
    std::string type = root;
    types_[type];
    for (std::string line; std::getline(lines, line);)
    {
      if (line == std::string(80, '='))
      {
        std::getline(lines, line);
        EXPECT_EQ(0U, line.rfind("MSG: ", 0)) << line;
        type = line.substr(5);
        EXPECT_EQ(0U, types_.count(type)) << type << " is defined twice";
        types_[type];
        continue;
      }
      std::istringstream words(line);
      Field field;
      words >> field.type >> field.name;
      EXPECT_FALSE(field.name.empty()) << type << ": " << line;
      if (line.find('=') == std::string::npos)  // no constant
      {
        types_[type].push_back(field);
      }
    }
  }

  template <typename Number>
  Number take()
  {
    at_ += (sizeof(Number) - (at_ - 4) % sizeof(Number)) % sizeof(Number);
    Number value{};
    if (at_ + sizeof value > data_.size())
    {
      ADD_FAILURE() << "the message is too short";
      return value;
    }
    std::memcpy(&value, data_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  std::string takeBytes(std::size_t size)
  {
    if (at_ + size > data_.size())
    {
      ADD_FAILURE() << "the message is too short";
      return "";
    }
    std::string bytes(data_.substr(at_, size));
    at_ += size;
    return bytes;
  }

  bool takeNumber(const std::string& type, const std::string& path)
  {
    double& value = numbers_[path];
    if (type == "bool" || type == "uint8")
    {
      value = take<std::uint8_t>();
    }
    else if (type == "int8")
    {
      value = take<std::int8_t>();
    }
    else if (type == "uint16")
    {
      value = take<std::uint16_t>();
    }
    else if (type == "int32")
    {
      value = take<std::int32_t>();
    }
    else if (type == "uint32")
    {
      value = take<std::uint32_t>();
    }
    else if (type == "float32")
    {
      value = static_cast<double>(take<float>());
    }
    else if (type == "float64")
    {
      value = take<double>();
    }
    else
    {
      numbers_.erase(path);
      return false;
    }
    return true;
  }

  /** One value, no array. \param scope type that has the field */
  void takeOne(const std::string& type, const std::string& scope, const std::string& path)
  {
    if (type == "string")
    {
      std::string text = takeBytes(take<std::uint32_t>());
      EXPECT_FALSE(text.empty()) << path << ": the final zero counts";
      EXPECT_EQ('\0', text.empty() ? '\0' : text.back()) << path;
      texts_[path] = text.substr(0, text.empty() ? 0 : text.size() - 1);
    }
    else if (!takeNumber(type, path))
    {
      const bool own = type.find('/') == std::string::npos;
      walk(own ? scope.substr(0, scope.find('/') + 1) + type : type, path + ".");
    }
  }

  void walk(const std::string& type, const std::string& prefix)
  {
    const auto known = types_.find(type);
    ASSERT_TRUE(known != types_.end()) << type << " is not defined";
    for (const Field& field : known->second)
    {
      if (HasFailure() && at_ >= data_.size())
      {
        return;
      }
      const std::string path = prefix + field.name;
      const auto bracket = field.type.find('[');
      if (bracket == std::string::npos)
      {
        takeOne(field.type, type, path);
        continue;
      }
      const std::string element = field.type.substr(0, bracket);
      const std::string size = field.type.substr(bracket + 1, field.type.size() - bracket - 2);
      const std::size_t elements = size.empty() ? take<std::uint32_t>() : std::stoul(size);
      counts_[path] = elements;
      if (element == "uint8")
      {
        texts_[path] = takeBytes(elements);
        continue;
      }
      for (std::size_t i = 0; i < elements && at_ <= data_.size(); ++i)
      {
        takeOne(element, type, path + "[" + std::to_string(i) + "]");
      }
    }
  }

  static bool HasFailure() { return ::testing::Test::HasFailure(); }

  std::map<std::string, std::vector<Field>> types_;
  std::string_view data_;
  std::size_t at_ = 0;
  std::map<std::string, double> numbers_;
  std::map<std::string, std::string> texts_;
  std::map<std::string, std::size_t> counts_;
};
}  // namespace dyslam::test
