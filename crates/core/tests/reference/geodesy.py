"""Geodesy by other people's code, to geodesy.csv.

ECEF and local ENU (origin: Freiberg, 50.92 N 13.34 E, 400 m) come from PROJ (pipelines `cart` and `topocentric`).
Gravity is the exact normal gravity of the WGS-84 level ellipsoid in ellipsoidal-harmonic coordinates (TR8350.2,
chapter 4; Heiskanen & Moritz 1967, chapter 2) in 40 digits: neither Somigliana's form nor the series in the height.
Made with Python 3, pyproj 3.7.2 (PROJ 9.5.1), mpmath:   python geodesy.py > geodesy.csv
"""

from mpmath import mp, mpf, sqrt, sin, cos, atan, radians
from pyproj import Transformer

mp.dps = 40
A, F = mpf(6378137), 1 / mpf("298.257223563")
GM, OMEGA = mpf("3.986004418e14"), mpf("7.292115e-5")
B = A * (1 - F)
E = sqrt(A**2 - B**2)  # linear eccentricity


def exact_normal_gravity(lat, h):
    """Length of the gravity vector of the level ellipsoid, m/s²."""
    n = A**2 / sqrt((A * cos(lat)) ** 2 + (B * sin(lat)) ** 2)
    p, z = (n + h) * cos(lat), (n * (B / A) ** 2 + h) * sin(lat)

    def q(u):
        return ((1 + 3 * u**2 / E**2) * atan(E / u) - 3 * u / E) / 2

    def q_prime(u):
        return 3 * (1 + u**2 / E**2) * (1 - u / E * atan(E / u)) - 1

    s = p**2 + z**2 - E**2
    u = sqrt((s + sqrt(s**2 + 4 * E**2 * z**2)) / 2)
    sin_b = z / u
    cos_b = p / sqrt(u**2 + E**2)
    w = sqrt((u**2 + (E * sin_b) ** 2) / (u**2 + E**2))
    g_u = -(1 / w) * (
        GM / (u**2 + E**2)
        + OMEGA**2 * A**2 * E / (u**2 + E**2) * q_prime(u) / q(B) * (sin_b**2 / 2 - mpf(1) / 6)
        - OMEGA**2 * u * cos_b**2
    )
    g_b = (1 / w) * (
        OMEGA**2 * A**2 / sqrt(u**2 + E**2) * q(u) / q(B) * sin_b * cos_b
        - OMEGA**2 * sqrt(u**2 + E**2) * sin_b * cos_b
    )
    return sqrt(g_u**2 + g_b**2)


cart = Transformer.from_pipeline("+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84")
enu = Transformer.from_pipeline(
    "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
    "+step +proj=topocentric +ellps=WGS84 +lat_0=50.92 +lon_0=13.34 +h_0=400"
)
print("latitude_deg,longitude_deg,height_m,ecef_x_m,ecef_y_m,ecef_z_m,east_m,north_m,up_m,gravity_m_s2")
for lat in (-90.0, -89.999, -67.5, -45.0, -26.2, -0.001, 0.0, 30.0, 50.93, 69.3, 89.9999, 90.0):
    for lon in (-180.0, -69.5, 0.0, 13.35, 179.9999):
        for h in (-4000.0, -2000.0, 0.0, 400.0, 10000.0):
            x, y, z = cart.transform(lon, lat, h)
            e, n, u = enu.transform(lon, lat, h)
            g = exact_normal_gravity(radians(mpf(lat)), mpf(h))
            print(f"{lat},{lon},{h},{x:.9f},{y:.9f},{z:.9f},{e:.9f},{n:.9f},{u:.9f},{mp.nstr(g, 14)}")
