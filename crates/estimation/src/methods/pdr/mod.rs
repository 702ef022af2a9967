//! `pdr`: pedestrian dead reckoning of a tag worn anywhere: steps, their length, their direction (system S1 has it as its half).
//!
//! ```text
//! specific force  → steps (pedestrian::steps), their length (pedestrian::step_length)    ┐
//! gyro, acc, mag  → attitude (the estimator of ahrs) → direction of the step (course)    ┴→ filter (walker)
//! position fixes  → where and which way on the map (search), then measurements of position ──────┘
//! signal strengths → scans → position fixes (radio), where something is known of the radio of the site
//! ```
//!
//! One solution for every step and, while nobody walks, one a second; between two steps a straight line is as good as
//! anything that could be told (a solution a sample would cost more than all the rest and say no more). Solutions come late,
//! with the step ([`crate::pedestrian::steps`]): 0.6 s in steady walking, 2 to 3 s at the beginning of a walk. Fixes may come
//! later than that: one of the last half minute is held against where the walker was at its time.
//!
//! Frames: body to ENU, or the frame of the fixes; level: the height is zero and its variance is not told. Heading by
//! magnetometer, else the body's x axis is north at the start, until fixes tell. Without a gyro (accelerometer alone) the
//! path goes straight along the heading of the start.
//! Limits: walks forward, not sideways or backward; stairs count as level steps.

pub mod course;
mod fixes;
mod method;
mod params;
pub(crate) mod radio;
pub mod search;
pub mod walker;

pub use method::PdrReport;
pub use params::{Direction, FixParams, PdrNoise, PdrParams, PdrRadio};

use crate::methods::ahrs::Ahrs;
use crate::methods::{MethodError, MethodWarning};
use crate::pedestrian::steps::{Step, StepDetector};
use crate::pedestrian::trail::Trail;
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::{Interval, Time};
use adit_observation::{AccelerationSample, ImuSample, Observation};
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use course::{Course, TURNED_OVER_RAD};
use fixes::HeldFix;
use radio::RadioFixes;
use search::{Search, UNKNOWN_RAD};
use serde::{Deserialize, Serialize};
use walker::{EAST, FACTOR, Stretch, Walker};

/// Name of the method.
const NAME: &str = "pdr";
/// A field is looked at no more often: what it is off by lasts for seconds.
const FIELD: Interval = Interval::from_nanos(39_000_000);
/// Solutions of somebody who stands.
const STANDING: Interval = Interval::from_nanos(1_000_000_000);

/// One walker, streaming.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Pdr {
    params: PdrParams,
    attitude: Ahrs,
    course: Course,
    detector: StepDetector,
    walker: Walker,
    /// What becomes of the first fixes, while the frame of the walk is its own.
    search: Option<Search>,
    /// True once the walker stands on the map: by a start or by fixes.
    placed: bool,
    /// True once the first direction is set.
    directed: bool,
    /// Time of the last inertial sample.
    latest: Option<Time>,
    /// Time of the last magnetic sample used.
    field: Option<Time>,
    /// Time of the state.
    time: Option<Time>,
    velocity_m_s: Vector2<f64>,
    /// Time of the last solution, and of the last fix used.
    told: Option<Time>,
    fixed: Option<Time>,
    /// Outliers among the fixes, one after the other; by radio each for what is new in it.
    outliers: f64,
    /// The way of the last seconds.
    trail: Trail,
    /// Fixes that wait for the state, in order of time.
    held: VecDeque<HeldFix>,
    /// Positions by the radio of the site, where something is known of it.
    radio: Option<Box<RadioFixes>>,
    due: VecDeque<Solution>,
    report: PdrReport,
}

impl Pdr {
    /// A walker of whom nothing is known but the settings.
    pub fn new(params: PdrParams) -> Result<Self, MethodError> {
        if let Some(name) = params.unusable() {
            return Err(MethodError::Setting { method: NAME, name });
        }
        let offset_sigma_rad =
            if params.direction == Direction::Mounted { params.noise.mounting_rad } else { UNKNOWN_RAD };
        let mut walker = Walker::new(&params.noise, offset_sigma_rad);
        if let Some(start) = &params.start {
            walker.position_m = Vector2::from(start.position_m);
            let [east, north] = start.position_sigma_m;
            walker.spread(&Matrix2::new(east * east, 0.0, 0.0, north * north));
        }
        Ok(Self {
            attitude: Ahrs::new(params.attitude.clone())?,
            course: Course::default(),
            detector: StepDetector::new(&params.steps),
            walker,
            search: None,
            placed: params.start.is_some(),
            directed: false,
            latest: None,
            field: None,
            time: None,
            velocity_m_s: Vector2::zeros(),
            told: None,
            fixed: None,
            outliers: 0.0,
            trail: Trail::default(),
            held: VecDeque::new(),
            radio: RadioFixes::new(&params)?.map(Box::new),
            due: VecDeque::new(),
            report: PdrReport::default(),
            params,
        })
    }

