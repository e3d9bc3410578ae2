// SPDX-License-Identifier: BSD-3-Clause
#include <arpa/inet.h>
#include <dyslam/base/Error.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/packets/UdpAddress.h>

#include <algorithm>
#include <cctype>
#include <optional>

namespace dyslam
{
namespace
{
constexpr const char* examples =
    ": give udp:PORT or udp:ADDRESS:PORT, such as udp:2368 or udp:192.168.1.77:2368; several ports "
    "with commas: udp:7502,7503";

std::optional<std::uint16_t> portOf(const std::string& word)
{
  constexpr std::size_t most_digits = 5;
  constexpr unsigned long largest = 65535;
  const bool is_number =
      !word.empty() && word.size() <= most_digits &&
      std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!is_number || std::stoul(word) > largest)
  {
    return std::nullopt;
  }
  return static_cast<std::uint16_t>(std::stoul(word));
}

bool isIpv4(const std::string& address)
{
  in_addr parsed = {};
  return ::inet_pton(AF_INET, address.c_str(), &parsed) == 1;
}
}  // namespace

UdpAddress UdpAddress::fromText(const std::string& text)
{
  UdpAddress result;
  std::string rest = isNetworkInput(text) ? text.substr(text.find(':') + 1) : "";
  if (const auto colon = rest.rfind(':'); colon != std::string::npos)
  {
    result.address = rest.substr(0, colon);
    rest.erase(0, colon + 1);
    if (!isIpv4(result.address))
    {
      throw UserError("--input " + text + ": '" + result.address + "' is no IPv4 address" +
                      examples);
    }
  }
  for (std::size_t begin = 0; begin <= rest.size();)
  {
    const std::size_t end = std::min(rest.find(',', begin), rest.size());
    const std::string word = rest.substr(begin, end - begin);
    const auto port = portOf(word);
    if (!port)
    {
      throw UserError("--input " + text + ": '" + word + "' is no UDP port" + examples);
    }
    const bool is_known =
        std::find(result.ports.begin(), result.ports.end(), *port) != result.ports.end();
    if (is_known && *port != 0)
    {
      throw UserError("--input " + text + ": port " + word + " is given twice");
    }
    result.ports.push_back(*port);
    begin = end + 1;
  }
  return result;
}

std::string UdpAddress::portsText() const
{
  std::string words;
  for (const std::uint16_t port : ports)
  {
    words += (words.empty() ? "" : ",") + std::to_string(port);
  }
  return words;
}

std::string UdpAddress::text() const
{
  return "udp:" + (address.empty() ? "" : address + ":") + portsText();
}
}  // namespace dyslam
