// burnish/burnish.h -- everything that needs no third party
// SPDX-License-Identifier: Apache-2.0
//
// Left out: burnish/scene/raycast.h, which needs Embree, and burnish/io/, which needs OpenImageIO and Assimp.
#pragma once
#include <burnish/ad/model.h>
#include <burnish/ad/number.h>
#include <burnish/ad/operation.h>
#include <burnish/ad/packet.h>
#include <burnish/math/noise.h>
#include <burnish/math/vec.h>
#include <burnish/scene/camera.h>
#include <burnish/scene/clean.h>
#include <burnish/scene/error.h>
#include <burnish/scene/gbuffer.h>
#include <burnish/scene/image.h>
#include <burnish/scene/mesh.h>
#include <burnish/scene/vehicle.h>
#include <burnish/version.h>
