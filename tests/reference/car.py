# tests/reference/car.py -- a low-poly car of our own on a plate, and the camera that looks at it
# SPDX-License-Identifier: Apache-2.0
"""Metres, +Y up, front faces counter-clockwise, normals outwards. Four parts: body, windows, wheels, ground. Body and
windows are superellipsoids (Barr 1981) with their own normals; the wheels are prisms that sink into the ground."""
import numpy as np

PARTS = ["body", "windows", "wheels", "ground"]
EYE, TARGET, FOV = (3.4, 2.3, 4.6), (0.05, 0.5, 0.0), 42.0  # degrees across the width; as in images.h
NEAR = 0.5                                                  # of Mitsuba's camera; burnish has none


def power(x, e):
    return np.sign(x) * np.abs(x) ** e


def superellipsoid(center, half, e1, e2, nu, nv):
    v, u = np.meshgrid(np.linspace(0, 1, nv + 1), np.linspace(0, 1, nu + 1), indexing="ij")
    small = lambda x: np.where(np.abs(x) < 1e-12, 0, x)
    c, s = small(np.cos(np.pi * (v - 0.5))), np.sin(np.pi * (v - 0.5))
    x, z = small(np.cos(2 * np.pi * (u - 0.5))), small(-np.sin(2 * np.pi * (u - 0.5)))
    along = lambda a, b: np.stack([power(c, a) * power(x, b), power(s, a), power(c, a) * power(z, b)], -1)
    n = along(2 - e1, 2 - e2) / half
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    triangles = []
    for j in range(nv):
        for i in range(nu):
            a, b = j * (nu + 1) + i, (j + 1) * (nu + 1) + i
            if j > 0:  # at the poles one triangle of the two has no area
                triangles.append((a, a + 1, b + 1))
            if j < nv - 1:
                triangles.append((a, b + 1, b))
    flat = lambda q: q.reshape(-1, q.shape[-1])
    return flat(along(e1, e2) * half + center), flat(n), flat(np.stack([u, v], -1)), np.array(triangles)


def wheel(center, radius, half, n):
    p, normal, uv, triangles = [], [], [], []
    spokes = [(np.cos(a), np.sin(a)) for a in 2 * np.pi * (np.arange(n + 1) + 0.5) / n]
    for k, (x, y) in enumerate(spokes):
        for s in (-1, 1):
            p.append((radius * x, radius * y, half * s))
            normal.append((x, y, 0))
            uv.append((2 * k / n, (s + 1) / 2))
    for a in range(0, 2 * n, 2):
        triangles += [(a, a + 2, a + 3), (a, a + 3, a + 1)]
    for s in (-1, 1):
        first = len(p)
        for x, y in [(0, 0)] + spokes:
            p.append((radius * x, radius * y, half * s))
            normal.append((0, 0, s))
            uv.append((0.5 + 0.5 * x, 0.5 + 0.5 * y))
        for k in range(1, n + 1):
            a, b = first + k, first + k + 1
            triangles.append((first, a, b) if s > 0 else (first, b, a))
    return np.array(p) + center, np.array(normal), np.array(uv), np.array(triangles)


def car():
    """float32: vertices x (position, normal, uv); int32: triangles x (three vertices, part)."""
    vec = np.array
    plate = (vec([(-3.2, 0, 1.9), (3.2, 0, 1.9), (3.2, 0, -1.9), (-3.2, 0, -1.9)]), vec([(0, 1, 0)] * 4),
             vec([(0, 0), (3, 0), (3, 2), (0, 2)]), vec([(0, 1, 2), (0, 2, 3)]))
    pieces = [(0, superellipsoid(vec([0, 0.62, 0]), vec([2.1, 0.36, 0.85]), 0.55, 0.5, 40, 16)),
              (1, superellipsoid(vec([-0.25, 0.95, 0]), vec([1.15, 0.45, 0.68]), 0.6, 0.55, 32, 14)),
              *[(2, wheel(vec([x, 0.32, z]), 0.33, 0.11, 20)) for x in (-1.3, 1.35) for z in (-0.78, 0.78)],
              (3, plate)]
    vertices, triangles, count = [], [], 0
    for part, (p, n, uv, t) in pieces:
        vertices.append(np.hstack([p, n, uv]))
        triangles.append(np.hstack([t + count, np.full((len(t), 1), part)]))
        count += len(p)
    return np.vstack(vertices).astype(np.float32), np.vstack(triangles).astype(np.int32)
