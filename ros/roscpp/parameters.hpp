// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The configuration of the node from its private parameters.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include "node/node_config.hpp"

namespace edged::ros1 {

/// Sets what `parameters`, the tree of the private ones, holds; `~options/packets/max_interval_s` is the option
/// packets.max_interval_s. Throws InputError that names the parameter, with the nearest known one for a typing error.
void set_parameters(node::NodeConfig& config, XmlRpc::XmlRpcValue parameters);

}  // namespace edged::ros1
