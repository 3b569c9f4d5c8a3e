# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# The program in an image of its own: scripts/setup.sh, a build, `cmake --install`, as anywhere else. UNTESTED with Docker: none
# runs where this is developed. Its RUN lines were tried there in a bare Debian 12 (mmdebstrap), by hand.
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
