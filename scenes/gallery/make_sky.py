#!/usr/bin/env python3
# Writes sky.exr beside this file: a sky of 64 x 64 texels of equal solid angle, as pbrt-v4 maps the sphere (Clarberg
# 2008), z up: blue, brighter towards the horizon, dark ground, and a sun of a few texels in a haze.
import os

import numpy as np
import OpenImageIO as oiio

SIZE = 64
SUN = np.array([-0.78, 0.30, 0.55])
SUN /= np.linalg.norm(SUN)


def direction(s, t):
    u, v = 2 * s - 1, 2 * t - 1
    up, vp = abs(u), abs(v)
    signed = 1 - (up + vp)
    r = 1 - abs(signed)
    phi = (1 if r == 0 else (vp - up) / r + 1) * np.pi / 4
    scale = r * np.sqrt(2 - r * r)
    return np.array([np.copysign(np.cos(phi) * scale, u), np.copysign(np.sin(phi) * scale, v),
                     np.copysign(1 - r * r, signed)])


def radiance(w):
    if w[2] < 0:
        return np.array([0.10, 0.09, 0.07])
    sky = np.array([0.25, 0.45, 0.9]) + (1 - w[2]) ** 3 * np.array([0.6, 0.5, 0.2])
    to_sun = w @ SUN
    return sky + 4 * max(to_sun, 0) ** 40 * np.array([1, 0.8, 0.5]) + (600 if to_sun > np.cos(0.06) else 0)


pixels = np.array([[radiance(direction((x + 0.5) / SIZE, (y + 0.5) / SIZE)) for x in range(SIZE)]
                   for y in range(SIZE)], dtype=np.float32)
spec = oiio.ImageSpec(SIZE, SIZE, 3, "half")
spec.attribute("compression", "zip")
out = oiio.ImageOutput.create("sky.exr")
assert out.open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "sky.exr"), spec)
assert out.write_image(pixels)
out.close()
