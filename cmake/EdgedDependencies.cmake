# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# What edged::edged needs, here and where it is installed. Every library comes from Debian 12; scripts/setup.sh installs
# them.
find_package(Eigen3 3.4 REQUIRED)
set(edged_opencv core imgproc video features2d calib3d)
if(EDGED_DEPTH_NETWORK)
  list(APPEND edged_opencv dnn)
endif()
find_package(OpenCV 4.5 REQUIRED COMPONENTS ${edged_opencv})
find_package(Ceres 2.0 REQUIRED)
find_package(opengv REQUIRED)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(spdlog 1.9 REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)
find_package(Threads REQUIRED)
