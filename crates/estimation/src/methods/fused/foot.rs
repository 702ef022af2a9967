//! A foot that carries: strapdown with zero velocity, and a compass that is read while the foot stands.
//!
//! The compass does not correct the strapdown. What it errs lasts for metres (steel), for the whole walk (iron that goes with the tag) or for ever (a tilt that zero velocity
//! cannot tell from a biased accelerometer), and only who knows the place can learn that: so its headings are handed on as they are, and the way stays as smooth as the gyro has it.

use super::params::FusedParams;
use crate::magnetic::gate::Sighting;
use crate::methods::MethodError;
use crate::methods::foot_ins::FootIns;
use crate::methods::marg_ins::MargInsParams;
use crate::methods::marg_ins::compass::{Compass, Outcome};
use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::sync::Arc;
use serde::{Deserialize, Serialize};

/// Of a foot that goes on standing the place counts anew after this, s.
const STANDING_S: f64 = 1.0;
/// What a compass errs from place to place before anything is learnt of it, standard deviation, rad: 1.5°.
const PLACES_RAD: f64 = 0.026;
/// And at least.
const LEAST_RAD: f64 = 0.005;
/// Headings over which that is learnt.
const HEADINGS: f64 = 100.0;
/// An outlier counts as no more than so many variances.
const MOST_OFF: f64 = 9.0;
/// Iron that goes with the tag, µT: of what norm and dip show, so much is no steel.
const IRON_UT: f64 = 1.2;

/// A foot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Foot {
    /// Its strapdown.
    pub ins: Box<FootIns>,
    /// Its heading when it stood last, rad.
    pub heading_rad: f64,
    /// Whether it stood at the last sample, and for how long without a new origin, s.
    stood: bool,
    standing_s: f64,
    compass: Option<Box<StanceCompass>>,
}

/// A compass, and what it read in the stance that lasts.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct StanceCompass {
    params: Arc<MargInsParams>,
    compass: Compass,
    /// The field at the first stance was the Earth's.
    began_good: bool,
    /// What it errs from place to place, rad².
    places_rad2: f64,
    /// Norm (µT) and dip (rad) as they are with the iron that goes with the tag, over the headings that were used.
    usual: Option<(f64, f64)>,
    used: u32,
    #[serde(skip)]
    seen: Option<Seen>,
}

/// A heading of a compass against that of the strapdown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Field and offset.
    pub sighting: Sighting,
    /// Where the strapdown was, m.
    pub way_m: Vector3<f64>,
    /// Direction of the body from magnetic north by the compass, rad.
    pub direction_rad: f64,
    /// Standard deviation of the offset, rad; none where norm and dip are not the Earth's, or the place has been seen.
    pub sigma_rad: Option<f64>,
}

impl Foot {
    /// By the settings.
    pub fn new(params: &FusedParams) -> Result<Self, MethodError> {
        let compass = params.compass.then(|| {
            let params = Arc::new(params.marg.clone());
            Box::new(StanceCompass {
                compass: Compass::new(&params),
                params,
                began_good: false,
                places_rad2: PLACES_RAD * PLACES_RAD,
                usual: None,
                used: 0,
                seen: None,
            })
        });
        Ok(Self {
            ins: Box::new(FootIns::new(params.foot.clone())?),
            heading_rad: 0.0,
            stood: false,
            standing_s: 0.0,
            compass,
        })
    }

    /// One observation in, at most one solution out.
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        if let (Observation::Magnetic(magnetic), Some(own)) = (observation, &mut self.compass)
            && magnetic.is_reading()
        {
            own.compass.push(*magnetic);
        }
        let solution = self.ins.observe(observation)?;
        self.stand(solution.as_ref());
        Ok(solution)
    }

    /// A further solution that is due, if any.
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        let solution = self.ins.next_due()?;
        self.stand(solution.as_ref());
        Ok(solution)
    }

    /// After the last observation.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        let solution = self.ins.finish_next()?;
        self.stand(solution.as_ref());
        Ok(solution)
    }

    /// Somebody else holds place and heading: from each stance on they count anew.
    #[inline]
    pub fn hand_over(&mut self) {
        let (still, interval_s) = self.ins.last_sample();
        let lifted = self.stood && !still;
        self.stood = still;
        self.standing_s = if still { self.standing_s + interval_s } else { 0.0 };
        if lifted || self.standing_s > STANDING_S {
            self.standing_s = 0.0;
            self.ins.set_origin();
        }
    }

    /// The heading that the compass has just told, once.
    pub fn seen(&mut self) -> Option<Seen> {
        self.compass.as_mut()?.seen.take()
    }

    /// Hears by how much it was off, rad, and of which variance that was to be expected without its own noise, rad².
    pub fn note(&mut self, seen: &Seen, off_rad: f64, expected_rad2: f64) {
        if let (Some(own), Some(sigma_rad)) = (&mut self.compass, seen.sigma_rad) {
            own.learn(seen, sigma_rad * sigma_rad, off_rad * off_rad, expected_rad2);
        }
    }

    /// Whether its heading at the start is that of the Earth's field.
    pub fn is_magnetic(&self) -> bool {
        self.ins.report().magnetic_heading && self.compass.as_ref().is_none_or(|own| own.began_good)
    }

    /// What the solution with this stance shows.
    #[inline]
    fn stand(&mut self, solution: Option<&Solution>) {
        let Some(now) = solution else { return };
        let (still, interval_s) = self.ins.last_sample();
        if still {
            self.heading_rad = attitude::heading(&now.attitude);
        }
        if let Some(own) = &mut self.compass {
            own.stand(now, still, interval_s, self.heading_rad);
        }
    }
}