    /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match observation {
            Observation::Imu(imu) => self.inertial(observation, imu)?,
            Observation::Acceleration(sample) => self.acceleration(sample)?,
            Observation::Magnetic(magnetic) if self.is_field_due(magnetic.time) => {
                self.field = Some(magnetic.time);
                self.attitude.observe_with(observation, &mut self.course)?;
            }
            Observation::Fix(fix) => {
                self.report.fixes += 1;
                self.take(HeldFix { fix: *fix, by_radio: false });
            }
            Observation::Signal(signal) => {
                if let Some(radio) = &mut self.radio {
                    radio.observe(signal);
                    self.hear(signal.time);
                }
            }
            _ => {}
        }
        Ok(self.next_due())
    }

    /// A further solution that the observations so far make due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Option<Solution> {
        let due = self.due.pop_front();
        if self.due.is_empty() {
            // What was due at once at the beginning is not again.
            self.due.shrink_to(1);
        }
        due
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        let Some(latest) = self.latest else { return Err(MethodError::Empty) };
        while let Some(fix) = self.radio.as_mut().and_then(|radio| radio.finish()) {
            self.take(HeldFix { fix, by_radio: true });
        }
        if let Some(radio) = &self.radio {
            self.report.note_radio(radio.report());
        }
        if self.time < self.latest {
            if self.attitude.has_begun() {
                while self.attitude.finish_next_with(&mut self.course)?.is_some() {}
            }
            self.detector.end();
            self.settle()?;
            self.stand(latest)?;
            if self.told < self.latest {
                self.tell(latest)?;
            }
        }
        Ok(self.due.pop_front())
    }

    /// What the run did so far.
    pub fn report(&self) -> &PdrReport {
        &self.report
    }

    /// Position, offset and factor with their covariance.
    pub fn walker(&self) -> &Walker {
        &self.walker
    }

    #[inline]
    fn is_field_due(&self, time: Time) -> bool {
        self.field.is_none_or(|before| time < before || time - before >= FIELD)
    }

    #[inline]
    fn inertial(&mut self, observation: &Observation, imu: &ImuSample) -> Result<(), MethodError> {
        let mut done = self.attitude.observe_with(observation, &mut self.course)?;
        while done.is_some() {
            done = self.attitude.next_due_with(&mut self.course)?;
        }
        self.force(imu.time, &imu.specific_force_m_s2)
    }

    /// A sample without a gyro: steps, but no direction.
    fn acceleration(&mut self, sample: &AccelerationSample) -> Result<(), MethodError> {
        let AccelerationSample { time, specific_force_m_s2 } = *sample;
        if !sample.is_reading() {
            return Err(MethodError::NoReading { time });
        }
        if let Some(before) = self.latest
            && time <= before
        {
            return Err(MethodError::TimeNotRising { found: time, before });
        }
        if !self.report.no_gyro {
            self.report.no_gyro = true;
            self.report.warn(MethodWarning::NoGyro);
        }
        self.force(time, &specific_force_m_s2)
    }

    /// What gyro or not, the accelerometer says: steps.
    #[inline]
    fn force(&mut self, time: Time, specific_force_m_s2: &Vector3<f64>) -> Result<(), MethodError> {
        self.report.samples += 1;
        match self.latest.replace(time) {
            None => {
                self.time = Some(time);
                self.trail.push(time, self.walker.way_m);
                self.tell(time)?;
            }
            Some(before) => {
                let length_s = (time - before).seconds();
                if length_s > self.params.steps.gap_s {
                    self.bridge(before, time, length_s)?;
                }
            }
        }
        if self.detector.observe(time, specific_force_m_s2) {
            self.hear(time);
            self.settle()?;
        }
        Ok(())
    }

    /// Takes the steps that are due, and the time until which there are no others.
    fn settle(&mut self) -> Result<(), MethodError> {
        while let Some(step) = self.detector.pop() {
            self.step(&step)?;
        }
        if let Some(settled) = self.detector.settled()
            && !self.detector.is_walking()
        {
            self.velocity_m_s = Vector2::zeros();
            self.stand(settled)?;
        }
        if let Some(time) = self.time {
            self.course.forget(time);
        }
        Ok(())
    }

    /// One step: stand until it begins, then walk it, with the fixes on the way.
    fn step(&mut self, step: &Step) -> Result<(), MethodError> {
        let period = Interval::from_seconds(step.period_s).unwrap_or_default();
        self.stand(step.time - period)?;
        let begin = self.time.unwrap_or(step.time);
        let heading_rad = self.direct(begin, step);
        let noise = &self.params.noise;
        let stretch = Stretch {
            length_m: self.params.length.length_m(step),
            share_sigma: if step.seen { noise.step_share } else { noise.unseen_share },
            heading_rad,
            direction_rad: noise.step_direction_rad,
            part: 1.0,
        };
        let length_s = (step.time - begin).seconds();
        let mut walked = 0.0;
        while let Some(held) = self.next_held(step.time) {
            let time = held.fix.time;
            let until = if length_s > 0.0 { (time - begin).seconds() / length_s } else { 1.0 };
            self.walk(&Stretch { part: (until - walked).max(0.0), ..stretch });
            walked = until.max(walked);
            self.correct(&held);
            self.tell(time)?;
        }
        self.walk(&Stretch { part: (1.0 - walked).max(0.0), ..stretch });
        self.time = Some(step.time.max(begin));
        self.trail.push(step.time.max(begin), self.walker.way_m);
        let (sin, cos) = libm::sincos(heading_rad + self.walker.offset_rad);
        let speed_m_s = self.walker.factor * stretch.length_m / step.period_s;
        self.velocity_m_s = Vector2::new(sin, cos) * speed_m_s;
        self.report.note_step(step, &self.walker);
        self.tell(step.time)
    }

    fn walk(&mut self, stretch: &Stretch) {
        let displacement = self.walker.walk(&self.params.noise, stretch);
        self.report.distance_m += displacement.norm();
    }

    /// Heading of the tag over the stride around a step, and all that follows from it.
    fn direct(&mut self, begin: Time, step: &Step) -> f64 {
        let noise = &self.params.noise;
        let half = Interval::from_seconds(0.5 * step.period_s).unwrap_or_default();
        let (from, to) = (begin - half, step.time + half);
        let Some(heading) = self.course.heading(from, to) else {
            // No gyro: straight along the start.
            if !self.directed {
                self.directed = true;
                self.walker.offset_rad =
                    self.params.start.map_or(0.0, |start| start.heading_deg.to_radians());
            }
            return 0.0;
        };
        if let Some(leg) = self.course.at(step.time) {
            let (variance, magnetic, north) = (leg.covariance_rad2[(2, 2)], leg.magnetic, leg.north);
            self.walker.follow(noise, variance, magnetic, step.period_s);
            if !self.directed {
                self.directed = true;
                self.begin(heading.heading_rad, north);
                self.look();
            }
        }
        if heading.turned_over {
            self.walker.doubt_offset(TURNED_OVER_RAD);
            self.report.turned_over += 1;
        }
        if self.params.direction == Direction::PrincipalAxis
            && let Some(axis_rad) = self.course.principal_axis_rad(to)
        {
            let sigma_rad = self.params.noise.principal_axis_rad;
            self.walker.align_axis(heading.heading_rad, axis_rad, sigma_rad);
        }
        heading.heading_rad
    }

    /// The first direction: what north is, where no magnetometer tells.
    fn begin(&mut self, heading_rad: f64, magnetic: bool) {
        self.report.magnetic_heading = magnetic;
        if !self.course.is_forward_x() && self.params.direction == Direction::Mounted {
            self.report.warn(MethodWarning::SteepForward);
        }
        if magnetic {
            if self.params.direction != Direction::Mounted {
                self.report.warn(MethodWarning::ForwardUnknown);
            }
            return;
        }
        if let Some(start) = &self.params.start {
            let at_start = self.course.first_heading_rad().unwrap_or(heading_rad);
            self.walker.offset_rad = start.heading_deg.to_radians() - at_start;
            self.walker.doubt_offset(start.attitude_sigma_deg.to_radians());
            return;
        }
        self.report.warn(MethodWarning::NoMagnetometer);
        if self.params.direction != Direction::Mounted {
            // The first step counts as north.
            self.walker.offset_rad = -heading_rad;
            self.walker.settle_offset(self.params.noise.step_direction_rad);
        }
    }

    /// Nobody walks until then.
    fn stand(&mut self, until: Time) -> Result<(), MethodError> {
        while let Some(time) = self.time.filter(|time| *time < until) {
            let held = self.next_held(until);
            let tick = self.told.map_or(until, |told| told + STANDING);
            let target = held.map_or(until, |held| held.fix.time).min(tick.max(time)).max(time);
            let sigma = self.params.noise.standing_m_sqrt_s;
            let drift = Matrix2::identity() * (sigma * sigma * (target - time).seconds());
            self.walker.spread(&drift);
            self.time = Some(target);
            self.trail.push(target, self.walker.way_m);
            let mut due = target >= tick;
            match held {
                Some(held) if held.fix.time <= target => {
                    self.correct(&held);
                    due = true;
                }
                Some(held) => self.held.push_front(held),
                None => {}
            }
            if due {
                self.tell(target)?;
            }
        }
        Ok(())
    }

    /// Nothing is known of a gap but how people move.
    fn bridge(&mut self, before: Time, time: Time, length_s: f64) -> Result<(), MethodError> {
        self.detector.end();
        self.settle()?;
        self.stand(before)?;
        self.report.warn(MethodWarning::Gap { time, length_s });
        let distance_m = self.params.noise.gap_speed_m_s * length_s;
        self.walker.spread(&(Matrix2::identity() * (distance_m * distance_m)));
        self.velocity_m_s = Vector2::zeros();
        self.trail.clear();
        self.trail.push(time, self.walker.way_m);
        self.time = Some(time);
        self.told = Some(time);
        Ok(())
    }

    /// Puts the state out as a solution.
    fn tell(&mut self, time: Time) -> Result<(), MethodError> {
        if self.told.is_some_and(|told| time <= told) {
            return Ok(());
        }
        let placed = self
            .search
            .as_ref()
            .filter(|search| !search.is_empty())
            .map(|search| search.place(&self.walker, self.direction_variance()));
        let walker = placed.as_ref().unwrap_or(&self.walker);
        if !walker.is_finite() {
            return Err(MethodError::Diverged { time });
        }
        let leg = self.course.at(time);
        let mut covariance = SolutionCovariance::zeros();
        let position = walker.covariance.fixed_view::<2, 2>(EAST, EAST);
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&position);
        let speed_m_s = self.velocity_m_s.norm();
        if speed_m_s > 0.0 {
            let along = self.velocity_m_s / speed_m_s;
            let across = Vector2::new(along.y, -along.x);
            let share = self.params.noise.step_share;
            let long = walker.covariance[(FACTOR, FACTOR)] / (walker.factor * walker.factor) + share * share;
            let wide = walker.direction_variance();
            let spread = along * along.transpose() * long + across * across.transpose() * wide;
            covariance.fixed_view_mut::<2, 2>(3, 3).copy_from(&(spread * (speed_m_s * speed_m_s)));
        }
        if let Some(leg) = leg {
            covariance.fixed_view_mut::<3, 3>(6, 6).copy_from(&leg.covariance_rad2);
        }
        let held_by_fix = self.fixed.is_some_and(|fixed| {
            (time - fixed).seconds() <= self.params.fixes.hold_s && self.search.is_none()
        });
        self.told = Some(time);
        self.due.push_back(Solution {
            time,
            position_m: Vector3::new(walker.position_m.x, walker.position_m.y, 0.0),
            velocity_m_s: Vector3::new(self.velocity_m_s.x, self.velocity_m_s.y, 0.0),
            attitude: leg.map_or_else(|| self.unknown_attitude(), |leg| leg.attitude),
            covariance,
            quality: if held_by_fix { Quality::Fixed } else { Quality::DeadReckoning },
        });
        Ok(())
    }

    /// Without a gyro: level, along the path.
    fn unknown_attitude(&self) -> Attitude {
        attitude::level(&Vector3::z(), self.walker.offset_rad).unwrap_or_default()
    }
}
