// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/packets/UdpAddress.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
TEST(UdpAddress, ReadsPortsAndAddress)
{
  const UdpAddress port = UdpAddress::fromText("udp:2368");
  EXPECT_EQ("", port.address);
  EXPECT_EQ(std::vector<std::uint16_t>({2368}), port.ports);
  const UdpAddress both = UdpAddress::fromText("udp:192.168.1.77:7502,7503");
  EXPECT_EQ("192.168.1.77", both.address);
  EXPECT_EQ(std::vector<std::uint16_t>({7502, 7503}), both.ports);
  EXPECT_EQ("7502,7503", both.portsText());
  for (const std::string text : {"udp:1", "udp:65535", "udp:0,0", "udp:239.1.2.3:2368,8308"})
  {
    EXPECT_EQ(text, UdpAddress::fromText(text).text());
  }
}

TEST(UdpAddress, NamesWhatIsWrong)
{
  const auto said = [](const std::string& text)
  { return messageOfError<UserError>([&] { (void)UdpAddress::fromText(text); }); };
  for (const auto& [text, part] :
       {std::pair("udp:", "'' is no UDP port"), std::pair("udp:a", "'a' is no UDP port"),
        std::pair("udp:65536", "'65536' is no UDP port"),
        std::pair("udp:-1", "'-1' is no UDP port"), std::pair("udp:1,", "'' is no UDP port"),
        std::pair("udp:host:1", "'host' is no IPv4 address"),
        std::pair("udp:fe80::1:1", "'fe80::1' is no IPv4 address"),
        std::pair("udp:1.2.3.256:1", "'1.2.3.256' is no IPv4 address"),
        std::pair("udp::1", "'' is no IPv4 address"), std::pair("tcp:1", "'' is no UDP port"),
        std::pair("udp:99999999999999999999", "is no UDP port"),
        std::pair("udp:1,1", "port 1 is given twice")})
  {
    const std::string message = said(text);
    EXPECT_TRUE(contains(message, std::string("--input ") + text + ": ")) << message;
    EXPECT_TRUE(contains(message, part)) << message;
  }
  EXPECT_TRUE(contains(said("udp:x"), "such as udp:2368"));
}
}  // namespace dyslam
