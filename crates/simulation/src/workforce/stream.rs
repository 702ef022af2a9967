//! The log of one person, sample by sample.

use super::Workforce;
use super::crowd::Neighbours;
use super::outfit::{Mount, Worn};
use crate::emission::Emission;
use crate::error::SimulationError;
use crate::marg::MargGenerator;
use crate::motion::Motion;
use crate::people::Person;
use crate::pressure::{Barometer, MineAir};
use crate::radio::delivery::{Delivery, DeviceClock, Stamped};
use crate::radio::{Antenna, RangeOutcome, Surroundings, Tag};
use crate::scenario::Generator;
use adit_observation::{Sighting, SignalStrength};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::collections::VecDeque;
use std::iter::Peekable;
use std::sync::Arc;

/// `ChaCha8` streams of the moments at which a tag uses its radios.
const PHASE_STREAM: u64 = 1 << 40;
/// Seeds of the sensors of one person; those of the next are far away.
const SENSOR_STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// Iterator over the log of one person; made by [`Workforce::stream`].
///
/// Memory: the person's steps (some megabytes for a shift), what is under way by radio, and the tag's picture of its surroundings.
#[derive(Debug, Clone)]
pub struct TagStream {
    wearer: Arc<Person>,
    worn: Arc<Worn>,
    local: Peekable<Local>,
    radio: Peekable<Delivery<Radios>>,
    clock: DeviceClock,
}

impl TagStream {
    pub(super) fn new(
        workforce: &Arc<Workforce>,
        wearer: &Arc<Person>,
        person: usize,
    ) -> Result<Self, SimulationError> {
        let spec = workforce.spec();
        let (seed, number) = (workforce.seed, person as u64);
        let worn = Arc::new(Worn::new(wearer, spec.outfit.mount, spec.duration_s));
        let local = Local::new(workforce, &worn, number)?;
        let radios = Radios::new(Arc::clone(workforce), Arc::clone(&worn), Arc::clone(wearer), person);
        let radio = Delivery::new(radios, &spec.clock, &spec.link, seed, number)?.peekable();
        // The same clock as that of the delivery: both are keyed by seed and person.
        let clock = DeviceClock::of_person(&spec.clock, seed, number)?;
        Ok(Self { wearer: Arc::clone(wearer), worn, local: local.peekable(), radio, clock })
    }

    /// Who wears the tag.
    pub fn wearer(&self) -> &Arc<Person> {
        &self.wearer
    }

    /// The motion of the tag.
    pub fn motion(&self) -> &Arc<Worn> {
        &self.worn
    }
}

impl Iterator for TagStream {
    type Item = Emission;

    /// What the tag measured or got next. A sample of the tag's own goes before what arrives at its time.
    fn next(&mut self) -> Option<Emission> {
        let local_s = self.local.peek().map(|emission| emission.time().seconds());
        let arrival_s = self.radio.peek().map(|delivered| delivered.arrival_s);
        let local_is_next = match (local_s, arrival_s) {
            (None, None) => return None,
            (Some(local_s), Some(arrival_s)) => local_s <= arrival_s,
            (local_s, _) => local_s.is_some(),
        };
        if local_is_next {
            let emission = self.local.next()?;
            let stamp = self.clock.stamp(emission.time().seconds());
            return Some(emission.stamped(stamp));
        }
        self.radio.next().map(|delivered| delivered.observation)
    }
}

/// What the tag measures on its own, in order of time; the barometer after the others.
#[derive(Debug, Clone)]
struct Local {
    workforce: Arc<Workforce>,
    inertial: Peekable<Inertial>,
    barometer: Option<Peekable<Barometer<Arc<Worn>, Arc<MineAir>>>>,
}

/// The IMU, with or without a magnetometer.
#[derive(Debug, Clone)]
enum Inertial {
    Imu(Box<Generator<Arc<Worn>>>),
    Marg(Box<MargGenerator<Arc<Worn>>>),
}

impl Local {
    fn new(workforce: &Arc<Workforce>, worn: &Arc<Worn>, person: u64) -> Result<Self, SimulationError> {
        let outfit = &workforce.spec().outfit;
        let seed = workforce.seed.wrapping_add(SENSOR_STEP.wrapping_mul(person));
        let imu = Generator::new(Arc::clone(worn), outfit.ideal, outfit.imu_hz, &outfit.imu, seed)?;
        let inertial = match &outfit.magnetic {
            None => Inertial::Imu(Box::new(imu)),
            Some((world, model)) => {
                Inertial::Marg(Box::new(imu.with_magnetometer(world.clone(), model, seed)?))
            }
        };
        let barometer = match (&outfit.barometer, &workforce.air) {
            (Some(model), Some(air)) => {
                Some(Barometer::new(Arc::clone(worn), Arc::clone(air), model, seed)?.peekable())
            }
            _ => None,
        };
        Ok(Self { workforce: Arc::clone(workforce), inertial: inertial.peekable(), barometer })
    }
}

