//! Simulated walks, and `foot-ins` over them.

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_estimation::methods::MethodError;
use adit_estimation::methods::foot_ins::{FootIns, FootInsParams, FootInsReport};
use adit_observation::{ImuSample, Observation};
use adit_simulation::{FootWalkScenario, ImuErrorModel, Leg, SimulationError, TruthState, generate};

/// Samples of a walk and where the foot really was.
pub struct Walk {
    pub samples: Vec<ImuSample>,
    pub truth: Vec<TruthState>,
}

impl Walk {
    pub fn of(
        scenario: &FootWalkScenario,
        errors: &ImuErrorModel,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        let (samples, truth) = generate(scenario, errors, seed)?.unzip();
        Ok(Self { samples, truth })
    }

    /// Straight, with the sensor of the foot-hallway logs.
    pub fn straight(length_m: f64, seed: u64) -> Result<Self, SimulationError> {
        Self::of(&FootWalkScenario::straight(length_m), &ImuErrorModel::microstrain_gx5_25(), seed)
    }

    /// A straight leg, a turn to the right, and as long a leg again.
    pub fn with_turn(length_m: f64, turn: Leg, seed: u64) -> Result<Self, SimulationError> {
        let mut scenario = FootWalkScenario::straight(length_m);
        let (leg, stand) = (scenario.plan.legs[1], scenario.plan.legs[2]);
        scenario.plan.legs = vec![stand, leg, turn, leg, stand];
        Self::of(&scenario, &ImuErrorModel::microstrain_gx5_25(), seed)
    }

    pub fn observations(&self) -> Vec<Observation> {
        self.samples.iter().copied().map(Observation::Imu).collect()
    }

    /// The same walk with the sensor screwed on another way round.
    pub fn mounted(&self, mounting: &Attitude) -> Vec<Observation> {
        let turned = |v: &Vector3<f64>| mounting.inverse_transform_vector(v);
        self.samples
            .iter()
            .map(|s| {
                Observation::Imu(ImuSample {
                    time: s.time,
                    angular_rate_rad_s: turned(&s.angular_rate_rad_s),
                    specific_force_m_s2: turned(&s.specific_force_m_s2),
                })
            })
            .collect()
    }

    pub fn length_m(&self) -> f64 {
        let footprints = self.truth.iter().map(|t| t.position_m);
        path_length_m(footprints)
    }

    /// Estimated positions turned about the vertical into the heading of the truth.
    pub fn in_true_heading(&self, solutions: &[Solution]) -> Vec<Vector3<f64>> {
        let turn = attitude::heading(&solutions[0].attitude) - attitude::heading(&self.truth[0].attitude);
        let turn = attitude::exp(&(Vector3::z() * turn));
        solutions.iter().map(|s| turn * s.position_m).collect()
    }

    /// Distance from the true to the estimated end.
    pub fn end_error_m(&self, solutions: &[Solution]) -> f64 {
        let estimated = self.in_true_heading(solutions);
        (estimated[estimated.len() - 1] - self.truth[self.truth.len() - 1].position_m).norm()
    }
}

pub fn path_length_m(positions: impl IntoIterator<Item = Vector3<f64>>) -> f64 {
    let mut length = 0.0;
    let mut before: Option<Vector3<f64>> = None;
    for position in positions {
        length += before.map_or(0.0, |before| (position - before).norm());
        before = Some(position);
    }
    length
}

/// All observations through one filter, to the last solution.
pub fn run(
    params: FootInsParams,
    observations: &[Observation],
) -> Result<(Vec<Solution>, FootInsReport), MethodError> {
    let mut method = FootIns::new(params)?;
    let mut solutions = Vec::new();
    for observation in observations {
        solutions.extend(method.observe(observation)?);
    }
    while let Some(solution) = method.finish_next()? {
        solutions.push(solution);
    }
    Ok((solutions, method.report().clone()))
}
