//! Settings of the place filter: what is true of every carrier, and how each errs.

use crate::methods::NoiseParameter;
use crate::settings::{first_unusable, not_negative, positive};
use serde::{Deserialize, Serialize};

/// Settings of what is beside the carrier.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlaceParams {
    /// Hold the walker to the roadways, where the mine is known.
    pub roadways: bool,
    /// A measurement whose normalised innovation squared exceeds this, for each of its dimensions, pulls no more than one at it.
    pub nis_bound: f64,
    /// Error of a clear range that passes, standard deviation, m (walls and people near the path).
    pub passing_sigma_m: f64,
    /// Time over which it passes, s.
    pub passing_s: f64,
    /// Time over which what is in the way of a range errs the same, s.
    pub blocked_s: f64,
    /// What the variance of a place that ranges hold is multiplied by when it is told: what they have in common for longer than the times above is not in it. Found over the
    /// scenarios (docs/methods/fused.md).
    pub stated_by_ranges: f64,
    /// What a range errs for as long as somebody stays, root mean square, m: a trunk in the way, echoes, the anchor's own delay. Of where somebody is across a roadway the
    /// ranges of an anchor tell no more than one of this error does.
    pub lasting_sigma_m: f64,
    /// What all ranges read too long, standard deviation, m.
    pub common_offset_sigma_m: f64,
    /// By how much ranges are stamped late, standard deviation, s.
    pub clock_sigma_s: f64,
    /// By how much a tag hears every signal too strong, standard deviation, dB.
    pub hearing_sigma_db: f64,
    /// Height of a tag above the floor, m.
    pub above_floor_m: f64,
    /// The same, standard deviation, m.
    pub above_floor_sigma_m: f64,
    /// Height by the barometer, standard deviation of a reading, m.
    pub barometer_sigma_m: f64,
    /// Random walk of the air pressure as a height, m/√s.
    pub weather_m_sqrt_s: f64,
    /// Radius from which on the walker is lost, m.
    pub lost_m: f64,
    /// Tell the place of the newest ranges or fix while the direction of the way is not known: who stands since the beginning is somewhere already. What is told so holds
    /// nothing; a live server wants it.
    pub before_direction: bool,
    /// Before there is a place, a scan of signal strengths is left unless so long has passed since the last position by one, s, or the walker has gone on: one of the same spot says
    /// little that is new (`pdr::radio`), and to look it up on the map of the site is the dearest thing a tag asks for. 0 takes all.
    pub scan_rest_s: f64,
}

/// How dead reckoning of a carrier errs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CarrierNoise {
    /// White error along the way, m/√m walked.
    pub along_m_sqrt_m: f64,
    /// White error across it, m/√m walked.
    pub across_m_sqrt_m: f64,
    /// White error upwards, m/√m walked.
    pub up_m_sqrt_m: f64,
    /// Who does not walk still shifts about: m/√s.
    pub standing_m_sqrt_s: f64,
    /// Direction of the carrier's frame where it is declared, standard deviation, rad.
    pub turn_sigma_rad: f64,
    /// Random walk of it, rad/√m walked.
    pub turn_walk_rad_sqrt_m: f64,
    /// Random walk of the heading beside what the carrier tells, rad/√s.
    pub heading_walk_rad_sqrt_s: f64,
    /// Drift of the heading with the way, standard deviation, rad/m.
    pub drift_sigma_rad_m: f64,
    /// Random walk of that drift, rad/m/√m.
    pub drift_walk_rad_m_sqrt_m: f64,
    /// Share of every turn that the gyro misses, standard deviation.
    pub missed_sigma: f64,
    /// What goes with the tag and the tilt that nobody sees turn its compass by, standard deviation, rad.
    pub iron_sigma_rad: f64,
    /// Random walk of it, rad/√m walked.
    pub iron_walk_rad_sqrt_m: f64,
    /// Heading of a magnetometer among steel and cables, standard deviation at least, rad.
    pub magnetic_sigma_rad: f64,
    /// Time over which the heading of a magnetometer is off in the same way, s.
    pub magnetic_s: f64,
    /// Factor of the lengths, standard deviation about 1 at the start.
    pub factor_sigma: f64,
    /// Its random walk, per √m walked.
    pub factor_walk_sqrt_m: f64,
}

impl Default for PlaceParams {
    fn default() -> Self {
        Self {
            roadways: true,
            // χ² of one degree of freedom: exceeded by 1 of 400 good ones.
            nis_bound: 9.0,
            passing_sigma_m: 0.07,
            passing_s: 0.7,
            blocked_s: 3.0,
            stated_by_ranges: 2.0,
            lasting_sigma_m: 0.25,
            common_offset_sigma_m: 0.05,
            clock_sigma_s: 0.05,
            hearing_sigma_db: 6.0,
            above_floor_m: 1.0,
            above_floor_sigma_m: 0.3,
            barometer_sigma_m: 1.0,
            weather_m_sqrt_s: 0.15,
            lost_m: 200.0,
            before_direction: false,
            scan_rest_s: 0.0,
        }
    }
}

