//! The walk of system S0 with its sensors, as the tests of the two methods want it.

use adit_core::attitude;
use adit_core::geodesy::Geodetic;
use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_estimation::methods::MethodError;
use adit_estimation::methods::ins_wifi::{InsWifi, InsWifiParams, Mechanisation};
use adit_observation::{FixSource, Observation, Site, StartPose};
use adit_simulation::{
    Emission, FixModel, ImuErrorModel, RoadwayGenerator, RoadwayPlan, RoadwayRanges, RoadwayWalk,
    StartErrors, ToldStart, TriadErrors, TruthState,
};

/// The start of the paper: 121°23' E, 45°42' N.
pub const SITE: Site = Site { latitude_deg: 45.7, longitude_deg: 121.0 + 23.0 / 60.0, height_m: 0.0 };
/// 0.02' of longitude and of latitude there, m.
const POSITION_SIGMA_M: [f64; 2] = [25.94, 37.04];
const ATTITUDE_SIGMA_DEG: f64 = 0.6;

pub struct Run {
    pub log: Vec<Observation>,
    pub truth: Vec<TruthState>,
    pub told: ToldStart,
}

pub fn origin() -> Geodetic {
    SITE.point().unwrap()
}

/// The sensor of system S0: 0.1 °/h and 1e-4 g (1 σ, constant), 0.01 °/√h and 50 µg/√Hz.
pub fn sensor() -> ImuErrorModel {
    let gyro = TriadErrors { turn_on_bias: 4.848e-7, random_walk: 2.909e-6, ..TriadErrors::default() };
    let accelerometer =
        TriadErrors { turn_on_bias: 9.807e-4, random_walk: 4.903e-4, ..TriadErrors::default() };
    ImuErrorModel { gyro, accelerometer, ..ImuErrorModel::default() }
}

pub fn start_errors() -> StartErrors {
    StartErrors { position_m: POSITION_SIGMA_M, attitude_rad: ATTITUDE_SIGMA_DEG.to_radians() }
}

pub fn run(sensor: &ImuErrorModel, start: &StartErrors, seed: u64) -> Run {
    let ranges = RoadwayRanges::default();
    let plan = RoadwayPlan::random(&ranges, seed).unwrap();
    let walk = RoadwayWalk::new(&plan, origin(), ranges.duration_s).unwrap();
    let fixes = FixModel { every_s: 20.0, sigma_m: 0.0608, source: FixSource::Wifi };
    let generator = RoadwayGenerator::new(walk, sensor, 10.0, fixes, start, seed).unwrap();
    let told = *generator.told();
    let (mut log, mut truth) = (Vec::new(), Vec::new());
    for emission in generator {
        log.push(emission.observation());
        if let Emission::Imu(_, state) = emission {
            truth.push(state);
        }
    }
    Run { log, truth, told }
}

/// System S0 with this seed.
pub fn s0(seed: u64) -> Run {
    run(&sensor(), &start_errors(), seed)
}

/// Settings that know what the run was told.
pub fn params(run: &Run) -> InsWifiParams {
    let [heading_deg, pitch_deg, roll_deg] = StartPose::angles_deg(&run.told.attitude);
    let start = StartPose {
        position_m: run.told.position_m.into(),
        position_sigma_m: POSITION_SIGMA_M,
        heading_deg,
        pitch_deg,
        roll_deg,
        attitude_sigma_deg: ATTITUDE_SIGMA_DEG,
    };
    InsWifiParams { site: Some(SITE), start: Some(start), ..InsWifiParams::default() }
}

pub fn solve<M: Mechanisation<N>, const N: usize>(
    run: &Run,
    params: InsWifiParams,
) -> Result<(Vec<Solution>, InsWifi<M, N>), MethodError> {
    let mut method = InsWifi::<M, N>::new(params)?;
    let mut solutions = Vec::with_capacity(run.truth.len());
    for observation in &run.log {
        solutions.extend(method.observe(observation)?);
    }
    Ok((solutions, method))
}

/// Errors of a solution, estimate minus truth.
pub struct Errors {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    /// Turn about the vertical, rad.
    pub turn_rad: f64,
    pub velocity_m_s: Vector3<f64>,
}

pub fn errors(run: &Run, solutions: &[Solution]) -> Vec<Errors> {
    let error = |(solution, truth): (&Solution, &TruthState)| Errors {
        time_s: truth.time.seconds(),
        position_m: solution.position_m - truth.position_m,
        turn_rad: attitude::log(&(solution.attitude * truth.attitude.inverse())).z,
        velocity_m_s: solution.velocity_m_s - truth.velocity_m_s,
    };
    solutions.iter().zip(&run.truth).map(error).collect()
}
