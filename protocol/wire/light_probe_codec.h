#pragma once
// A light probe on the wire: a page of its own, with reflections as differences of neighbours.

#include "protocol/base/result.h"
#include "protocol/impostor/light_probe.h"
#include "protocol/wire/message.h"

namespace mirage {

/// Returns the page that a client is sent, as a whole message.
Bytes encode_probe(const LightProbe& probe);
/// Decodes a page. Errors kWireMalformed, kWireValue: the payload is no map, or not the map of this
/// id.
Result<LightProbe> decode_probe(const wire::LightProbePageT& page, const Bytes& payload);

}  // namespace mirage
