// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The depth sources: their measurements, their region, and their fusion.
#include "edged/options/depth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"
#include "edged/depth/fused_depth.hpp"
#include "edged/depth/make_depth_prior.hpp"
#include "edged/events/voxel_grid.hpp"

namespace edged {
namespace {

const CameraModel kCamera(240, 180, 200.0, 200.0, 119.5, 89.5);
const std::string kModel = std::string(EDGED_SOURCE_DIR) + "/src/edged/depth/testdata/tiny.onnx";

Timestamp at_ms(double ms) { return timestamp_from_seconds(1e-3 * ms); }

DepthConfig config_of(DepthSource source) {
  DepthConfig config;
  config.source = source;
  config.network.model = kModel;
  return config;
}

SeenDepth seen(double x_px, double y_px, double depth) {
  return {Eigen::Vector2d((x_px - 119.5) / 200.0, (y_px - 89.5) / 200.0), depth};
}

/// Five times the given depths, within the region.
std::vector<SeenDepth> landmarks(std::initializer_list<double> depths) {
  std::vector<SeenDepth> all;
  for (int i = 0; i < 5; ++i)
    for (const double d : depths) all.push_back(seen(100 + 5 * i, 80, d));
  return all;
}

/// Events all over the image, `per_ms` a millisecond, from begin_ms on.
std::vector<Event> events_between(int begin_ms, int end_ms, int per_ms = 60) {
  std::vector<Event> events;
  std::uint32_t state = 12345U + static_cast<std::uint32_t>(begin_ms);
  for (int ms = begin_ms; ms < end_ms; ++ms)
    for (int i = 0; i < per_ms; ++i) {
      state = 1664525U * state + 1013904223U;
      events.push_back({at_ms(ms), static_cast<std::uint16_t>((state >> 8) % 240),
                        static_cast<std::uint16_t>((state >> 20) % 180), (state >> 31) != 0U});
    }
  return events;
}

TEST(ConstantDepthPrior, IsAlwaysThere) {
  DepthConfig config = config_of(DepthSource::Constant);
  config.constant_m = 3.5;
  const auto prior = make_depth_prior(config, kCamera);
  EXPECT_EQ(prior->at(at_ms(0))->depth_m, 3.5);
  EXPECT_EQ(prior->at(at_ms(1e6))->t, at_ms(1e6));
}

TEST(LandmarkDepthPrior, IsTheMedianWithinTheCentralRegion) {
  const auto prior = make_depth_prior(config_of(DepthSource::Landmarks), kCamera);
  EXPECT_FALSE(prior->at(at_ms(0)));
  std::vector<SeenDepth> all = landmarks({2.0, 3.0, 40.0});
  for (int i = 0; i < 100; ++i) all.push_back(seen(40, 80, 9.0));  // left of the region, which begins at 60 px
  for (int i = 0; i < 100; ++i) all.push_back(seen(120, 20, 9.0));
  prior->add_landmarks(at_ms(10), all);
  ASSERT_TRUE(prior->at(at_ms(10)));
  EXPECT_NEAR(prior->at(at_ms(10))->depth_m, 3.0, 1e-9);
  EXPECT_EQ(prior->at(at_ms(20))->t, at_ms(10));
}

TEST(LandmarkDepthPrior, WantsEnoughLandmarks) {
  const auto prior = make_depth_prior(config_of(DepthSource::Landmarks), kCamera);
  const std::vector<SeenDepth> all = landmarks({2.0});
  prior->add_landmarks(at_ms(10), std::span(all).first(4));
  EXPECT_FALSE(prior->at(at_ms(10)));
  prior->add_landmarks(at_ms(20), all);
  EXPECT_TRUE(prior->at(at_ms(20)));
}

TEST(LandmarkDepthPrior, IsLessSureOfAScatteredScene) {
  const auto flat = make_depth_prior(config_of(DepthSource::Landmarks), kCamera);
  const auto deep = make_depth_prior(config_of(DepthSource::Landmarks), kCamera);
  flat->add_landmarks(at_ms(0), landmarks({2.0, 2.0, 2.0}));
  deep->add_landmarks(at_ms(0), landmarks({1.0, 2.0, 4.0}));
  EXPECT_GT(deep->at(at_ms(0))->sigma_ln, 2.0 * flat->at(at_ms(0))->sigma_ln);
  EXPECT_NEAR(deep->at(at_ms(0))->spread_ln, 1.4826 * std::log(2.0), 1e-9);
}

TEST(NetworkDepthPrior, MeasuresAtTheEndOfEachWindow) {
  const DepthConfig config = config_of(DepthSource::Network);
  NetworkDepth prior(kCamera, config.region_share, config.network, config.filter);
  prior.add_events(events_between(0, 50));
  EXPECT_EQ(prior.inferences(), 0);
  EXPECT_FALSE(prior.at(at_ms(49)));
  prior.add_events(events_between(50, 160));
  EXPECT_EQ(prior.inferences(), 3);
  ASSERT_TRUE(prior.at(at_ms(160)));
  EXPECT_EQ(prior.at(at_ms(160))->t, at_ms(149)) << "the stamp is that of the events";
  EXPECT_EQ(prior.at(at_ms(149))->sigma_ln, prior.model().sigma_ln);
  EXPECT_GT(prior.measured()->depth_m, 0.2);
  EXPECT_LT(prior.measured()->depth_m, 10.0);
}

TEST(NetworkDepthPrior, DoesNotDependOnHowItsEventsArePackaged) {
  const DepthConfig config = config_of(DepthSource::Network);
  NetworkDepth one(kCamera, config.region_share, config.network, config.filter);
  NetworkDepth many(kCamera, config.region_share, config.network, config.filter);
  const std::vector<Event> events = events_between(0, 200);
  one.add_events(events);
  for (std::size_t i = 0; i < events.size(); i += 7)
    many.add_events(std::span(events).subspan(i, std::min<std::size_t>(7, events.size() - i)));
  EXPECT_EQ(one.at(at_ms(200))->depth_m, many.at(at_ms(200))->depth_m);
  EXPECT_EQ(one.inferences(), many.inferences());
}

TEST(NetworkDepthPrior, InItsOwnThreadMeasuresTheSameWhenThereIsTime) {
  const DepthConfig config = config_of(DepthSource::Network);
  NetworkDepth here(kCamera, config.region_share, config.network, config.filter);
  NetworkDepth there(kCamera, config.region_share, config.network, config.filter, Inference::OwnThread);
  for (int ms = 0; ms < 400; ms += 25) {
    here.add_events(events_between(ms, ms + 25));
    there.add_events(events_between(ms, ms + 25));
    there.finish();
  }
  EXPECT_EQ(there.inferences(), here.inferences());
  EXPECT_EQ(there.at(at_ms(400))->depth_m, here.at(at_ms(400))->depth_m);
  EXPECT_EQ(there.at(at_ms(400))->t, here.at(at_ms(400))->t) << "the stamp is that of the events";
}

TEST(NetworkDepthPrior, InItsOwnThreadNeverMakesItsCallerWait) {
  const DepthConfig config = config_of(DepthSource::Network);
  NetworkDepth prior(kCamera, config.region_share, config.network, config.filter, Inference::OwnThread);
  prior.add_events(events_between(0, 3000));  // sixty windows at once
  prior.finish();
  EXPECT_GE(prior.inferences(), 1);
  EXPECT_LE(prior.inferences(), 59);
  EXPECT_EQ(prior.at(at_ms(3000))->t, at_ms(2949)) << "the newest window is never skipped";
}

TEST(NetworkDepthPrior, TakesTheMeanOfTheRegionWhenAsked) {
  DepthConfig config = config_of(DepthSource::Network);
  config.network.region_value = RegionValue::Mean;
  config.network.margin_px = 0;
  NetworkDepth prior(kCamera, 1.0, config.network, config.filter);  // the region is the image
  const std::vector<Event> events = events_between(0, 50);
  prior.add_events(events);
  prior.add_events(events_between(50, 51));
  cv::Mat grid = voxel_grid(events, cv::Rect(0, 0, 240, 180), prior.model().bins);
  normalise_voxels(grid);
  DepthNetwork network(kModel);
  const double scale = prior.model().focal_px > 0.0 ? kCamera.mean_focal() / prior.model().focal_px : 1.0;
  ASSERT_TRUE(prior.measured());
  EXPECT_NEAR(prior.measured()->depth_m, scale * cv::mean(network.infer(grid))[0], 1e-6);
}

TEST(NetworkDepthPrior, SaysNothingOfAQuietWindow) {
  const DepthConfig config = config_of(DepthSource::Network);
  NetworkDepth prior(kCamera, config.region_share, config.network, config.filter);
  prior.add_events(events_between(0, 200, 5));
  EXPECT_EQ(prior.inferences(), 0);
  EXPECT_FALSE(prior.at(at_ms(200)));
}

TEST(NetworkDepthPrior, WantsAnImageLargeEnough) {
  DepthConfig config = config_of(DepthSource::Network);
  config.network.margin_px = 0;
  EXPECT_THROW(make_depth_prior(config, CameraModel(12, 12, 10, 10, 5.5, 5.5)), InputError);
}

TEST(NetworkDepthPrior, RunsTheModelsThatShip) {
  for (const char* model : {"small", "small_recurrent"}) {
    DepthConfig config;
    config.source = DepthSource::Network;
    config.network.model = model;
    const auto prior = make_depth_prior(config, kCamera);
    prior->add_events(events_between(0, 120));
    ASSERT_TRUE(prior->at(at_ms(120))) << model;
    EXPECT_GT(prior->at(at_ms(120))->depth_m, 0.24) << model;
    EXPECT_LT(prior->at(at_ms(120))->depth_m, 12.1) << model;
  }
}

TEST(ScaleEstimate, LearnsARatioAndWithstandsOutliers) {
  ScaleEstimate scale;
  for (int i = 0; i < 100; ++i) {
    scale.update(at_ms(50.0 * i), std::log(2.0));
    if (i % 10 == 9) scale.update(at_ms(50.0 * i), std::log(50.0));
  }
  EXPECT_NEAR(scale.ln_scale(), std::log(2.0), 0.08);
  EXPECT_LT(scale.sigma(), 0.2);
}

TEST(ScaleEstimate, ForgetsSlowly) {
  ScaleEstimate scale;
  for (int i = 0; i < 400; ++i) scale.update(at_ms(50.0 * i), 0.7);
  for (int i = 400; i < 800; ++i) scale.update(at_ms(50.0 * i), -0.3);
  EXPECT_NEAR(scale.ln_scale(), -0.3, 0.05);
}

TEST(FusedDepthPrior, FallsBackFromLandmarksToScaledNetworkToConstant) {
  DepthConfig config = config_of(DepthSource::Fused);
  config.constant_m = 1.7;
  const auto prior = make_depth_prior(config, kCamera);
  const auto alone = make_depth_prior(config_of(DepthSource::Network), kCamera);
  EXPECT_EQ(prior->at(at_ms(0))->depth_m, 1.7);
  for (int i = 0; i < 60; ++i) {
    const std::vector<Event> events = events_between(50 * i, 50 * i + 50);
    alone->add_events(events), prior->add_events(events);
    prior->add_landmarks(at_ms(50 * i), landmarks({6.0}));
  }
  EXPECT_NEAR(prior->at(at_ms(3000))->depth_m, 6.0, 0.1);
  for (int i = 60; i < 100; ++i) {
    const std::vector<Event> events = events_between(50 * i, 50 * i + 50);
    alone->add_events(events), prior->add_events(events);
  }
  const double network = alone->at(at_ms(5000))->depth_m, scaled = prior->at(at_ms(5000))->depth_m;
  EXPECT_NEAR(std::log(scaled), std::log(6.0), 0.3 * std::abs(std::log(network / 6.0))) << "network alone " << network;
  EXPECT_EQ(prior->at(at_ms(9000))->depth_m, 1.7);
}

TEST(DepthPriorOptions, AreListedAndParsed) {
  DepthConfig config;
  ConfigFields fields = ConfigFields::of(config);
  fields.set("source=fused");
  fields.set("network.margin_px=8");
  EXPECT_EQ(config.source, DepthSource::Fused);
  EXPECT_EQ(config.network.margin_px, 8);
  EXPECT_THROW(fields.set("region_share=0"), InputError);
}

TEST(DepthPriorOptions, RefuseAModelThatIsNotThere) {
  DepthConfig config = config_of(DepthSource::Network);
  config.network.model = "/nowhere/model.onnx";
  EXPECT_THROW(make_depth_prior(config, kCamera), InputError);
}

}  // namespace
}  // namespace edged