impl StanceCompass {
    fn stand(&mut self, now: &Solution, still: bool, interval_s: f64, heading_rad: f64) {
        let Self { params, compass, began_good, places_rad2, usual, seen, .. } = self;
        let level = |field_ut: &Vector3<f64>| now.attitude * field_ut;
        compass.gather(now.time, interval_s, still, level, params.heading.settle_s);
        if !still {
            return;
        }
        let Some(sighting) = compass.sight(params, &now.position_m) else { return };
        let tilt_rad2 = 0.5 * (now.covariance[(6, 6)] + now.covariance[(7, 7)]);
        let tilt_rad = libm::sqrt(params.heading.tilt_sigma_rad * params.heading.tilt_sigma_rad + tilt_rad2);
        if !compass.is_started() {
            compass.start(&sighting.field, tilt_rad, params);
            *began_good = !compass.is_disturbed();
        }
        let good = compass.judge(&sighting);
        if !good {
            compass.note(&sighting, Outcome::Disturbed, &now.position_m);
        }
        let field = &sighting.field;
        let (norm_ut, dip_rad) = *usual.get_or_insert((field.norm_ut, field.dip_rad));
        let (longer_ut, steeper_ut) = (field.norm_ut - norm_ut, norm_ut * (field.dip_rad - dip_rad));
        // What steel adds across the meridian is as large as what shows of it; iron that goes with the tag shows too.
        let steel_ut2 =
            0.5 * (longer_ut * longer_ut + steeper_ut * steeper_ut - 4.0 * IRON_UT * IRON_UT).max(0.0);
        let sigma_rad = libm::sqrt(*places_rad2 + steel_ut2 / (field.horizontal_ut * field.horizontal_ut));
        let new = compass.is_new(&now.position_m, params);
        let direction_rad = heading_rad + sighting.heading_offset_rad - params.declination_rad;
        let sigma_rad = (good && new).then_some(sigma_rad);
        *seen = Some(Seen { sighting, way_m: now.position_m, direction_rad, sigma_rad });
    }

    /// The variance of an innovation less what the estimate has of it is that of the compass (Mehra 1972), each by what it tells of it.
    fn learn(&mut self, seen: &Seen, told_rad2: f64, off_rad2: f64, expected_rad2: f64) {
        let whole_rad2 = told_rad2 + expected_rad2;
        let outcome = if off_rad2 <= MOST_OFF * whole_rad2 { Outcome::Used } else { Outcome::Disagreed };
        self.compass.note(&seen.sighting, outcome, &seen.way_m);
        let own = self.places_rad2 / whole_rad2;
        let steel_rad2 = told_rad2 - self.places_rad2;
        let found_rad2 = off_rad2.min(MOST_OFF * whole_rad2) - expected_rad2 - steel_rad2;
        if let (Some((norm_ut, dip_rad)), Outcome::Used) = (&mut self.usual, outcome) {
            let field = &seen.sighting.field;
            self.used = self.used.saturating_add(1);
            let share = 1.0 / f64::from(self.used).min(HEADINGS);
            *norm_ut += (field.norm_ut - *norm_ut) * share;
            *dip_rad += (field.dip_rad - *dip_rad) * share;
        }
        let learnt_rad2 = self.places_rad2 + (found_rad2 - self.places_rad2) * own * own / HEADINGS;
        self.places_rad2 = learnt_rad2.max(LEAST_RAD * LEAST_RAD);
    }
}