impl CarrierNoise {
    /// Of a strapdown on the foot, held by zero velocity.
    pub const FOOT: Self = Self {
        along_m_sqrt_m: 0.04,
        across_m_sqrt_m: 0.04,
        up_m_sqrt_m: 0.02,
        standing_m_sqrt_s: 0.001,
        turn_sigma_rad: 0.05,
        turn_walk_rad_sqrt_m: 0.0015,
        heading_walk_rad_sqrt_s: 2e-4,
        drift_sigma_rad_m: 3e-4,
        drift_walk_rad_m_sqrt_m: 3e-6,
        missed_sigma: 0.008,
        iron_sigma_rad: 0.04,
        iron_walk_rad_sqrt_m: 2e-4,
        magnetic_sigma_rad: 0.05,
        magnetic_s: 30.0,
        factor_sigma: 0.01,
        factor_walk_sqrt_m: 1e-4,
    };
    /// Of steps counted on the body.
    pub const STEPS: Self = Self {
        along_m_sqrt_m: 0.067,
        across_m_sqrt_m: 0.06,
        up_m_sqrt_m: 0.1,
        standing_m_sqrt_s: 0.05,
        turn_sigma_rad: 0.17,
        turn_walk_rad_sqrt_m: 0.005,
        heading_walk_rad_sqrt_s: 1e-4,
        drift_sigma_rad_m: 0.0,
        drift_walk_rad_m_sqrt_m: 0.0,
        missed_sigma: 0.0,
        iron_sigma_rad: 0.0,
        iron_walk_rad_sqrt_m: 0.0,
        magnetic_sigma_rad: 0.05,
        magnetic_s: 30.0,
        factor_sigma: 0.12,
        factor_walk_sqrt_m: 0.003,
    };

    /// What tuning may search.
    pub const NOISE: [NoiseParameter; 4] = [
        NoiseParameter::new("steps_noise.along_m_sqrt_m", 1e-3, 0.5),
        NoiseParameter::new("steps_noise.across_m_sqrt_m", 1e-3, 0.5),
        NoiseParameter::new("place.blocked_s", 0.1, 60.0),
        NoiseParameter::new("ranges.nlos_sigma_m", 0.1, 20.0),
    ];

    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("noise.along_m_sqrt_m", not_negative(self.along_m_sqrt_m)),
            ("noise.across_m_sqrt_m", not_negative(self.across_m_sqrt_m)),
            ("noise.up_m_sqrt_m", not_negative(self.up_m_sqrt_m)),
            ("noise.standing_m_sqrt_s", not_negative(self.standing_m_sqrt_s)),
            ("noise.turn_sigma_rad", not_negative(self.turn_sigma_rad)),
            ("noise.turn_walk_rad_sqrt_m", not_negative(self.turn_walk_rad_sqrt_m)),
            ("noise.heading_walk_rad_sqrt_s", not_negative(self.heading_walk_rad_sqrt_s)),
            ("noise.drift_sigma_rad_m", not_negative(self.drift_sigma_rad_m)),
            ("noise.drift_walk_rad_m_sqrt_m", not_negative(self.drift_walk_rad_m_sqrt_m)),
            ("noise.missed_sigma", not_negative(self.missed_sigma)),
            ("noise.iron_sigma_rad", not_negative(self.iron_sigma_rad)),
            ("noise.iron_walk_rad_sqrt_m", not_negative(self.iron_walk_rad_sqrt_m)),
            ("noise.magnetic_sigma_rad", not_negative(self.magnetic_sigma_rad)),
            ("noise.magnetic_s", positive(self.magnetic_s)),
            ("noise.factor_sigma", not_negative(self.factor_sigma) && self.factor_sigma <= 0.5),
            ("noise.factor_walk_sqrt_m", not_negative(self.factor_walk_sqrt_m)),
        ])
    }
}

impl Default for CarrierNoise {
    fn default() -> Self {
        Self::STEPS
    }
}

impl PlaceParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("place.nis_bound", positive(self.nis_bound)),
            ("place.passing_sigma_m", not_negative(self.passing_sigma_m)),
            ("place.passing_s", positive(self.passing_s)),
            ("place.blocked_s", positive(self.blocked_s)),
            ("place.stated_by_ranges", positive(self.stated_by_ranges)),
            ("place.lasting_sigma_m", not_negative(self.lasting_sigma_m)),
            ("place.common_offset_sigma_m", not_negative(self.common_offset_sigma_m)),
            ("place.clock_sigma_s", not_negative(self.clock_sigma_s)),
            ("place.hearing_sigma_db", not_negative(self.hearing_sigma_db)),
            ("place.above_floor_m", self.above_floor_m.is_finite()),
            ("place.above_floor_sigma_m", positive(self.above_floor_sigma_m)),
            ("place.barometer_sigma_m", positive(self.barometer_sigma_m)),
            ("place.weather_m_sqrt_s", not_negative(self.weather_m_sqrt_s)),
            ("place.lost_m", positive(self.lost_m)),
            ("place.scan_rest_s", not_negative(self.scan_rest_s)),
        ])
    }
}
