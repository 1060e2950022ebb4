// burnish/burnish.h -- everything that needs no third party
// SPDX-License-Identifier: Apache-2.0
//
// Left out: burnish/scene/raycast.h, which needs Embree, and burnish/io/, which needs OpenImageIO and Assimp.
#pragma once
#include <burnish/ad/check.h>
#include <burnish/ad/compiled.h>
#include <burnish/ad/differentiate.h>
#include <burnish/ad/dual.h>
#include <burnish/ad/environment.h>
#include <burnish/ad/model.h>
#include <burnish/ad/number.h>
#include <burnish/ad/operation.h>
#include <burnish/ad/packet.h>
#include <burnish/ad/parallel.h>
#include <burnish/ad/plan.h>
#include <burnish/ad/recording.h>
#include <burnish/ad/repeat.h>
#include <burnish/ad/replay.h>
#include <burnish/ad/tape.h>
#include <burnish/math/color.h>
#include <burnish/math/frame.h>
#include <burnish/math/noise.h>
#include <burnish/math/sh.h>
#include <burnish/math/smooth.h>
#include <burnish/math/vec.h>
#include <burnish/nodes/surface.h>
#include <burnish/scene/camera.h>
#include <burnish/scene/clean.h>
#include <burnish/scene/error.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/scene/image.h>
#include <burnish/scene/mesh.h>
#include <burnish/scene/vehicle.h>
#include <burnish/shade/brdf.h>
#include <burnish/shade/coat.h>
#include <burnish/shade/diffuse.h>
#include <burnish/shade/fresnel.h>
#include <burnish/shade/ggx.h>
#include <burnish/light/environment.h>
#include <burnish/light/illuminate.h>
#include <burnish/light/pyramid.h>
#include <burnish/light/rings.h>
#include <burnish/light/sun.h>
#include <burnish/light/transport.h>
#include <burnish/fit/planes.h>
#include <burnish/fit/render.h>
#include <burnish/version.h>
