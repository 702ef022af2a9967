//! A suite: every part is compared, one report is written.
//!
//! A part is in memory while it runs; of those before only their figures and their section of the page are kept.

use super::conduct::{self, Conducted, Rules, Stamps};
use super::ranges::RangeReport;
use super::survey::{self, SurveyRuns};
use crate::args::CompareArgs;
use crate::method::MethodName;
use crate::output::{self, Target};
use crate::progress::{self, Progress, Unit};
use crate::scenario_file::Contest;
use crate::suite_file::{Part, PartSource, Suite};
use crate::verbs::recorded_set::SetRuns;
use crate::verbs::trials::Trials;
use adit_evaluation::alignment::Alignment;
use adit_evaluation::compare::{self as report, Figure, JudgedPart, Merit, SuitePart, part_html, suite_html};
use adit_evaluation::plot::DistributionCurve;
use adit_evaluation::statistics::Distribution;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use serde::Serialize;
use std::collections::BTreeMap;

/// Contenders in a figure: as many as there are colours.
const IN_FIGURES: usize = 7;

/// Runs every part and writes the report.
pub fn run(args: &CompareArgs) -> Result<()> {
    let mut suite = Suite::read(&args.source)?;
    if args.align.is_some() || args.from.is_some() {
        bail!("--align and --from have no use with a suite: each part says how it is judged");
    }
    let mut ready = Vec::with_capacity(suite.parts.len());
    for part in &mut suite.parts {
        let competes = choose(part, &args.methods);
        ready.push(if competes { runs_of(part, args.seeds)? } else { Runs::Nobody });
    }
    let all: usize = ready.iter().map(Runs::len).sum();
    let progress = Progress::new("comparing", Unit::Samples, Some(all as u64));
    let mut parts = Vec::with_capacity(suite.parts.len());
    let (mut sections, mut ranges) = (Vec::new(), Vec::new());
    for (part, runs) in suite.parts.iter().zip(&ready) {
        let (judged, section, of_ranges) = match runs {
            Runs::Tracks(trials) => compared(part, trials, &progress)?,
            Runs::Spots(runs) => {
                let place = || part.name.clone();
                let step = || progress.more(1);
                let (judged, mut curves) = survey::compared(part, runs, &step).with_context(place)?;
                curves.truncate(IN_FIGURES);
                let section = part_html(&judged, &[], &curves)?;
                (judged, section, Vec::new())
            }
            Runs::Nobody | Runs::NotAtHand(_) => {
                let judged = skipped(part, runs);
                progress::note(&format!("{}: {}", part.name, judged.skipped.as_deref().unwrap_or_default()));
                let section = part_html(&judged, &[], &[])?;
                (judged, section, Vec::new())
            }
        };
        parts.push(judged);
        sections.push(section);
        ranges.push(of_ranges);
    }
    drop(progress);
    let columns = columns(&parts);
    let (title, about) = (suite.title, suite.about);
    let suite = report::Suite { suite: args.source.display().to_string(), title, about, columns, parts };
    if let Some(path) = &args.out {
        output::write_file(path, &suite_html(&suite, &sections))?;
    }
    if let Some(target) = &args.json {
        target.write(&(serde_json::to_string_pretty(&Report::of(&suite, &ranges))? + "\n"))?;
        if *target == Target::Stdout {
            output::tell(&suite.to_string());
            return Ok(());
        }
    }
    output::print(&suite.to_string())
}

/// What a part runs on.
enum Runs {
    /// Logs with their truth.
    Tracks(Trials),
    /// Scans at known spots.
    Spots(SurveyRuns),
    /// A recorded set that is not there.
    NotAtHand(String),
    /// None of its contenders was chosen.
    Nobody,
}

impl Runs {
    fn len(&self) -> usize {
        match self {
            Self::Tracks(trials) => trials.len(),
            Self::Spots(runs) => runs.len(),
            Self::NotAtHand(_) | Self::Nobody => 0,
        }
    }
}

/// `--methods` chooses among the contenders; whether any is left.
fn choose(part: &mut Part, methods: &[MethodName]) -> bool {
    let chosen = |method: MethodName| methods.is_empty() || methods.contains(&method);
    if let PartSource::Survey(_) = part.source {
        return chosen(MethodName::Wifi);
    }
    part.contest.contenders.retain(|contender| chosen(contender.method));
    !part.contest.contenders.is_empty()
}

fn runs_of(part: &Part, seeds: Option<u32>) -> Result<Runs> {
    let place = || part.name.clone();
    let not_at_hand = |name: &str| Runs::NotAtHand(name.to_owned());
    Ok(match &part.source {
        PartSource::Simulated(scenario, _, own) => {
            let runs = seeds.unwrap_or(*own) as usize;
            Runs::Tracks(Trials::Simulated(scenario.clone(), scenario.seed, runs))
        }
        PartSource::Recorded(set) => {
            let runs = SetRuns::find(set).with_context(place)?;
            runs.map_or_else(|| not_at_hand(&set.name), |runs| Runs::Tracks(Trials::Set(Box::new(runs))))
        }
        PartSource::Survey(survey) => {
            let runs = SurveyRuns::find(survey).with_context(place)?;
            runs.map_or_else(|| not_at_hand(&survey.name), Runs::Spots)
        }
    })
}

