/// What is an address, what it stands for, and that listening takes nothing away from anyone.
#include "exchange/address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include "exchange/carriers.hpp"

namespace interply::exchange {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string why_bad(const std::string& text, AddressUse use) {
  try {
    parse_address(text, use);
    return "";
  } catch (const BadAddress& e) {
    return e.what();
  }
}

bool has_ipv6() {
  try {
    check_listening("tcp://[::1]:0");
    return true;
  } catch (const BadAddress&) {
    return false;
  }
}

TEST(Address, APortIsANumberThatThereIs) {
  for (const std::string port : {"99999", "65536", "-1", "abc", "", "70e2", "7100 ", "0x1bbc"}) {
    EXPECT_THAT(why_bad("tcp://127.0.0.1:" + port, AddressUse::Listen), HasSubstr("not in [0, 65535]")) << port;
    EXPECT_THAT(why_bad("tcp://127.0.0.1:" + port, AddressUse::Connect), HasSubstr("not in [1, 65535]")) << port;
  }
  EXPECT_EQ(why_bad("tcp://127.0.0.1:65535", AddressUse::Listen), "");
  EXPECT_EQ(why_bad("tcp://127.0.0.1:*", AddressUse::Listen), "");
  EXPECT_THAT(why_bad("tcp://127.0.0.1:0", AddressUse::Connect), HasSubstr("[1, 65535]"));
  EXPECT_THAT(why_bad("tcp://127.0.0.1", AddressUse::Listen), HasSubstr("no port"));
}

TEST(Address, WhatIsNoneSaysWhatIsMissing) {
  EXPECT_THAT(why_bad("localhost:7100", AddressUse::Listen), HasSubstr("is not shm://PATH"));
  EXPECT_THAT(why_bad("", AddressUse::Connect), HasSubstr("is not shm://PATH"));
  EXPECT_THAT(why_bad("tcp://:7100", AddressUse::Listen), HasSubstr("no host"));
  EXPECT_THAT(why_bad("tcp://*:7100", AddressUse::Connect), HasSubstr("no host"));
  EXPECT_THAT(why_bad("tcp://::1:7100", AddressUse::Listen), HasSubstr("brackets"));
  EXPECT_THAT(why_bad("ipc://", AddressUse::Listen), HasSubstr("no path"));
  EXPECT_THAT(why_bad("shm:///tmp/" + std::string(120, 'x'), AddressUse::Listen), HasSubstr("at most 107"));
  EXPECT_THAT(why_bad("tcp://\x1b[2J:1x", AddressUse::Listen), HasSubstr("\\x1b")) << "fit for a terminal";
}

TEST(Address, AHostIsTheSameNumberAtBothEnds) {
  for (const auto use : {AddressUse::Listen, AddressUse::Connect})
    EXPECT_EQ(to_endpoint(parse_address("tcp://localhost:7391", use)), "tcp://127.0.0.1:7391");
  EXPECT_EQ(to_endpoint(parse_address("tcp://[::1]:7391", AddressUse::Listen)), "tcp://[::1]:7391");
  EXPECT_THAT(get_message<BadAddress>([] { to_endpoint(parse_address("tcp://no.such.host.invalid:1", AddressUse::Connect)); }),
              HasSubstr("not known here"));
}

TEST(Address, OnlyAnAddressOfThisHostCanBeListenedAt) {
  EXPECT_NO_THROW(check_listening("tcp://localhost:0"));
  // 192.0.2.0/24 is for documentation (RFC 5737): no host has it
  EXPECT_THAT(get_message<BadAddress>([] { check_listening("tcp://192.0.2.1:7100"); }), HasSubstr("such as 127.0.0.1"));
  EXPECT_THAT(get_message<BadAddress>([] { check_listening("ipc:///no/such/folder/x"); }), HasSubstr("/no/such/folder"));
}

TEST(Address, AJoinOverNamesAndIPv6Works) {
  std::vector<std::string> hosts{"localhost"};
  if (has_ipv6()) hosts.push_back("[::1]");
  for (const std::string& host : hosts) {
    const auto coordinator = bind_zeromq("tcp://" + host + ":0", kWelcome, {{"ply_0", 30}});
    const std::string bound = get_endpoint(*coordinator);
    const auto solver = connect_zeromq("tcp://" + host + bound.substr(bound.rfind(':')));
    std::thread joining([&] { solver->join(make_join("ply_0"), kPatience); });
    EXPECT_EQ(coordinator->receive(kPatience).kind, Event::Kind::Joined) << host;
    joining.join();
  }
}

class ListeningPath : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = "/tmp/interply-listen-XXXXXX";
    folder_ = mkdtemp(path.data());
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path path() const { return folder_ / "link"; }
  void listen(const std::string& scheme = "ipc") const {
    bind_zeromq(scheme + "://" + path().string(), kWelcome, {{"ply_0", 30}});
  }
  /// A socket in the file system whose owner is gone.
  void leave_dead_socket() const {
    const int s = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::strcpy(name.sun_path, path().c_str());
    ASSERT_EQ(::bind(s, reinterpret_cast<const sockaddr*>(&name), sizeof(name)), 0);
    ::close(s);
  }
  fs::path folder_;
};

