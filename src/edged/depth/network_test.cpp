// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Networks through cv::dnn against what torch computed (tools/depth/make_test_models.py), and the errors for bad files.
#include "edged/depth/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

const fs::path kData = fs::path(EDGED_SOURCE_DIR) / "src/edged/depth/testdata";

/// As fixed_grid of make_test_models.py.
cv::Mat fixed_grid(int step, int height = 16, int width = 24) {
  cv::Mat grid(std::vector<int>{1, 5, height, width}, CV_32FC1, cv::Scalar(0));
  float* voxel = grid.ptr<float>();
  for (int b = 0; b < 5; ++b)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x, ++voxel)
        if ((b + x + y) % 3 != 0) *voxel = static_cast<float>(std::sin(0.7 * b + 0.3 * y + 0.5 * x + step));
  return grid;
}

std::vector<std::vector<double>> expected_of(const std::string& name) {
  std::ifstream file(kData / (name + ".json"));
  return nlohmann::json::parse(file).at("expected").get<std::vector<std::vector<double>>>();
}

/// Largest difference of the normalised log depth from torch's, on the recorded pixels.
double difference(const cv::Mat& depth, const DepthModel& model, const std::vector<double>& expected) {
  double worst = 0.0;
  std::size_t i = 0;
  for (int y = 0; y < depth.rows; y += 5)
    for (int x = 0; x < depth.cols; x += 7) {
      const double output = 1.0 + std::log(depth.at<float>(y, x) / model.d_max_m) / model.alpha;
      worst = std::max(worst, std::abs(output - expected.at(i++)));
    }
  EXPECT_EQ(i, expected.size());
  return worst;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(DepthNetwork, AgreesWithTorch) {
  DepthNetwork network(kData / "tiny.onnx");
  const auto expected = expected_of("tiny");
  for (int step : {0, 1, 2, 0})
    EXPECT_LT(difference(network.infer(fixed_grid(step)), network.model(), expected[static_cast<std::size_t>(step)]),
              2e-6);
}

TEST(DepthNetwork, CarriesItsStateAsTorchDoes) {
  // A ConvLSTM in all of three encoders, and in the deepest one only; each has two states.
  for (const auto& [name, states] : {std::pair("tiny_recurrent", 6U), std::pair("tiny_deep", 2U)}) {
    DepthNetwork network(kData / (std::string(name) + ".onnx"));
    ASSERT_EQ(network.model().states.size(), states);
    const auto expected = expected_of(name);
    for (int round = 0; round < 2; ++round) {
      for (std::size_t step = 0; step < 3; ++step)
        EXPECT_LT(difference(network.infer(fixed_grid(static_cast<int>(step))), network.model(), expected[step]), 2e-6)
            << name << ", round " << round << ", step " << step;
      network.reset();
    }
    EXPECT_GT(difference(network.infer(fixed_grid(1)), network.model(), expected[1]), 1e-4) << name << " without past";
  }
}

TEST(DepthNetwork, StartsAfreshWhenTheSizeChanges) {
  DepthNetwork network(kData / "tiny_recurrent.onnx");
  network.infer(fixed_grid(2, 32, 40));
  EXPECT_LT(difference(network.infer(fixed_grid(0)), network.model(), expected_of("tiny_recurrent")[0]), 2e-6);
}

TEST(DepthNetwork, GivesADepthForEveryPixelOfAnySize) {
  DepthNetwork network(kData / "tiny.onnx");
  const cv::Mat depth = network.infer(fixed_grid(0, 90, 122));
  EXPECT_EQ(depth.size(), cv::Size(122, 90));
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(depth, &low, &high);
  EXPECT_GT(low, 10.0 * std::exp(-3.70378));
  EXPECT_LT(high, 10.0);
}

TEST(DepthNetwork, GivesTheSameBitsAgain) {
  DepthNetwork a(kData / "tiny.onnx"), b(kData / "tiny.onnx");
  const cv::Mat first = a.infer(fixed_grid(1, 90, 122));
  EXPECT_EQ(cv::norm(first, b.infer(fixed_grid(1, 90, 122)), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(first, a.infer(fixed_grid(1, 90, 122)), cv::NORM_INF), 0.0);
}

/// A folder with a copy of the tiny model, to be changed or damaged.
class ChangedModel : public ::testing::Test {
 protected:
  ChangedModel()
      : folder_(fs::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    for (const char* file : {"tiny.onnx", "tiny.json"}) fs::copy_file(kData / file, folder_ / file);
  }
  ~ChangedModel() override { fs::remove_all(folder_); }

  void change(const std::string& key, const nlohmann::json& value) const {
    std::ifstream in(folder_ / "tiny.json");
    nlohmann::json json = nlohmann::json::parse(in);
    json[key] = value;
    std::ofstream(folder_ / "tiny.json") << json;
  }
  std::string load() const {
    return message_of([this] { DepthNetwork network(folder_ / "tiny.onnx"); });
  }
  fs::path folder_;
};

TEST_F(ChangedModel, ThatShrinksSeesTheMeansOfBlocks) {
  const cv::Mat small = fixed_grid(1);
  cv::Mat large(std::vector<int>{1, 5, 32, 48}, CV_32FC1);
  for (int b = 0; b < 5; ++b)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x) large.ptr<float>(0, b, y)[x] = small.ptr<float>(0, b, y / 2)[x / 2];
  DepthNetwork plain(folder_ / "tiny.onnx");
  change("shrink", 2);
  DepthNetwork shrunk(folder_ / "tiny.onnx");
  const cv::Mat want = plain.infer(small), depth = shrunk.infer(large);
  ASSERT_EQ(depth.size(), cv::Size(48, 32));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 48; ++x) ASSERT_EQ(depth.at<float>(y, x), want.at<float>(y / 2, x / 2));
}

