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