TEST_F(ListeningPath, AFileOrFolderOrLinkIsNeverTakenAway) {
  for (const std::string scheme : {"ipc", "shm"}) {
    std::ofstream(path()) << "a thesis";
    EXPECT_THAT(get_message<BadAddress>([&] { listen(scheme); }), HasSubstr("not a socket"));
    std::string text;
    std::getline(std::ifstream(path()), text);
    EXPECT_EQ(text, "a thesis");
    fs::rename(path(), folder_ / "thesis");
    fs::create_symlink(folder_ / "thesis", path());
    EXPECT_THAT(get_message<BadAddress>([&] { listen(scheme); }), HasSubstr("not a socket"));
    EXPECT_TRUE(fs::is_symlink(path()));
    fs::remove(path());
    fs::create_directory(path());
    EXPECT_THAT(get_message<BadAddress>([&] { listen(scheme); }), HasSubstr("not a socket"));
    fs::remove(path());
  }
}

TEST_F(ListeningPath, ADeadSocketIsReplacedAndALiveOneStays) {
  leave_dead_socket();
  const auto first = bind_zeromq("ipc://" + path().string(), kWelcome, {{"ply_0", 30}});
  EXPECT_THAT(get_message<std::runtime_error>([&] { listen(); }), HasSubstr("somebody else"));
  const auto solver = connect_zeromq("ipc://" + path().string());
  std::thread joining([&] { solver->join(make_join("ply_0"), kPatience); });
  EXPECT_EQ(first->receive(kPatience).kind, Event::Kind::Joined) << "the first one keeps its address";
  joining.join();
}

TEST_F(ListeningPath, TheSocketIsTheUsersAloneAndGoesWithItsOwner) {
  {
    const auto coordinator = bind_zeromq("shm://" + path().string(), kWelcome, {{"ply_0", 30}});
    EXPECT_EQ(fs::status(path()).permissions() & (fs::perms::group_all | fs::perms::others_all), fs::perms::none);
  }
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(ListeningPath, WhatTookThePlaceOfTheSocketStays) {
  auto coordinator = bind_zeromq("ipc://" + path().string(), kWelcome, {{"ply_0", 30}});
  fs::rename(path(), folder_ / "moved");
  std::ofstream(path()) << "a thesis";
  coordinator.reset();
  EXPECT_TRUE(fs::exists(path()));
}

TEST_F(ListeningPath, ANameIsNoFile) {
  const std::string address = "shm://@interply-test-" + std::to_string(::getpid());
  const auto coordinator = bind_zeromq(address, kWelcome, {{"ply_0", 30}});
  EXPECT_EQ(get_endpoint(*coordinator), address);
  EXPECT_FALSE(fs::exists(address.substr(6)));
  EXPECT_THAT(get_message<std::runtime_error>([&] { bind_zeromq(address, kWelcome, {{"ply_0", 30}}); }),
              HasSubstr("somebody else"));
  const auto solver = connect_zeromq(address);
  std::thread joining([&] { solver->join(make_join("ply_0"), kPatience); });
  EXPECT_EQ(coordinator->receive(kPatience).kind, Event::Kind::Joined);
  joining.join();
}

}  // namespace
}  // namespace interply::exchange