TEST_F(ChangedModel, ThatIsMissingIsNamed) {
  fs::remove(folder_ / "tiny.onnx");
  EXPECT_THAT(load(), ::testing::HasSubstr("tiny.onnx: there is no such file"));
}

TEST_F(ChangedModel, WithoutItsJsonIsRefused) {
  fs::remove(folder_ / "tiny.json");
  EXPECT_THAT(load(), ::testing::HasSubstr("tiny.json: cannot be read"));
}

TEST_F(ChangedModel, WithBadJsonIsRefused) {
  std::ofstream(folder_ / "tiny.json") << "{ \"name\": ";
  EXPECT_THAT(load(), ::testing::HasSubstr("tiny.json"));
}

TEST_F(ChangedModel, WithoutAKeyIsRefused) {
  std::ofstream(folder_ / "tiny.json") << R"({"name": "x", "bins": 5, "multiple": 8, "alpha": 3.7})";
  EXPECT_THAT(load(), ::testing::HasSubstr("d_max_m"));
}

TEST_F(ChangedModel, WithAValueOutOfRangeIsRefused) {
  change("alpha", -1.0);
  EXPECT_THAT(load(), ::testing::HasSubstr("'alpha' is out of range"));
}

TEST_F(ChangedModel, OfAnotherNumberOfBinsIsRefused) {
  change("bins", 10);
  EXPECT_THAT(load(), ::testing::HasSubstr("cannot be used as a depth network"));
}

TEST_F(ChangedModel, WithAStateThatIsNotThereIsRefused) {
  change("states", {{{"name", "h1"}, {"channels", 2}, {"divisor", 2}}});
  EXPECT_THAT(load(), ::testing::HasSubstr("cannot be used as a depth network"));
}

TEST_F(ChangedModel, ThatIsCutShortOrNoiseIsRefused) {
  fs::resize_file(folder_ / "tiny.onnx", 9000);
  EXPECT_THAT(load(), ::testing::HasSubstr("tiny.onnx: cannot be used as a depth network"));
  std::ofstream(folder_ / "tiny.onnx", std::ios::binary) << std::string(500, 'x');
  EXPECT_THAT(load(), ::testing::HasSubstr("tiny.onnx: cannot be used as a depth network"));
  std::ofstream(folder_ / "tiny.onnx", std::ios::binary) << "";
  EXPECT_THAT(load(), ::testing::HasSubstr("tiny.onnx: cannot be used as a depth network"));
}

TEST(DepthModels, AreFoundByPathOrListedByName) {
  EXPECT_EQ(find_depth_model("/some/where.onnx"), fs::path("/some/where.onnx"));
  EXPECT_THAT(message_of([] { find_depth_model("nonsense"); }), ::testing::HasSubstr("no depth model 'nonsense'"));
}

}  // namespace
}  // namespace edged
