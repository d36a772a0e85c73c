#include "observe/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "observe/dds.hpp"

namespace interply::observe {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& network) {
  try {
    check_network({.network = network, .run = "check"});
    return "accepted";
  } catch (const std::runtime_error& e) {
    return e.what();
  }
}

TEST(Network, LoopbackIsFoundByNameAddressAndNetwork) {
  for (const char* network : {"lo", "127.0.0.1", "127.0.0.0"}) {
    EXPECT_EQ(find_interface(network).name, "lo") << network;
    EXPECT_EQ(find_interface(network).address, "127.0.0.1") << network;
    EXPECT_EQ(refusal(network), "accepted");
  }
}

TEST(Network, WhatNoInterfaceHasIsRefusedNamingThoseThereAre) {
  for (const char* network : {"foo", "203.0.113.7", "", "::1", "0.0.0.0", "127.0.0.2", "127.0.0.1/8", "*"}) {
    EXPECT_THAT(refusal(network), HasSubstr("observe.network: '" + std::string(network) + "' is no network interface"));
    EXPECT_THAT(refusal(network), HasSubstr("lo (127.0.0.1)"));
  }
  EXPECT_THAT(refusal("a\nb\033[2J"), HasSubstr("'a\\x0ab\\x1b[2J'"));
}

}  // namespace
}  // namespace interply::observe
