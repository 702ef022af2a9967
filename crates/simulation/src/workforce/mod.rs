//! Everybody in a mine with a tag on: people, what they wear, the radio around them, and how it all gets into logs.
//!
//! [`Workforce`] joins [`crate::people`], the sensors, [`crate::radio`] and the delivery; [`Workforce::stream`] gives the log of one
//! person as an iterator, sample by sample, in bounded memory:
//!
//! ```text
//! motion → IMU, magnetometer, barometer ───────────────┐
//!        → antenna, others near by → scans, ranges, portals → delivery ─┴→ Emission, Emission, …
//! ```
//!
//! What the tag measures on its own (IMU, magnetometer, barometer) stands in the log in order of time; what comes by radio, in order of
//! **arrival**: late, twice or not at all. All stamps are those of the tag's clock; truth has true time.
//!
//! Every random draw is keyed by seed, person and purpose, so that streams can be made in any order, on any number of threads, and
//! one person's log does not depend on how many others are simulated beside them, but for who stands in the way of whose radio.

mod crowd;
mod outfit;
mod preset;
mod stream;

pub use outfit::{Mount, Outfit, RadioRates, Worn};
pub use stream::TagStream;

use crate::error::{SimulationError, check_within};
use crate::motion::Motion;
use crate::people::{Person, Population, PopulationSpec};
use crate::pressure::{AirSpec, MineAir, Passage};
use crate::radio::delivery::{ClockSpec, LinkSpec};
use crate::radio::{Outage, RadioSpec, RadioWorld};
use crate::told_start::{StartErrors, ToldStart};
use adit_mine::Mine;
use crowd::Crowd;
use std::sync::Arc;

/// `ChaCha8` streams of what is told of a person's start.
const START_STREAM: u64 = 1 << 41;

/// Who works in a mine, what they wear, and what may go wrong with its radio.
#[derive(Debug, Clone)]
pub struct WorkforceSpec {
    /// How long it is simulated, s.
    pub duration_s: f64,
    /// People and vehicles.
    pub population: PopulationSpec,
    /// What everybody wears.
    pub outfit: Outfit,
    /// The air of the mine.
    pub air: AirSpec,
    /// The radio of the mine.
    pub radio: RadioSpec,
    /// What fails when.
    pub outages: Vec<Outage>,
    /// When the conveyors run: from, until, s.
    pub conveyors_s: Vec<[f64; 2]>,
    /// The clock of a tag.
    pub clock: ClockSpec,
    /// The way from radio to log.
    pub link: LinkSpec,
}

/// A mine with everybody in it; shared by the streams of all.
#[derive(Debug, Clone)]
pub struct Workforce {
    spec: WorkforceSpec,
    seed: u64,
    mine: Arc<Mine>,
    radio: RadioWorld,
    population: Population,
    crowd: Crowd,
    air: Option<Arc<MineAir>>,
}

impl Workforce {
    /// Checks everything, makes the vehicles and everybody's itinerary.
    pub fn new(mine: Arc<Mine>, spec: WorkforceSpec, seed: u64) -> Result<Arc<Self>, SimulationError> {
        check_within("duration_s", spec.duration_s, 0.1, 1e6, "0.1 to 1e6 s")?;
        for [from_s, until_s] in &spec.conveyors_s {
            check_within(
                "conveyors_s",
                *until_s,
                *from_s,
                f64::INFINITY,
                "an end no earlier than the beginning",
            )?;
        }
        spec.outfit.check()?;
        let radio = RadioWorld::new(Arc::clone(&mine), &spec.radio, &spec.outages, seed)?;
        let population = Population::new(&mine, &spec.population, seed)?;
        let crowd = Crowd::new(&population, spec.radio.body.shades)?;
        // Only who reads a barometer needs the air, and everybody's passages through doors.
        let air = if spec.outfit.barometer.is_some() {
            let mut air = MineAir::new(&mine, &spec.air, seed)?;
            let passages: Vec<Passage> = crowd.people().flat_map(|person| air.passages_of(person)).collect();
            air.open_doors(passages);
            Some(Arc::new(air))
        } else {
            None
        };
        Ok(Arc::new(Self { spec, seed, mine, radio, population, crowd, air }))
    }

    /// Number of people.
    pub fn len(&self) -> usize {
        self.population.len()
    }

    /// Nobody.
    pub fn is_empty(&self) -> bool {
        self.population.is_empty()
    }

    /// The mine.
    pub fn mine(&self) -> &Arc<Mine> {
        &self.mine
    }

    /// What was asked for.
    pub fn spec(&self) -> &WorkforceSpec {
        &self.spec
    }

    /// The people and vehicles.
    pub fn population(&self) -> &Population {
        &self.population
    }

    /// A person, by number from 0; `None` beyond the last.
    pub fn person(&self, index: usize) -> Option<&Arc<Person>> {
        self.crowd.person(index)
    }

    /// The log of a person, by number from 0; `None` beyond the last.
    pub fn stream(self: &Arc<Self>, person: usize) -> Option<Result<TagStream, SimulationError>> {
        self.crowd.person(person).map(|wearer| TagStream::new(self, wearer, person))
    }

    /// What is told of the start of a person's log, by number from 0; `None` beyond the last.
    pub fn told_start(&self, person: usize, errors: &StartErrors) -> Option<ToldStart> {
        let wearer = self.crowd.person(person)?;
        let start = Worn::new(wearer, self.spec.outfit.mount, self.spec.duration_s).at(0.0);
        let stream = START_STREAM + person as u64;
        Some(ToldStart::draw(&start.position_m, &start.attitude, errors, self.seed, stream))
    }

    /// Do the conveyors run?
    fn conveyors_run(&self, time_s: f64) -> bool {
        self.spec.conveyors_s.iter().any(|[from_s, until_s]| (*from_s..*until_s).contains(&time_s))
    }
}