fn skipped(part: &Part, runs: &Runs) -> SuitePart {
    let why = match runs {
        Runs::NotAtHand(name) => format!("SKIPPED (no test data): {name}"),
        _ => "SKIPPED: none of the chosen methods competes".to_owned(),
    };
    let (name, about, figure) = (part.name.clone(), part.about.clone(), part.figure);
    let (figure_words, unit) = (figure.words(), figure.unit());
    SuitePart { name, about, figure, figure_words, unit, skipped: Some(why), judged: None }
}

type Compared = (SuitePart, String, Vec<(String, RangeReport)>);

fn compared(part: &Part, trials: &Trials, progress: &Progress) -> Result<Compared> {
    let stamps = match trials {
        Trials::Set(runs) if runs.has_truth() => Stamps::Truth,
        Trials::Set(_) => Stamps::End,
        _ => Stamps::Solutions,
    };
    let contest = &part.contest;
    let alignment = match stamps {
        Stamps::End => Alignment::None,
        _ => contest.align.unwrap_or(Alignment::Se2),
    };
    let rules = Rules { stamps, alignment, moments: contest.moments };
    let place = || part.name.clone();
    let conducted = conduct::run_all(trials, contest, &rules, &|| progress.more(1)).with_context(place)?;
    let source = match &part.source {
        PartSource::Simulated(_, path, _) => path.display().to_string(),
        PartSource::Recorded(set) => set.folder.display().to_string(),
        PartSource::Survey(survey) => survey.folder.display().to_string(),
    };
    let (comparison, ranges) = conducted.summed_up(source, trials, contest, &rules).with_context(place)?;
    let merit = merits(&conducted, contest, part.figure);
    let names = (0..trials.len()).map(|index| trials.name(index)).collect();
    let judged = JudgedPart::new(comparison, names, merit, part.table(), conducted.warnings());
    let judged = SuitePart {
        name: part.name.clone(),
        about: part.about.clone(),
        figure: part.figure,
        figure_words: part.figure.words(),
        unit: part.figure.unit(),
        skipped: None,
        judged: Some(judged),
    };
    let mut shown = contest.contenders.clone();
    let mut room = IN_FIGURES;
    for contender in &mut shown {
        contender.in_figures &= room > 0;
        room -= usize::from(contender.in_figures);
    }
    let distributions: Vec<DistributionCurve> = shown
        .iter()
        .enumerate()
        .filter(|(_, contender)| contender.in_figures)
        .filter_map(|(nth, contender)| {
            let runs = conducted.runs.iter().filter_map(|run| run[nth].outcome.as_ref());
            let errors: Vec<f64> = runs.flat_map(|run| part.figure.errors(&run.errors)).collect();
            let distribution = Distribution::of(&errors)?;
            Some(DistributionCurve { label: contender.name.clone(), distribution })
        })
        .collect();
    let mut paths = conducted.first.curves(&shown);
    if paths.iter().all(|path| path.role == adit_evaluation::plot::Role::Truth) {
        paths.clear();
    }
    let section = part_html(&judged, &paths, &distributions).with_context(place)?;
    Ok((judged, section, ranges))
}

fn merits(conducted: &Conducted, contest: &Contest, figure: Figure) -> Vec<(String, Merit)> {
    let merit = |nth: usize| {
        let runs = conducted.runs.iter();
        Merit::of(runs.map(|run| figure.of(&run[nth].outcome.as_ref()?.errors)).collect())
    };
    contest
        .contenders
        .iter()
        .enumerate()
        .map(|(nth, contender)| (contender.name.clone(), merit(nth)))
        .collect()
}

/// The methods that stand in any row; `fused` first, the others in the order of the command line.
fn columns(parts: &[SuitePart]) -> Vec<String> {
    let entered = |method: &str| {
        parts.iter().filter_map(|part| part.judged.as_ref()).any(|part| part.of_method(method).is_some())
    };
    let names = MethodName::value_variants().iter().map(|method| method.name());
    let mut columns: Vec<String> = names.filter(|name| entered(name)).map(str::to_owned).collect();
    columns.sort_by_key(|name| name != "fused");
    columns
}

/// What `--json` writes: the suite, each part with what became of its ranges.
#[derive(Serialize)]
struct Report<'a> {
    suite: &'a str,
    title: &'a str,
    about: &'a str,
    columns: &'a [String],
    parts: Vec<PartReport<'a>>,
}

#[derive(Serialize)]
struct PartReport<'a> {
    #[serde(flatten)]
    part: &'a SuitePart,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    ranges: BTreeMap<&'a str, &'a RangeReport>,
}

impl<'a> Report<'a> {
    fn of(suite: &'a report::Suite, ranges: &'a [Vec<(String, RangeReport)>]) -> Self {
        let part = |(part, ranges): (&'a SuitePart, &'a Vec<(String, RangeReport)>)| PartReport {
            part,
            ranges: ranges.iter().map(|(name, report)| (name.as_str(), report)).collect(),
        };
        Self {
            suite: &suite.suite,
            title: &suite.title,
            about: &suite.about,
            columns: &suite.columns,
            parts: suite.parts.iter().zip(ranges).map(part).collect(),
        }
    }
}
