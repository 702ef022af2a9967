//! Position fixes: where somebody is, said from outside (Wi-Fi, UWB, a portal, a surveyed point).

use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// One position measured from outside, in the level frame of the log: local ENU or the mine's grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PositionFix {
    /// Time of validity.
    pub time: Time,
    /// Position (east, north), m.
    pub level_m: Vector2<f64>,
    /// Its covariance, m²; symmetric, positive definite.
    pub covariance_m2: Matrix2<f64>,
    /// Height, where it was measured.
    pub height: Option<HeightFix>,
    /// What measured it.
    pub source: FixSource,
}

/// Height of a fix, measured independently of its level position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeightFix {
    /// Height above the origin of the frame, m.
    pub up_m: f64,
    /// Standard deviation, m; above 0.
    pub sigma_m: f64,
}

/// What measured a position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FixSource {
    /// Not told.
    #[default]
    Unknown,
    /// Wi-Fi signal strength or round-trip time.
    Wifi,
    /// Ultra-wideband ranges.
    Uwb,
    /// Bluetooth beacons.
    Bluetooth,
    /// An RFID portal.
    Rfid,
    /// A surveyed point.
    Survey,
    /// Satellites, above ground.
    Gnss,
}

impl PositionFix {
    /// A level fix with the same standard deviation in every direction.
    pub fn level(time: Time, level_m: Vector2<f64>, sigma_m: f64, source: FixSource) -> Self {
        let covariance_m2 = Matrix2::identity() * (sigma_m * sigma_m);
        Self { time, level_m, covariance_m2, height: None, source }
    }

    /// The standard deviation, m, where it is the same in every direction.
    pub fn sigma_m(&self) -> Option<f64> {
        let sigma = libm::sqrt(self.covariance_m2[(0, 0)]);
        (self.covariance_m2 == Matrix2::identity() * (sigma * sigma)).then_some(sigma)
    }

    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    ///
    /// Positions beyond 10,000 km and standard deviations outside 1 µm to 10,000 km are no positions of a person.
    pub fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        const FAR_M: f64 = 1e7;
        const LEAST_M: f64 = 1e-6;
        let near = |v: f64| v.abs() <= FAR_M;
        let variance = |v: f64| (LEAST_M * LEAST_M..=FAR_M * FAR_M).contains(&v);
        let (east, north) = (self.level_m.x, self.level_m.y);
        let [ee, en, ne, nn] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|at| self.covariance_m2[at]);
        let correlation = en / libm::sqrt(ee * nn);
        let checks = [
            ("fix_east_m", east, near(east), "at most 10,000 km from the origin"),
            ("fix_north_m", north, near(north), "at most 10,000 km from the origin"),
            ("fix_cov_e_e_m2", ee, variance(ee), "the square of 1 µm to 10,000 km"),
            ("fix_cov_n_n_m2", nn, variance(nn), "the square of 1 µm to 10,000 km"),
            (
                "fix_cov_e_n_m2",
                en,
                en.to_bits() == ne.to_bits() && correlation.abs() < 1.0,
                "a symmetric, positive definite covariance",
            ),
        ];
        let height = self.height.map(|HeightFix { up_m, sigma_m }| {
            let sigma = (LEAST_M..=FAR_M).contains(&sigma_m);
            [
                ("fix_up_m", up_m, near(up_m), "at most 10,000 km from the origin"),
                ("fix_up_sigma_m", sigma_m, sigma, "1 µm to 10,000 km"),
            ]
        });
        checks
            .into_iter()
            .chain(height.into_iter().flatten())
            .find(|(_, _, good, _)| !good)
            .map(|(name, found, _, expected)| (name, found, expected))
    }
}

impl FixSource {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Unknown, Self::Wifi, Self::Uwb, Self::Bluetooth, Self::Rfid, Self::Survey, Self::Gnss];

    /// As written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Wifi => "wifi",
            Self::Uwb => "uwb",
            Self::Bluetooth => "bluetooth",
            Self::Rfid => "rfid",
            Self::Survey => "survey",
            Self::Gnss => "gnss",
        }
    }

    /// From its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|source| source.name() == name)
    }
}
