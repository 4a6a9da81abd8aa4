"""The tables of Salesin & Jarosz 2019 (EGSR) and its supplement: what was compared, and the paper's figures.

The references' camera samples lie on a grid in each pixel; ours are taken on the same one, or thin bright shapes in
the pixel outweigh all else. Regions are pixels of the paper's resolution, half-open. Figures are relMSE at the paper's equal time, or slopes.
"""

RENDERINGS = [
    {
        "scene": "cornell-box/cornell-box.pbrt",
        "reference": "cornell-box.exr",
        "camera_grid": 8,  # of the reference
        "paper_resolution": (512, 512),
        "resolution": (256, 256),
        "regions": {"green": (20, 314, 122, 415), "purple": (408, 113, 511, 214)},
        "rows": [
            # label, mix, {part: figure of the paper}
            ("lines averaged", "line-area@0:1+line-area@90:1/average", {"image": 2.6e-1, "green": 1.2e-2, "purple": 1.5}),
            ("SA points", "sa:1", {"image": 2.0e-1, "green": 1.4e-3, "purple": 1.9}),
            ("MIS of both line directions", "line-area@0:1+line-area@90:1", {"image": 1.0e-1, "green": 2.6e-3, "purple": 3.3e-1}),
            ("not in the paper: auto", "auto", {}),
        ],
    },
    {
        "scene": "op-veach/op-veach-color.pbrt",
        "reference": "op-veach.exr",
        "camera_grid": 8,  # of the reference
        "paper_resolution": (768, 512),
        "resolution": (384, 256),
        "regions": {},
        "rows": [
            ("BSDF", "bsdf:1", {"image": 5.5e1}),
            ("SA points", "sa:1", {"image": 4.5e-1}),
            ("MIS BSDF + SA points", "bsdf:1+sa:1", {"image": 2.0e-1}),
            ("SA lines", "line-sa@v:1", {"image": 4.2e-1}),
            ("MIS BSDF + SA lines", "bsdf:1+line-sa@v:1", {"image": 6.8e-2}),
            ("not in the paper: auto", "auto", {}),
        ],
    },
    {
        "scene": "kitchen/kitchen-play.pbrt",
        "reference": "kitchen.exr",
        # The floor names a texture that the scene lacks. The reference's renderer puts a grey of 0.5 there, ours 1.
        "missing": {"textures/wood.tga": 128},
        "camera_grid": 4,  # of the reference
        "paper_resolution": (1280, 720),
        "resolution": (640, 360),
        "regions": {"green": (855, 488, 966, 539), "purple": (115, 665, 230, 719)},
        "rows": [
            ("4 : 0", "bsdf:4", {"image": 4.0e-1, "green": 5.7e-2, "purple": 4.4e-1}),
            ("3 : 1", "bsdf:3+line-sa@v:1", {"image": 1.0, "green": 1.1e-1, "purple": 1.1e-1}),
            ("2 : 2", "bsdf:2+line-sa@v:2", {"image": 1.0e1, "green": 5.2e-1, "purple": 9.8e-2}),
            ("1 : 3", "bsdf:1+line-sa@v:3", {"image": 2.8e-1, "green": 5.5e-1, "purple": 1.3e-1}),
            ("0 : 4", "line-sa@v:4", {"image": 5.3e-1, "green": 1.9e1, "purple": 1.1e-1}),
            ("not in the paper: SA points 2 : 2", "bsdf:2+sa:2", {}),
            ("not in the paper: auto", "auto", {}),
        ],
    },
]

# Slopes of variance against light samples, Figure 6. Our scene stands in for the paper's, which is not published; it
# names its pixels A and B in its text ("pixel A = X,Y").
CONVERGENCE = {
    "scene": "scenes/gallery/monolith.pbrt",
    "rows": [
        ("BSDF", "bsdf:1", {"A": -1.38, "B": -1.48}),
        ("horizontal lines", "line-sa@u:1", {"A": -2.13, "B": -2.57}),
        ("vertical lines", "line-sa@v:1", {"A": -2.14, "B": -1.61}),
        ("MIS", "bsdf:1+line-sa@u:1", {"A": -1.40, "B": -1.53}),
        # The paper does not say its width. In a light of 8 by 4 this one shows the rate within the range of counts.
        ("MIS smoothed", "bsdf:1+line-sa@u:1/smooth=2", {"A": -2.04, "B": -1.68}),
    ],
}
