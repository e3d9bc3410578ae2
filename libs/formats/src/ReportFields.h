// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
using ReportJson = nlohmann::ordered_json;

/** \throws UserError with what is wrong in a file. */
[[noreturn]] inline void failOnReport(const std::string& path, const std::string& what)
{
  throw UserError(path + ": " + what + "; is it of dyslam?");
}

/** Fields of an object in a report; those that are missing or null are nothing. Every function
 * throws a UserError that names file and field if the field is of another type. */
class ReportFields
{
 public:
  /** \param json outlives the fields \param path of the file \param name of the object in messages;
   * empty for the whole report */
  ReportFields(const ReportJson& json, std::string path, std::string name)
      : json_(&json), path_(std::move(path)), name_(std::move(name))
  {
  }
  [[noreturn]] void fail(const std::string& what) const { failOnReport(path_, what); }

  [[nodiscard]] std::optional<double> number(const char* key) const
  {
    const ReportJson* value = find(key);
    require(value == nullptr || value->is_number(), key, "a number");
    return value == nullptr ? std::nullopt : std::optional<double>(value->get<double>());
  }
  [[nodiscard]] std::optional<std::size_t> count(const char* key) const
  {
    const ReportJson* value = find(key);
    require(value == nullptr || value->is_number_unsigned(), key, "a whole number");
    return value == nullptr ? std::nullopt : std::optional<std::size_t>(value->get<std::size_t>());
  }
  [[nodiscard]] std::optional<bool> flag(const char* key) const
  {
    const ReportJson* value = find(key);
    require(value == nullptr || value->is_boolean(), key, "true or false");
    return value == nullptr ? std::nullopt : std::optional<bool>(value->get<bool>());
  }
  [[nodiscard]] std::string text(const char* key) const
  {
    const ReportJson* value = find(key);
    require(value == nullptr || value->is_string(), key, "a text");
    return value == nullptr ? "" : value->get<std::string>();
  }
  [[nodiscard]] std::vector<std::string> texts(const char* key) const
  {
    std::vector<std::string> result;
    if (const ReportJson* value = find(key))
    {
      require(value->is_array(), key, "a list of texts");
      for (const ReportJson& entry : *value)
      {
        require(entry.is_string(), key, "a list of texts");
        result.push_back(entry.get<std::string>());
      }
    }
    return result;
  }
  /** Numbers by name, without those that are null. */
  [[nodiscard]] std::map<std::string, double> numbers(const char* key) const
  {
    std::map<std::string, double> result;
    const auto values = object(key);
    if (values)
    {
      for (const auto& [name, value] : values->json_->items())
      {
        if (const auto read = values->number(name.c_str()))
        {
          result[name] = *read;
        }
      }
    }
    return result;
  }
  /** Three numbers. */
  [[nodiscard]] std::optional<Eigen::Vector3d> vector(const char* key) const
  {
    const ReportJson* value = find(key);
    if (value == nullptr)
    {
      return std::nullopt;
    }
    require(value->is_array() && value->size() == 3, key, "a list of three numbers");
    Eigen::Vector3d result;
    for (int i = 0; i < 3; ++i)
    {
      const ReportJson& entry = (*value)[static_cast<std::size_t>(i)];
      require(entry.is_number(), key, "a list of three numbers");
      result[i] = entry.get<double>();
    }
    return result;
  }
  [[nodiscard]] std::optional<ReportFields> object(const char* key) const
  {
    const ReportJson* value = find(key);
    require(value == nullptr || value->is_object(), key, "an object");
    return value == nullptr ? std::nullopt
                            : std::optional<ReportFields>(ReportFields(*value, path_, nameOf(key)));
  }

 private:
  [[nodiscard]] const ReportJson* find(const char* key) const
  {
    const auto found = json_->find(key);
    return found == json_->end() || found->is_null() ? nullptr : &*found;
  }
  [[nodiscard]] std::string nameOf(const char* key) const
  {
    return name_.empty() ? key : name_ + "." + key;
  }
  void require(bool valid, const char* key, const char* type) const
  {
    if (!valid)
    {
      fail("\"" + nameOf(key) + "\" is not " + type);
    }
  }

  const ReportJson* json_;
  std::string path_;
  std::string name_;
};
}  // namespace dyslam
