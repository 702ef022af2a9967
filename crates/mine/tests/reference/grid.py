"""A mine grid that is UTM zone 33N: control points and test points by PROJ, to grid.csv.

The scale and the turn of UTM change over the few kilometres of a mine by centimetres; what a similarity leaves is that.
Made with Python 3, pyproj 3.7.2 (PROJ 9.5.1):   python grid.py > grid.csv
"""

from pyproj import Proj, Transformer

utm = Transformer.from_crs("EPSG:32633", "EPSG:4326", always_xy=True)
factors = Proj("EPSG:32633")
print("kind,east_m,north_m,height_m,longitude_deg,latitude_deg,ellipsoidal_height_m,convergence_deg,scale")
east, north = 383400.0, 5642300.0
places = [("control", x, y) for x, y in [(-900, -800), (1100, -700), (1000, 900), (-800, 950), (50, -1000)]]
places += [("test", 250 * i, 300 * j) for i in range(-3, 4) for j in range(-2, 3)]
for number, (kind, x, y) in enumerate(places):
    x, y = east + x, north + y
    lon, lat = utm.transform(x, y)
    f = factors.get_factors(lon, lat)
    height = 300.0 if kind == "control" else -500.0 + 37.0 * number
    print(f"{kind},{x},{y},{height},{lon!r},{lat!r},{height + 44.25},{f.meridian_convergence!r},{f.meridional_scale!r}")
