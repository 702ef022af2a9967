"""Stored answers of PROJ (pyproj) for tests/independent.rs: grid coordinates of known places in systems that mines use.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install pyproj && /tmp/venv/bin/python projections.py > projections.csv

Places are given in the system's own geographic coordinates; all these systems lie on WGS 84 with no shift between.
"""
import pyproj

# code, latitude, longitude: UTM (Kiruna, Witbank in the south), CGCS2000 3-degree Gauss-Krueger (Datong), ETRS89 / LAEA Europe and UTM 32,
# Lambert 93 (France), GDA94 / MGA zone 50 (Kalgoorlie), SIRGAS 2000 / UTM 23S (Minas Gerais), UTM 17N (Sudbury)
PLACES = [
    (32634, 67.85, 20.22), (32735, -25.87, 29.23), (4547, 40.08, 113.30), (3035, 51.48, 7.22), (25832, 51.48, 7.22),
    (2154, 50.43, 2.83), (28350, -30.75, 119.5), (31983, -20.0, -43.9), (32617, 46.49, -81.0),
]

print(f"# pyproj {pyproj.__version__}, PROJ {pyproj.proj_version_str}")
print("code,latitude_deg,longitude_deg,east_m,north_m,convergence_deg")
for code, latitude, longitude in PLACES:
    crs = pyproj.CRS.from_epsg(code)
    to_grid = pyproj.Transformer.from_crs(crs.geodetic_crs, crs, always_xy=True)
    east, north = to_grid.transform(longitude, latitude)
    convergence = pyproj.Proj(crs).get_factors(longitude, latitude).meridian_convergence
    print(f"{code},{latitude},{longitude},{east:.6f},{north:.6f},{convergence:.9f}")
