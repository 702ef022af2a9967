//! Units a column name can end in, and the exact conversion to adit's own.

/// Standard gravity, m/s² (ISO 80000-3): what one `g` means in a log.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// What a column measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Specific force.
    Acceleration,
    /// Angular rate.
    AngularRate,
    /// Magnetic flux density.
    MagneticField,
}

impl Quantity {
    /// All of them, in the order in which logs are written.
    pub const ALL: [Self; 3] = [Self::Acceleration, Self::AngularRate, Self::MagneticField];

    /// What the column name begins with.
    pub const fn prefix(self) -> &'static str {
        match self {
            Self::Acceleration => "acc",
            Self::AngularRate => "gyro",
            Self::MagneticField => "mag",
        }
    }

    /// The units accepted; the first is adit's own.
    pub const fn units(self) -> &'static [Unit] {
        match self {
            Self::Acceleration => &[
                Unit { suffix: "m_s2", gain: Gain::ONE },
                Unit { suffix: "g", gain: Gain { times: STANDARD_GRAVITY_M_S2, over: 1.0 } },
            ],
            Self::AngularRate => &[
                Unit { suffix: "rad_s", gain: Gain::ONE },
                Unit { suffix: "deg_s", gain: Gain { times: std::f64::consts::PI, over: 180.0 } },
            ],
            Self::MagneticField => &[
                Unit { suffix: "uT", gain: Gain::ONE },
                Unit { suffix: "nT", gain: Gain { times: 1.0, over: 1000.0 } },
                Unit { suffix: "gauss", gain: Gain { times: 100.0, over: 1.0 } },
                Unit { suffix: "mT", gain: Gain { times: 1000.0, over: 1.0 } },
            ],
        }
    }
}

/// Units of time: the end of the column name and the power of ten of its nanoseconds.
pub const TIME_UNITS: [(&str, i32); 4] = [("s", 9), ("ms", 6), ("us", 3), ("ns", 0)];

/// Units of air pressure.
pub const PRESSURE_UNITS: [Unit; 3] = [
    Unit { suffix: "Pa", gain: Gain::ONE },
    Unit { suffix: "hPa", gain: Gain { times: 100.0, over: 1.0 } },
    Unit { suffix: "kPa", gain: Gain { times: 1000.0, over: 1.0 } },
];

/// Units of a received power.
pub const POWER_UNITS: [Unit; 1] = [Unit { suffix: "dBm", gain: Gain::ONE }];

/// Units of a range.
pub const RANGE_UNITS: [Unit; 3] = [
    Unit { suffix: "m", gain: Gain::ONE },
    Unit { suffix: "cm", gain: Gain { times: 1.0, over: 100.0 } },
    Unit { suffix: "mm", gain: Gain { times: 1.0, over: 1000.0 } },
];

/// A unit: the end of the column name and the way to adit's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// As written in the header.
    pub suffix: &'static str,
    /// Conversion.
    pub gain: Gain,
}

impl Unit {
    /// The one of this suffix, as physics writes it or in small letters (`hPa`, `hpa`).
    pub(super) fn of(units: &[Self], suffix: &str) -> Option<Self> {
        let same = |unit: &&Self| unit.suffix == suffix || unit.suffix.to_ascii_lowercase() == suffix;
        units.iter().find(same).copied()
    }
}

/// A factor kept as a fraction, so that 45,123 nT is exactly 45.123 µT.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    times: f64,
    over: f64,
}

impl Gain {
    /// No conversion.
    pub const ONE: Self = Self { times: 1.0, over: 1.0 };

    /// Converts a value; by [`Gain::ONE`] without changing a bit.
    #[inline]
    pub fn apply(self, value: f64) -> f64 {
        value * self.times / self.over
    }
}
