//! Contenders of a scenario, seed by seed, through the binary: `adit simulate`, `adit track`, and each moment next to the truth.

#[path = "binary.rs"]
mod binary;

use adit_core::attitude;
use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::{Alignment, RigidMotion, align};
use adit_evaluation::association::{Association, associate};
use adit_evaluation::consistency::normalised_squared_error;
use adit_mine::Mine;
use adit_observation::solution_csv::SolutionReader;
use adit_observation::truth;
use anyhow::{Context, Result, bail};
use binary::{path, run};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use toml::{Table, Value};

/// Time between judged moments, s.
const EVERY_S: &str = "0.1";
/// Methods that know nothing of a site.
const ALONE: [&str; 5] = ["foot-ins", "marg-ins", "reduced-ins-wifi", "full-ins-wifi", "ahrs"];

/// A method and its settings.
#[derive(Debug, Clone)]
pub struct Contender {
    /// Name in the tables.
    pub name: String,
    method: String,
    config: Table,
    nlos: Option<String>,
    /// Person whose log tells how ranges err, from 1.
    calibrate: Option<usize>,
}

/// Normalised innovations squared of a run: how many, and their sum.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nis {
    /// Degrees of freedom.
    pub count: f64,
    /// Sum.
    pub sum: f64,
}

/// What is forgiven before a path is held against the truth.
#[derive(Debug, Clone, Copy)]
pub enum Laid {
    /// Nothing, but a path that begins wherever it likes is laid on the truth by the last `walked_m` that were walked before `until_s`: as if
    /// fixes had told place and heading until then.
    Before {
        /// Until then, s.
        until_s: f64,
        /// By so much of the way, m.
        walked_m: f64,
    },
    /// Place and heading at the start.
    Start,
}

/// A scenario file.
pub struct Scenario {
    file: PathBuf,
    table: Table,
}

/// Log and truth of one seed.
pub struct Simulated {
    folder: TempDir,
    log: PathBuf,
    /// Where the tag was.
    pub truth: Trajectory,
    /// When ranges were taken, s; one time for all anchors of an epoch, in order.
    pub epochs_s: Vec<f64>,
}

/// What a method said at one time, next to the truth.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    /// Time, s.
    pub time_s: f64,
    /// Estimate minus truth: east, north, m.
    pub error_m: Vector2<f64>,
    /// Estimate minus truth, upwards, m.
    pub above_m: f64,
    /// Heading of the estimate less that of the truth, anticlockwise, rad; means nothing of a method without attitude.
    pub turned_rad: f64,
    /// Stated radius that holds the truth with 95 %, m.
    pub radius_m: f64,
    /// Normalised estimation error squared of east and north; none where the covariance is none.
    pub nees: Option<f64>,
    /// Stated quality.
    pub quality: Quality,
}

impl Contender {
    /// Without radio and map: its path begins wherever it likes.
    pub fn starts_anywhere(&self) -> bool {
        ALONE.contains(&self.method.as_str())
    }
}

impl Scenario {
    /// Reads one.
    pub fn open(file: &Path) -> Result<Self> {
        let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
        let table = text.parse().with_context(|| file.display().to_string())?;
        Ok(Self { file: file.to_path_buf(), table })
    }

    /// An entry of `[mine]`.
    pub fn of_mine(&self, key: &str) -> Option<&Value> {
        self.table.get("mine")?.get(key)
    }

    /// The contenders of its `[compare]`: all, or those of these methods, and methods that are not there as they come.
    pub fn contenders(&self, methods: &[String]) -> Result<Vec<Contender>> {
        let runs = self.table.get("compare").and_then(|compare| compare.get("runs"));
        let runs = runs.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let mut contenders = runs.iter().map(|run| self.contender(run)).collect::<Result<Vec<_>>>()?;
        if !methods.is_empty() {
            contenders.retain(|contender| methods.contains(&contender.method));
            for method in methods {
                if !contenders.iter().any(|contender| contender.method == *method) {
                    let (name, method) = (method.clone(), method.clone());
                    contenders.push(Contender {
                        name,
                        method,
                        config: Table::new(),
                        nlos: None,
                        calibrate: None,
                    });
                }
            }
        }
        if contenders.is_empty() {
            bail!("{}: nobody to run, name methods", self.file.display());
        }
        Ok(contenders)
    }

