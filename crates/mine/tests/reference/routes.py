"""Shortest ways through mazes of roadways by networkx (Dijkstra), to routes.csv.

A jittered grid of nodes with a third of its edges taken out, and two long bypasses between the same nodes as another edge.
Made with Python 3, numpy, networkx 3.6:   python routes.py > routes.csv
"""

import networkx as nx
import numpy as np

random = np.random.default_rng(5)
print("maze,kind,numbers")
for maze in range(6):
    side = 7
    place = {
        (i, j): np.round([60 * i + random.uniform(-20, 20), 60 * j + random.uniform(-20, 20), random.uniform(-3, 3)], 2)
        for i in range(side)
        for j in range(side)
    }
    graph = nx.MultiGraph()
    graph.add_nodes_from(place)
    for i, j in place:
        for other in [(i + 1, j), (i, j + 1)]:
            if other in place and random.uniform() > 0.33:
                points = [place[i, j], place[other]]
                if random.uniform() < 0.2:  # a bend on the way
                    points.insert(1, np.round((points[0] + points[1]) / 2 + random.uniform(-12, 12, 3), 2))
                length = sum(np.linalg.norm(b - a) for a, b in zip(points, points[1:]))
                graph.add_edge((i, j), other, length=length, points=points)
    for a, b in list(graph.edges())[:2]:
        points = [place[a], np.round((place[a] + place[b]) / 2 + [0, 0, 25], 2), place[b]]
        length = sum(np.linalg.norm(q - p) for p, q in zip(points, points[1:]))
        graph.add_edge(a, b, length=length, points=points)
    edges = list(graph.edges(data=True))
    for _, _, data in edges:
        print(f"{maze},roadway,{' '.join(repr(v) for p in data['points'] for v in p.tolist())}")
    for _ in range(25):
        (first, s), (last, t) = [(random.integers(0, len(edges)), random.uniform()) for _ in range(2)]
        split = graph.copy()
        # Both places become nodes that cut their edges.
        for name, number, share in [("from", first, s), ("to", last, t)]:
            a, b, data = edges[number]
            split.add_edge(a, name, length=share * data["length"])
            split.add_edge(name, b, length=(1 - share) * data["length"])
        if first == last:
            split.add_edge("from", "to", length=abs(s - t) * edges[first][2]["length"])
        try:
            length = nx.dijkstra_path_length(split, "from", "to", weight="length")
        except nx.NetworkXNoPath:
            length = -1.0
        along = [share * edges[number][2]["length"] for number, share in [(first, s), (last, t)]]
        print(f"{maze},way,{first} {float(along[0])!r} {last} {float(along[1])!r} {float(length)!r}")
