#include "stats/base/picture_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "tests/apps/process.hpp"

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

TEST(PictureSize, IsTwoNumbersWithNothingAround) {
  const auto size = base::parse_picture_size("1280x720");
  EXPECT_EQ(size.width, 1280);
  EXPECT_EQ(size.height, 720);
  EXPECT_NO_THROW(base::parse_picture_size("16x8192"));
  EXPECT_NO_THROW(base::parse_picture_size("8192x4096"));
  for (const std::string text :
       {"", "x", "640", "640x", "x360", "640x360x3", " 640x360", "640x360 ", "640 x360", "+640x360", "-5x0",
        "15x360", "640x8193", "0x0", "1e3x360", "99999999999x16"}) {
    EXPECT_THAT([&] { base::parse_picture_size(text, "--pictures"); },
                ThrowsMessage<base::Error>(AllOf(StartsWith("--pictures " + text + ": "),
                                                 HasSubstr("is not a size"), HasSubstr("mend: "))));
  }
}

TEST(PictureSize, OneThatTakesTooMuchMemorySaysHowMuch) {
  EXPECT_THAT([] { base::parse_picture_size("8192x8192"); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr("2.7 GB of memory"), HasSubstr("8192x4096"))));
}

TEST(PictureSizeE2e, EveryProgramRefusesTheSame) {
  const std::string bin = VIP_BIN_DIR "/";
  for (const std::string command :
       {"vip-view --headless data/scenes/peers_dam.toml --n-star 64 --size ",
        "vip-bench frame data/scenes/peers_dam.toml --n-star 64 --size ",
        "vip-study bake data/scenes/peers_dam.toml --n-star 64 --out /dev/shm/never.bake --pictures ",
        "vip-study run protocols/demo.toml --db /dev/shm/never.db --observer random --size "}) {
    for (const char* size : {"-5x0", "8192x8192"}) {
      const auto ended = apps::test::run_shell(bin + command + size);
      EXPECT_EQ(ended.exit_code, 1) << command << size << ended.out;
      EXPECT_THAT(ended.out, AllOf(HasSubstr(size), HasSubstr("mend: ")));
    }
  }
}

}  // namespace
