"""Distance of points from simple polygons by shapely (GEOS), to polygons.csv.

Stars with unequal rays, many of them not convex, at coordinates as a national grid has them.
Made with Python 3, numpy, shapely 2.2:   python polygons.py > polygons.csv
"""

import numpy as np
from shapely import Point, Polygon

random = np.random.default_rng(4)
print("outline,x_m,y_m,distance_m")
for _ in range(20):
    centre = random.uniform([4.0e5, 5.6e6], [4.1e5, 5.7e6])
    corners = random.integers(3, 14)
    angle = np.sort(random.uniform(0, 2 * np.pi, corners))
    radius = random.uniform(2.0, 30.0, corners)
    outline = np.round(centre + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), 3)
    polygon = Polygon(outline)
    if not polygon.is_valid:
        continue
    text = " ".join(f"{x!r} {y!r}" for x, y in outline.tolist())
    for point in np.round(random.uniform(centre - 40, centre + 40, (12, 2)), 3).tolist():
        print(f"{text},{point[0]!r},{point[1]!r},{polygon.distance(Point(point))!r}")
