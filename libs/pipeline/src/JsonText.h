// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** Writes one JSON object, keys in the order they are added. */
class JsonText
{
 public:
  void add(const std::string& key, const std::string& value) { put(key, quoted(value)); }
  void add(const std::string& key, std::size_t value) { put(key, std::to_string(value)); }
  void add(const std::string& key, double value) { put(key, number(value)); }
  void add(const std::string& key, const std::vector<std::string>& values)
  {
    std::string list;
    for (const auto& value : values)
    {
      list += (list.empty() ? "" : ", ") + quoted(value);
    }
    put(key, "[" + list + "]");
  }
  void add(const std::string& key, const std::map<std::string, double>& values)
  {
    std::string list;
    for (const auto& [name, value] : values)
    {
      list += (list.empty() ? "" : ", ") + quoted(name) + ": " + number(value);
    }
    put(key, "{" + list + "}");
  }
  [[nodiscard]] std::string text() const { return "{\n" + members_ + "\n}\n"; }

 private:
  void put(const std::string& key, const std::string& value)
  {
    members_ += (members_.empty() ? "  " : ",\n  ") + quoted(key) + ": " + value;
  }
  static std::string number(double value)
  {
    if (!std::isfinite(value))
    {
      return "null";
    }
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
  }
  static std::string quoted(const std::string& value)
  {
    std::string text = "\"";
    for (const char c : value)
    {
      if (c == '"' || c == '\\')
      {
        text += '\\';
      }
      if (static_cast<unsigned char>(c) < 0x20)
      {
        char escaped[8];
        std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
        text += escaped;
      }
      else
      {
        text += c;
      }
    }
    return text + "\"";
  }

  std::string members_;
};
}  // namespace dyslam
