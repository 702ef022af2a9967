"""Rotation vector to unit quaternion in 50 digits, around the border between series and trigonometry, to attitude.csv.

Every line is checked against scipy's Rotation before it is written.
Made with Python 3, mpmath, scipy 1.17:   python attitude.py > attitude.csv
"""

from mpmath import mp, mpf, sqrt, sin, cos
from scipy.spatial.transform import Rotation

mp.dps = 50
AXES = [(1.0, 0.0, 0.0), (0.6, -0.8, 0.0), (-0.36, 0.48, 0.8), (0.1, 0.2, -0.974679434480896)]
ANGLES = [1e-12, 1e-6, 1e-3, 5e-3, 9e-3, 9.9e-3, 9.999e-3, 1.0001e-2, 1.01e-2, 2e-2, 0.1, 1.0, 2.0, 3.0, 3.14159, 4.0, 6.28]
print("x_rad,y_rad,z_rad,qw,qx,qy,qz")
for axis in AXES:
    for angle in ANGLES:
        v = [a * angle for a in axis]  # the doubles that Rust will read
        exact = [mpf(a) for a in v]
        theta = sqrt(sum(a * a for a in exact))
        q = [cos(theta / 2)] + [a * sin(theta / 2) / theta for a in exact]
        x, y, z, w = Rotation.from_rotvec(v).as_quat()
        assert max(abs(float(a) - b) for a, b in zip(q, (w, x, y, z))) < 4e-16
        print(",".join([repr(a) for a in v] + [mp.nstr(a, 20) for a in q]))
