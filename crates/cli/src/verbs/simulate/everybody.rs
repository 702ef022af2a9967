//! Everybody in a mine: a folder for each person, made in parallel; the same bytes on any number of threads.

use super::person::{self, Simulated};
use super::{beside, told};
use crate::args::SimulateArgs;
use crate::output::{self, tell};
use crate::progress::{Progress, Unit};
use crate::scenario_file::{Everybody, Scenario};
use adit_core::time::Interval;
use adit_simulation::people::Person;
use anyhow::{Context, Result};
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// What a log and its truth take for each inertial sample, with radio beside it, bytes; for a warning.
const BYTES_PER_SAMPLE: f64 = 110.0;
/// More than this is worth a word before it begins, GB.
const LARGE_GB: f64 = 5.0;

/// Simulates the people asked for and says what was made.
pub fn run(args: &SimulateArgs, scenario: &Scenario, seed: u64) -> Result<()> {
    let begun = Instant::now();
    let everybody = scenario.everybody(seed)?;
    let count = everybody.workforce.len();
    let wanted = match args.people {
        None => 1..=count,
        Some(people) => people.within(count).with_context(|| {
            format!("{}: --people {people}: there are {count} people in this mine", args.scenario.display())
        })?,
    };
    output::make_folder(&args.out)?;
    let plan = adit_mine::file::to_json(everybody.workforce.mine().plan())?;
    output::write_file(&args.out.join("mine.json"), &plan)?;

    let duration_s = everybody.workforce.spec().duration_s;
    let samples = duration_s * everybody.workforce.spec().outfit.imu_hz * wanted.clone().count() as f64;
    let gigabytes = samples * BYTES_PER_SAMPLE / 1e9;
    if gigabytes > LARGE_GB {
        let people = wanted.clone().count();
        tell(&format!(
            "adit: the logs of {people} people will take about {gigabytes:.0} GB; --people writes some\n"
        ));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float saturates; for a bar"
    )]
    let progress = Progress::new("simulating", Unit::Samples, Some(samples as u64));
    let truth_every = Interval::from_seconds(1.0 / everybody.truth_hz).unwrap_or(Interval::ZERO);
    let alone = count == 1;
    let numbers: Vec<usize> = wanted.collect();
    let made = numbers
        .into_par_iter()
        .map(|number| {
            let folder = if alone { args.out.clone() } else { args.out.join(name(number)) };
            let run = everybody.person(number - 1)?;
            let doings = doings(run.emissions.wearer(), duration_s);
            let made = person::write(run, &folder, truth_every, &progress)?;
            output::write_file(&folder.join("activities.csv"), &doings)?;
            Ok((number, made))
        })
        .collect::<Result<Vec<_>>>()?;
    drop(progress);
    if alone {
        return output::print(&made.iter().map(|(_, made)| told(made)).collect::<String>());
    }
    output::write_file(&args.out.join("people.csv"), &people(&everybody, &made, &args.out))?;
    output::print(&summary(&made, duration_s, &args.out, begun.elapsed().as_secs_f64()))
}

/// Folder of a person.
fn name(number: usize) -> String {
    format!("p{number:03}")
}

/// What somebody does from when on.
fn doings(person: &Person, duration_s: f64) -> String {
    let mut text = "time_s,activity\n".to_owned();
    for (time_s, activity) in person.episodes().take_while(|(time_s, _)| *time_s <= duration_s) {
        let _ = writeln!(text, "{time_s:.3},{}", activity.name());
    }
    text
}

/// Who is who.
fn people(everybody: &Everybody, made: &[(usize, Simulated)], folder: &Path) -> String {
    let mut text = "person,log,height_m,walk_m_s,samples,signals,ranges,sightings\n".to_owned();
    for (number, made) in made {
        let Some(person) = everybody.workforce.person(number - 1) else { continue };
        let (body, counts) = (person.body(), &made.counts);
        let log = made.log.strip_prefix(folder).unwrap_or(&made.log).display();
        let _ = writeln!(
            text,
            "{},{log},{:.3},{:.3},{},{},{},{}",
            name(*number),
            body.height_m,
            body.walk_m_s,
            counts.inertial,
            counts.signals,
            counts.ranges,
            counts.sightings
        );
    }
    text
}

fn summary(made: &[(usize, Simulated)], duration_s: f64, folder: &Path, took_s: f64) -> String {
    let counts = made.iter().fold(super::Counts::default(), |sum, (_, made)| sum.and(&made.counts));
    let worst = made.iter().map(|(_, made)| made.worst).max_by(|a, b| a.norm_ut.total_cmp(&b.norm_ut));
    let people = made.len();
    let speed = people as f64 * duration_s / took_s;
    let mut text = format!(
        "{}: {people} people over {duration_s:.1} s, {} samples\n",
        folder.display(),
        counts.inertial
    );
    for line in beside(&counts, &worst.unwrap_or_default()) {
        let _ = writeln!(text, "  with {line}");
    }
    let _ = writeln!(
        text,
        "each in a folder of its own: log.mcap, truth.tum, activities.csv; people.csv, mine.json"
    );
    let _ = writeln!(text, "took {took_s:.1} s: {speed:.0} person-seconds a second");
    text
}