impl Local {
    /// Whatever is due next, said or not.
    #[inline]
    fn due(&mut self) -> Option<Emission> {
        if let Some(barometer) = &mut self.barometer
            && let Some((pressure, _)) = barometer.peek()
            && self.inertial.peek().is_none_or(|other| pressure.time < other.time())
        {
            return barometer.next().map(|(sample, truth)| Emission::Pressure(sample, truth));
        }
        self.inertial.next()
    }
}

impl Iterator for Local {
    type Item = Emission;

    #[inline]
    fn next(&mut self) -> Option<Emission> {
        loop {
            let emission = self.due()?;
            let may_be_silent = matches!(emission, Emission::Magnetic(..) | Emission::Pressure(..));
            if !may_be_silent || !self.workforce.spec().outfit.is_silent(emission.time().seconds()) {
                return Some(emission);
            }
        }
    }
}

impl Iterator for Inertial {
    type Item = Emission;

    #[inline]
    fn next(&mut self) -> Option<Emission> {
        match self {
            Self::Imu(generator) => generator.next().map(|(sample, truth)| Emission::Imu(sample, truth)),
            Self::Marg(generator) => generator.next(),
        }
    }
}

/// One of a tag's radios: when it is used next.
#[derive(Debug, Clone, Copy)]
struct Beat {
    rate_hz: f64,
    /// Of the first use, in intervals: no two tags begin together.
    phase: f64,
    count: u64,
}

impl Beat {
    fn new(rate_hz: f64, rng: &mut ChaCha8Rng) -> Self {
        let phase = (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        Self { rate_hz, phase, count: 0 }
    }

    fn next_s(&self) -> f64 {
        if self.rate_hz > 0.0 { (self.count as f64 + self.phase) / self.rate_hz } else { f64::INFINITY }
    }
}

/// What comes by radio, in order of true time.
#[derive(Debug, Clone)]
struct Radios {
    workforce: Arc<Workforce>,
    worn: Arc<Worn>,
    wearer: Arc<Person>,
    person: usize,
    tag: Tag,
    neighbours: Neighbours,
    beats: [Beat; 3],
    made: VecDeque<Emission>,
    signals: Vec<SignalStrength>,
    ranges: Vec<RangeOutcome>,
    sightings: Vec<Sighting>,
}

impl Radios {
    fn new(workforce: Arc<Workforce>, worn: Arc<Worn>, wearer: Arc<Person>, person: usize) -> Self {
        let rates = workforce.spec().outfit.radio;
        let mut rng = ChaCha8Rng::seed_from_u64(workforce.seed);
        rng.set_stream(PHASE_STREAM + person as u64);
        let beats = [rates.scan_hz, rates.ranging_hz, rates.portal_hz].map(|hz| Beat::new(hz, &mut rng));
        let tag = workforce.radio.tag(person as u64).with_detail(rates.detail);
        Self {
            workforce,
            worn,
            wearer,
            person,
            tag,
            neighbours: Neighbours::default(),
            beats,
            made: VecDeque::new(),
            signals: Vec::new(),
            ranges: Vec::new(),
            sightings: Vec::new(),
        }
    }

    /// Uses the radio that is due first; `None` at the end of the simulation.
    fn use_next(&mut self) -> Option<()> {
        let due = |beat: &Beat| beat.next_s();
        let which =
            (0..self.beats.len()).min_by(|a, b| due(&self.beats[*a]).total_cmp(&due(&self.beats[*b])))?;
        let time_s = due(&self.beats[which]);
        if time_s > self.workforce.spec().duration_s {
            return None;
        }
        self.beats[which].count += 1;
        let position_m = self.worn.at(time_s).position_m;
        let antenna = Antenna { position_m, facing_rad: self.facing_rad(time_s) };
        let Self { workforce, tag, neighbours, signals, ranges, sightings, made, .. } = self;
        let surroundings = Surroundings {
            obstacles: neighbours.around(&workforce.crowd, self.person, &position_m, time_s),
            conveyors_run: workforce.conveyors_run(time_s),
        };
        let world = &workforce.radio;
        match which {
            0 => {
                tag.scan(world, time_s, &antenna, &surroundings, signals);
                made.extend(signals.drain(..).map(Emission::Signal));
            }
            1 => {
                tag.ranges(world, time_s, &antenna, &surroundings, ranges);
                made.extend(ranges.drain(..).map(Emission::from));
            }
            _ => {
                tag.sightings(world, time_s, &antenna, &surroundings, sightings);
                made.extend(sightings.drain(..).map(Emission::Sighting));
            }
        }
        Some(())
    }

    /// Which way the tag looks away from its wearer, clockwise from north; a foot shades nothing.
    fn facing_rad(&self, time_s: f64) -> Option<f64> {
        let Mount::Belt(belt) = self.workforce.spec().outfit.mount else { return None };
        let on_belt = libm::atan2(belt.offset_m.y, belt.offset_m.x);
        Some(core::f64::consts::FRAC_PI_2 - (self.wearer.at(time_s).yaw_rad + on_belt))
    }
}

impl Iterator for Radios {
    type Item = Emission;

    fn next(&mut self) -> Option<Emission> {
        while self.made.is_empty() {
            self.use_next()?;
        }
        self.made.pop_front()
    }
}
