// SPDX-License-Identifier: BSD-3-Clause
#include "YamlText.h"

#include <dyslam/base/Printable.h>

#include <algorithm>

namespace dyslam
{
namespace
{
bool isControl(char c)
{
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
}

/** As a block scalar; names end in .png or .las, so that none reads as a number or a word. */
bool isPlain(const std::string& name)
{
  if (name.empty() || name.front() == ' ' || name.back() == ' ' || name.back() == ':' ||
      std::any_of(name.begin(), name.end(), isControl))
  {
    return false;
  }
  const char first = name.front();
  const bool may_begin = first == '-' || first == '?' || first == ':';
  return std::string(",[]{}#&*!|>'\"%@`").find(first) == std::string::npos &&
         (!may_begin || (name.size() > 1 && name[1] != ' ')) &&
         name.find(": ") == std::string::npos && name.find(" #") == std::string::npos;
}

std::string escaped(char c)
{
  if (c == '"' || c == '\\')
  {
    return {'\\', c};
  }
  if (!isControl(c))
  {
    return {c};
  }
  return formatted("\\x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
}
}  // namespace

std::string yamlText(const std::string& name)
{
  if (isPlain(name))
  {
    return name;
  }
  std::string text = "\"";
  for (const char c : name)
  {
    text += escaped(c);
  }
  return text + '"';
}

std::string fromYamlText(const std::string& text, const std::string& end)
{
  if (text.empty() || text.front() != '"')
  {
    return end.empty() ? text : text.substr(0, text.rfind(end));
  }
  std::string name;
  for (std::size_t i = 1; i < text.size() && text[i] != '"'; ++i)
  {
    if (text[i] != '\\' || i + 1 == text.size())
    {
      name.push_back(text[i]);
      continue;
    }
    ++i;
    if (text[i] == 'x')
    {
      unsigned code = 0;
      std::sscanf(text.substr(i + 1, 2).c_str(), "%2x", &code);
      name.push_back(static_cast<char>(code));
      i += 2;
    }
    else
    {
      name.push_back(text[i]);
    }
  }
  return name;
}
}  // namespace dyslam
