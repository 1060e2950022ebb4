# tests/reference/insertion.py -- a grey ball and a cube on grey ground under a sky with a sun, by Mitsuba's path tracer
# SPDX-License-Identifier: Apache-2.0
"""The ground of burnish's path tracer has no albedo: it looks as the panorama's lower half does. Here it is a diffuse
plane of albedo GROUND; the radiance that it has in the open, GROUND E / pi, is what burnish is given as lower half.

On the object burnish counts light that comes straight or off the ground in its shadow: paths of 3 edges here. On the
ground it counts that, and what the object so throws back: 4 edges. Pictures are means of PASSES renderings with the
standard error of that mean beside them."""
import mitsuba as mi
import numpy as np

WIDTH, HEIGHT = 64, 48
EYE, TARGET, FOV = (2.1, 1.9, 3.1), (0.05, 0.3, 0.0), 46
ALBEDO, GROUND = 0.5, 0.25
SUN, SUN_WIDTH, SUN_RADIANCE = np.array([0.55, 0.62, 0.56]), 0.05, 60.0
ROWS = 513  # the middle row lies on the horizon
PASSES, SAMPLES = 8, 4096


def sky(d):
    """Radiance above the horizon from unit directions (..., 3)."""
    sun = SUN / np.linalg.norm(SUN)
    angle = np.arccos(np.clip(d @ sun, -1, 1))
    grey = 0.5 + 0.3 * d[..., 0] + 0.4 * np.maximum(d[..., 1], 0)
    bright = SUN_RADIANCE * np.exp(-0.5 * (angle / SUN_WIDTH) ** 2)
    return np.stack([0.8 * grey + bright, grey + 0.95 * bright, 1.3 * grey + 0.8 * bright], -1)


def panorama():
    """Mitsuba's texels: columns have their centres at (i + .5) / W, rows lie from pole to pole; u = 0 looks to -z."""
    u, v = (np.arange(2 * ROWS) + 0.5) / (2 * ROWS), np.arange(ROWS) / (ROWS - 1)
    phi, theta = 2 * np.pi * u[None, :], np.pi * v[:, None]
    d = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi, -np.sin(theta) * np.cos(phi)], -1)
    return np.where(d[..., 1:2] >= -1e-9, sky(d), 0).astype(np.float32)


def scene(shape):
    grey = {"type": "diffuse", "reflectance": {"type": "rgb", "value": ALBEDO}}
    t = mi.ScalarTransform4f
    objects = {
        "ball": {"type": "sphere", "center": [0, 0.5, 0], "radius": 0.5, "bsdf": grey},
        "cube": {"type": "cube", "to_world": t().translate([0, 0.4, 0]).rotate([0, 1, 0], 30).scale(0.4), "bsdf": grey},
    }
    more = {shape: objects[shape]} if shape else {}
    return mi.load_dict({
        "type": "scene",
        "ground": {"type": "rectangle", "to_world": t().rotate([1, 0, 0], -90).scale(200),
                   "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": GROUND}}},
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(panorama())},
        "sensor": {"type": "perspective", "fov": FOV, "fov_axis": "x",
                   "to_world": t().look_at(EYE, TARGET, (0, 1, 0)),
                   "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"},
                            "pixel_format": "rgb", "component_format": "float32"},
                   "sampler": {"type": "independent"}},
        **more})


def mean(the_scene, depth):
    shots = [np.array(mi.render(the_scene, integrator=mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 99}),
                                spp=SAMPLES, seed=17 * k + depth)) for k in range(PASSES)]
    return np.mean(shots, 0), np.std(shots, 0, ddof=1) / np.sqrt(PASSES)


def arrays():
    out = {}
    # The open ground: its radiance, the same everywhere.
    empty, error = mean(scene(None), 2)
    out["insertion_open"] = (empty.mean((0, 1)).astype(np.float32), 2e-3)
    for shape in ["ball", "cube"]:
        the_scene = scene(shape)
        for what, depth in [("object", 3), ("ground", 4)]:
            picture, error = mean(the_scene, depth)
            out[f"insertion_{shape}_{what}"] = (picture.astype(np.float16), 3e-2)
            print(f"  {shape} {what}: standard error {error.mean() / picture.mean():.1e} of the mean")
    return out
