# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# The program in an image of its own: scripts/setup.sh, a build, `cmake --install`, as anywhere else. UNTESTED as a whole: no
# Docker runs where this is developed; there scripts/test_packages.sh tries the same in a bare Debian 12.
#   docker build -t edged .
#   docker run --rm -v "$PWD:/work" edged run sim:room:1
FROM debian:bookworm
COPY scripts/setup.sh /tmp/
RUN /tmp/setup.sh && rm -rf /var/lib/apt/lists/*
COPY . /src
RUN cd /src \
 && cmake --preset release -DEDGED_TESTS=OFF -DEDGED_BENCH=OFF \
 && cmake --build --preset release \
 && cmake --install build/release \
 && rm -rf /src
WORKDIR /work
ENTRYPOINT ["edged"]