    fn contender(&self, run: &Value) -> Result<Contender> {
        let text = |key: &str| run.get(key).and_then(Value::as_str).map(str::to_owned);
        let method = text("method").context("a run with a method")?;
        let mut config = match text("config_file") {
            None => Table::new(),
            Some(name) => {
                let file = self.file.parent().unwrap_or(Path::new("")).join(name);
                fs::read_to_string(&file)?.parse().with_context(|| file.display().to_string())?
            }
        };
        if let Some(part) = text("config_of") {
            config = Table::from_iter([(part, Value::Table(config))]);
        }
        if let Some(over) = run.get("config").and_then(Value::as_table) {
            merge(&mut config, over);
        }
        let calibrate = run.get("calibrate").and_then(Value::as_integer);
        let calibrate = calibrate.map(usize::try_from).transpose()?;
        let name = text("name").unwrap_or_else(|| method.clone());
        Ok(Contender { name, method, config, nlos: text("nlos"), calibrate })
    }

    /// What `[compare]` says under a name.
    pub fn of_compare(&self, key: &str) -> Option<&Value> {
        self.table.get("compare")?.get(key)
    }

    /// Makes log and truth of the person that is compared.
    pub fn simulate(&self, adit: &Path, seed: u64) -> Result<Simulated> {
        let folder = TempDir::new()?;
        let person = self.of_compare("person").and_then(Value::as_integer).unwrap_or(1);
        let (file, out, seed) = (path(&self.file)?, path(folder.path())?, seed.to_string());
        let mut args = vec!["simulate", &file, "-o", &out, "--seed", &seed];
        // All of few, since one may tell another how ranges err; else the others are in the way, but not written.
        let one = person.to_string();
        if self.of_mine("population").is_some_and(|population| population.get("people").is_some()) {
            args.extend(["--people", &one]);
        }
        run(adit, &args)?;
        let alone = folder.path().join("log.mcap");
        let log =
            if alone.exists() { alone } else { folder.path().join(format!("p{person:03}")).join("log.mcap") };
        let truth = truth::read(log.with_file_name("truth.tum"))?.trajectory;
        let ranges = fs::read_to_string(log.with_file_name("ranges_truth.csv")).unwrap_or_default();
        let times = ranges.lines().skip(1).filter_map(|row| row.split(',').next()?.parse().ok());
        let mut epochs_s: Vec<f64> = times.collect();
        epochs_s.sort_by(f64::total_cmp);
        epochs_s.dedup();
        Ok(Simulated { folder, log, truth, epochs_s })
    }
}

impl Simulated {
    /// The mine.
    pub fn mine(&self) -> Result<Mine> {
        Ok(adit_mine::file::open(&self.folder.path().join("mine.json"))?.0)
    }

