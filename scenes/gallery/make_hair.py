#!/usr/bin/env python3
"""Writes hair.pbrt: a ball of fur. Deterministic; run as `python3 make_hair.py [STRANDS] > hair.pbrt`."""
import math
import random
import sys

HEAD = """# A ball of fur under a window, with a lamp behind it that shines through the strands. Written by make_hair.py.
LookAt 0 0.62 3.1   0 0.5 0   0 1 0
Camera "perspective" "float fov" [ 29 ]
Film "image" "integer xresolution" [ 480 ] "integer yresolution" [ 480 ]
Sampler "stratified" "integer xsamples" [ 4 ] "integer ysamples" [ 4 ]
PixelFilter "box" "float xwidth" [ 0.5 ] "float ywidth" [ 0.5 ]
Integrator "directlighting"
WorldBegin
# The window, before it, to the right and above.
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 95 90 82 ]
  Material "matte" "rgb Kd" [ 0 0 0 ]
  Shape "quad" "point o" [ -1.7 1.868 1.2285 ] "vector u" [ 0.584 0 0.547 ] "vector v" [ -0.184 -0.536 0.196 ]
AttributeEnd
# The lamp behind, to the left.
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 26 27 32 ]
  Material "matte" "rgb Kd" [ 0 0 0 ]
  Shape "quad" "point o" [ 1.788 1.1765 -1.8575 ] "vector u" [ 0.434 0 0.549 ] "vector v" [ -0.21 0.647 0.166 ]
AttributeEnd
Material "matte" "rgb Kd" [ 0.09 0.095 0.11 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -6 0 -4  -6 0 6  6 0 6  6 0 -4 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -6 0 -4  6 0 -4  6 5 -4  -6 5 -4 ]
# The skin.
AttributeBegin
  Material "matte" "rgb Kd" [ 0.25 0.15 0.09 ]
  Translate 0 0.5 0
  Shape "sphere" "float radius" [ 0.31 ]
AttributeEnd
Material "hair" "float eumelanin" [ 0.12 ] "float pheomelanin" [ 0.3 ] "float beta_m" [ 0.35 ] "float beta_n" [ 0.3 ]
Attribute "shape" "string type" "flat" "float width0" [ 0.0055 ] "float width1" [ 0.001 ]
"""


def strand(rng, i, strands):
    """Control points from the skin outwards, bent by gravity and a whorl."""
    # Fibonacci's lattice on the sphere, jittered.
    y = 1 - (2 * i + 1) / strands
    phi = i * math.pi * (3 - math.sqrt(5)) + 0.3 * rng.uniform(-1, 1)
    r = math.sqrt(1 - y * y)
    n = (r * math.cos(phi), y, r * math.sin(phi))
    side = (-n[2], 0, n[0])
    length = 0.25 * rng.uniform(0.75, 1.25)
    curl, droop = rng.uniform(0.5, 0.9), rng.uniform(0.4, 0.8)
    points = []
    for k in range(4):
        t = k / 3
        p = [0.31 * n[a] + length * t * n[a] for a in range(3)]
        p = [p[a] + length * curl * t * t * side[a] for a in range(3)]
        p[1] += 0.5 - length * droop * t * t
        p = [x + 0.012 * t * rng.uniform(-1, 1) for x in p]
        points += p
    return points


def main():
    strands = int(sys.argv[1]) if len(sys.argv) > 1 else 9000
    rng = random.Random(7)
    out = [HEAD]
    for i in range(strands):
        numbers = " ".join(f"{x:.3f}".replace("0.", ".", 1) if abs(x) < 1 else f"{x:.3f}" for x in strand(rng, i, strands))
        out.append(f'Shape "curve" "point P" [{numbers}]\n')
    out.append("WorldEnd\n")
    sys.stdout.write("".join(out))


if __name__ == "__main__":
    main()
