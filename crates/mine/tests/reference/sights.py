"""How much of a line of sight runs through rock and through pillars, by shapely (GEOS), to sights.csv.

A level mine: corridors are buffers of centre lines, round at ends and bends, a circle drawn with 4096 sides; the rock is what
is left of the line outside their union. Half the lines start in the air, as real ones do.
Made with Python 3, numpy, shapely 2.2:   python sights.py > sights.csv
"""

import numpy as np
from shapely import LineString, Polygon, union_all

random = np.random.default_rng(11)
print("case,kind,width_m,points")
print_rows, cases = [], 12
for case in range(cases):
    lines, widths = [], []
    at = np.zeros(2)
    for number in range(5):
        points = [at]
        for _ in range(random.integers(1, 4)):
            points.append(np.round(points[-1] + random.uniform(-60, 60, 2), 2))
        widths.append(round(random.uniform(3, 8), 2))
        lines.append(np.array(points))
        # The next one leaves from a bend or the end of this one.
        at = points[random.integers(1, len(points))]
    pillars = []
    for number in range(6):
        line = lines[random.integers(0, 5)]
        middle = line[0] + random.uniform(0, 1) * (line[1] - line[0])
        angle = np.sort(random.uniform(0, 2 * np.pi, 5))
        outline = np.round(middle + random.uniform(0.3, 1.5, 5)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), 3)
        if Polygon(outline).is_valid and Polygon(outline).area > 0.01:
            pillars.append(outline)
    show = lambda points: " ".join(f"{x!r} {y!r}" for x, y in points.tolist())
    for line, width in zip(lines, widths):
        print(f"{case},roadway,{width!r},{show(line)}")
    for pillar in pillars:
        print(f"{case},pillar,,{show(pillar)}")
    air = union_all([LineString(l).buffer(0.5 * w, quad_segs=1024) for l, w in zip(lines, widths)])
    stone = union_all([Polygon(p) for p in pillars])
    for number in range(30):
        line = lines[random.integers(0, 5)]
        start = line[0] + random.uniform(0, 1) * (line[1] - line[0])
        if number % 2:
            other = lines[random.integers(0, 5)]
            end = other[-1] + random.uniform(0, 1) * (other[-2] - other[-1])
        else:
            end = start + random.uniform(-40, 40, 2)
        sight = np.round(np.array([start, end]), 2)
        path = LineString(sight)
        rock = path.difference(air).length
        through = path.intersection(stone).length
        print(f"{case},sight,,{show(sight)} {rock!r} {through!r}")