    /// A contender's run.
    pub fn track(&self, adit: &Path, contender: &Contender, laid: Laid) -> Result<(Vec<Moment>, Nis)> {
        let beside = |name: &str| self.folder.path().join(name);
        let (config, solutions) = (beside("config.toml"), beside("solutions.csv"));
        fs::write(&config, toml::to_string(&contender.config)?)?;
        let (log, out, config) = (path(&self.log)?, path(&beside("path.tum"))?, path(&config)?);
        let (covariance, mine) = (path(&solutions)?, path(&beside("mine.json"))?);
        let (report, ranges) = (path(&beside("report.json"))?, path(&beside("ranges.toml"))?);
        let mut args = vec!["track", &log, "--method", &contender.method, "-o", &out, "--config", &config];
        args.extend(["--covariance", &covariance, "--every", EVERY_S, "--json", &report]);
        if !contender.starts_anywhere() && beside("mine.json").exists() {
            args.extend(["--mine", &mine]);
        }
        if let Some(model) = &contender.nlos {
            args.extend(["--nlos", model]);
        }
        if let Some(person) = contender.calibrate {
            let teacher = path(&beside(&format!("p{person:03}")).join("log.mcap"))?;
            run(adit, &["calibrate", "range", &teacher, "-o", &ranges])?;
            args.extend(["--radio", &ranges]);
        }
        run(adit, &args)?;
        let estimate = || Ok::<_, anyhow::Error>(truth::read(beside("path.tum"))?.trajectory);
        let motion = match laid {
            Laid::Before { until_s, walked_m } if contender.starts_anywhere() => {
                self.truth_onto(&estimate()?, until_s, walked_m)?
            }
            Laid::Start => {
                let pairs = associate(&self.truth, &estimate()?, &Association::default())?.pairs;
                align(&pairs, Alignment::Start, 1.0)?
            }
            Laid::Before { .. } => RigidMotion::identity(),
        };
        let moments = self.moments(&solutions, &motion)?;
        fs::remove_file(&solutions)?;
        let told: serde_json::Value = serde_json::from_str(&fs::read_to_string(beside("report.json"))?)?;
        let number = |key: &str| told["nis"][key].as_f64().unwrap_or(0.0);
        let dimension = told["nis"]["dimension"].as_f64().unwrap_or(1.0);
        Ok((moments, Nis { count: dimension * number("count"), sum: number("sum") }))
    }

    /// The motion that puts the truth on an estimate, by the last `walked_m` before `until_s`.
    fn truth_onto(&self, estimate: &Trajectory, until_s: f64, walked_m: f64) -> Result<RigidMotion> {
        let until = Time::from_seconds(until_s).context("a time")?;
        let (mut begun, mut gone_m, mut last) = (until, 0.0, None);
        for pose in self.truth.poses().iter().rev().skip_while(|pose| pose.time > until) {
            let here = pose.position_m.xy();
            gone_m += last.map_or(0.0, |last: Vector2<f64>| (here - last).norm());
            (last, begun) = (Some(here), pose.time);
            if gone_m > walked_m {
                break;
            }
        }
        let within = |pose: &&Pose| (begun..=until).contains(&pose.time);
        let part = |path: &Trajectory| Trajectory::new(path.poses().iter().filter(within).copied().collect());
        // The truth is between its poses at the times of the estimate, not the other way round: it has more of them.
        let pairs = associate(&part(&self.truth)?, &part(estimate)?, &Association::default())?.pairs;
        Ok(align(&pairs, Alignment::Se2, 1.0)?)
    }

    /// In the axes of the estimate, whose covariance is in them too.
    fn moments(&self, solutions: &Path, motion: &RigidMotion) -> Result<Vec<Moment>> {
        let mut moments = Vec::new();
        for solution in SolutionReader::open(solutions)? {
            let solution = solution?;
            let Some(truth) = self.truth.at(solution.time) else { continue };
            let error_m = solution.position_m - motion.position(&truth.position_m);
            let covariance: Matrix2<f64> = solution.covariance.fixed_view::<2, 2>(0, 0).into_owned();
            moments.push(Moment {
                time_s: solution.time.seconds(),
                error_m: error_m.xy(),
                above_m: error_m.z,
                turned_rad: attitude::log(
                    &(solution.attitude * (motion.rotation * truth.attitude).inverse()),
                )
                .z,
                radius_m: solution.radius_95_m(),
                nees: normalised_squared_error(&error_m.xy(), &covariance).ok(),
                quality: solution.quality,
            });
        }
        Ok(moments)
    }
}

/// Values of one table over those of another.
fn merge(base: &mut Table, over: &Table) {
    for (key, value) in over {
        match (base.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            (_, value) => {
                base.insert(key.clone(), value.clone());
            }
        }
    }
}
