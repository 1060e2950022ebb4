# tests/reference/inputs.py -- random inputs that generator and test make alike (inputs.h)
# SPDX-License-Identifier: Apache-2.0
"""splitmix64 (Steele, Lea and Flood 2014) as a counter: number j of point i in stream s is the output for the counter
s 2^48 + i 2^8 + j, its top 24 bits over 2^24. So inputs need not be stored: inputs.h writes the same lines, and
inputs.npy holds the first of stream 1 for its test."""
import numpy as np


def splitmix64(counter):
    """Output number `counter` (from 0, an array of uint64) of the generator whose state began at 0."""
    with np.errstate(over="ignore"):
        z = (np.asarray(counter, np.uint64) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))


def uniform(stream, count, j):
    """float64 in [0, 1), exact in float32: number j of points 0 .. count - 1."""
    counter = np.uint64(stream << 48) + (np.arange(count, dtype=np.uint64) << np.uint64(8)) + np.uint64(j)
    return (splitmix64(counter) >> np.uint64(40)).astype(np.float64) / 2**24


def between(stream, count, j, low, high):
    """float32 in [low, high]; inputs.h rounds in the same places."""
    return (low + (high - low) * uniform(stream, count, j)).astype(np.float32)


def upward(stream, count, j):
    """float64 (count, 3), unit, z > 0.035: from a box, so that square roots are all that is rounded."""
    d = np.stack([2 * uniform(stream, count, j) - 1, 2 * uniform(stream, count, j + 1) - 1,
                  0.05 + 0.95 * uniform(stream, count, j + 2)], 1)
    return d / np.sqrt(np.sum(d * d, 1))[:, None]


def directions(stream, count, alpha):
    """To the viewer and to the light, float32 (count, 3), z up; they use numbers 0 to 7. Light is anywhere at points
    with an even index; at odd ones it is mirrored at a half vector tilted by up to 3 alpha, where that is not below the
    horizon, so that sharp lobes are met."""
    v, l = upward(stream, count, 0), upward(stream, count, 3)
    tilt = 3 * np.broadcast_to(np.asarray(alpha, np.float64), (count,))
    h = np.stack([tilt * (2 * uniform(stream, count, 6) - 1), tilt * (2 * uniform(stream, count, 7) - 1),
                  np.ones(count)], 1)
    h /= np.sqrt(np.sum(h * h, 1))[:, None]
    mirrored = 2 * np.sum(v * h, 1)[:, None] * h - v
    use = (np.arange(count) % 2 == 1) & (mirrored[:, 2] > 0.05)
    return v.astype(np.float32), np.where(use[:, None], mirrored, l).astype(np.float32)
