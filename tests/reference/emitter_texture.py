# tests/reference/emitter_texture.py -- lights, textures and normal maps of Mitsuba 3, with their derivatives
# SPDX-License-Identifier: Apache-2.0
"""Directions to a light are unit and in the world; textures are read at uv. Slopes by uv and texels are of the mixture
x + 2 y + 3 z of a colour."""
import drjit as dr
import mitsuba as mi
import numpy as np

import bsdf
from bsdf import stored, vector
from inputs import between, directions, uniform

COUNT = 4000


def sphere(stream):
    """Unit directions all around, float32, z away from 0 by nothing: from a box."""
    d = np.stack([2 * uniform(stream, COUNT, j) - 1 for j in range(3)], 1)
    return (d / np.sqrt(np.sum(d * d, 1))[:, None]).astype(np.float32)


def picture(stream, height, width, low=0.0, high=1.0):
    """height x width x 3 random texels; number c of point y width + x."""
    n = height * width
    return np.stack([between(stream, n, c, low, high) for c in range(3)], 1).reshape(height, width, 3)


def radiance(emitter, d):
    si = dr.zeros(mi.SurfaceInteraction3f, len(d))
    si.wi = -vector(d)
    return emitter.eval(si)


def smooth(u, v):
    """A radiance that has no pole and no seam, by its place in the panorama."""
    phi, theta = 2 * np.pi * u, np.pi * v
    return 1 + 0.5 * np.cos(theta) + 0.3 * np.sin(theta) * np.sin(phi) - 0.1 * np.sin(theta) * np.cos(phi)


def smooth_panorama(height, width, rows):
    u = (np.arange(width) + 0.5) / width
    return np.repeat(smooth(u[None, :], rows[:, None])[:, :, None], 3, 2).astype(np.float32)


def environments(out):
    def envmap(texels, **more):
        return mi.load_dict({"type": "envmap", "bitmap": mi.Bitmap(texels)} | more)

    d, noise = sphere(21), picture(20, 16, 32, 0.1, 1)
    out["envmap_value"] = (stored(radiance(envmap(noise), d)), 1e-4)
    turn = mi.ScalarTransform4f().rotate([0, 1, 0], 70)
    out["envmap_turned_value"] = (stored(radiance(envmap(noise, to_world=turn), d).y), 1e-4)
    # Rows lie at v = j / (H - 1): the smooth radiance sampled there, and sampled as for rows at v = (j + .5) / H.
    aligned, centred = np.arange(32) / 31, (np.arange(32) + 0.5) / 32
    out["envmap_smooth_aligned"] = (stored(radiance(envmap(smooth_panorama(32, 64, aligned)), d).x), 1e-5)
    out["envmap_smooth_centred"] = (stored(radiance(envmap(smooth_panorama(32, 64, centred)), d).x), 1e-5)
    constant = mi.load_dict({"type": "constant", "radiance": {"type": "rgb", "value": [0.25, 0.5, 2.0]}})
    out["constant_value"] = (stored(radiance(constant, d))[:100], 1e-6)


def directionals(out):
    """8 lights on 125 diffuse surfaces each: reflected radiance, and its slope by the irradiance."""
    normal, value, slope = sphere(25)[:1000], [], []
    for k in range(8):
        e = [between(26, 8, j, 0.2, 3)[k] for j in range(3)]
        rho = [between(26, 8, 3 + j, 0.1, 0.9)[k] for j in range(3)]
        travels = sphere(27)[k]
        light = mi.load_dict({"type": "directional", "direction": [float(x) for x in travels],
                              "irradiance": {"type": "rgb", "value": [float(x) for x in e]}})
        diffuse = mi.load_dict({"type": "diffuse", "reflectance": {"type": "rgb", "value": [float(x) for x in rho]}})
        params = mi.traverse(light)
        dr.enable_grad(params["irradiance.value"])
        params.update()
        si = dr.zeros(mi.SurfaceInteraction3f, 125)
        si.n = vector(normal[125 * k:125 * k + 125])
        si.sh_frame = mi.Frame3f(mi.Vector3f(si.n))
        si.wi = mi.Vector3f(0, 0, 1)
        ds, weight = light.sample_direction(si, mi.Point2f(0.5, 0.5))
        y = weight * diffuse.eval(mi.BSDFContext(), si, si.to_local(ds.d))
        dr.backward(y)
        value.append(np.array(dr.detach(y)).T)
        slope.append(np.array(dr.grad(params["irradiance.value"])).ravel())
    out["directional_value"] = (np.float32(np.concatenate(value)), 1e-5)
    out["directional_by_irradiance"] = (np.float32(slope), 1e-5)


def textures(out):
    texels = picture(22, 5, 7)
    weight = between(23, COUNT, 2, 0.5, 1.5)
    for mode in ("repeat", "mirror", "clamp"):
        bitmap = mi.load_dict({"type": "bitmap", "data": mi.TensorXf(texels), "raw": True, "wrap_mode": mode})
        params = mi.traverse(bitmap)
        data = mi.TensorXf(texels)
        uv = mi.Point2f(between(23, COUNT, 0, -1.5, 2.5), between(23, COUNT, 1, -1.5, 2.5))
        dr.enable_grad(uv)
        si = dr.zeros(mi.SurfaceInteraction3f, COUNT)
        mixture = lambda c: c.x + 2 * c.y + 3 * c.z
        name = f"bitmap_{mode}"
        si.uv = uv
        y = bitmap.eval_3(si)
        dr.backward(mixture(y))
        out[f"{name}_value"] = (stored(y), 1e-4)
        out[f"{name}_by_uv"] = (stored(dr.grad(uv)), 1e-4)
        dr.enable_grad(data)
        params["data"] = data
        params.update()
        si.uv = dr.detach(uv)
        dr.backward(dr.sum(mixture(bitmap.eval_3(si)) * mi.Float(weight)))
        out[f"{name}_by_texels"] = (np.float32(dr.grad(data).numpy()), 1e-4)


def normal_maps(out):
    """Half a mirror of alpha 0.3 and a diffuse surface of 0.5 under a normal map: value, and slope by the colour that
    codes the normal. Flipping of normals that look away, and the shadowing that Mitsuba adds of its own, are off."""
    v, l = directions(24, bsdf.COUNT, 0.3)
    p = bsdf.numbers(24, normalmap=(8, 0.25, 0.75, 3))
    p["normalmap"].z = mi.Float(between(24, bsdf.COUNT, 10, 0.7, 1))
    for name, nested in {"ggx": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.3},
                         "diffuse": {"type": "diffuse"}}.items():
        b = mi.load_dict({"type": "normalmap", "normalmap": bsdf.image(3), "nested": nested,
                          "flip_invalid_normals": False, "use_shadowing_function": False})
        evaluate, more = bsdf.evaluated(b, v, l), {}
        bsdf.differentiated(more, f"normalmap_{name}", lambda given: evaluate(given).x, p)
        for key, (array, tolerance) in more.items():
            out[key.replace("_by_normalmap", "_by_color")] = (array[:COUNT], tolerance)


def arrays():
    out = {}
    for make in (environments, directionals, textures, normal_maps):
        before = len(out)
        make(out)
        print(f"emitter_texture: {make.__name__}, {len(out) - before} arrays", flush=True)
    return out
