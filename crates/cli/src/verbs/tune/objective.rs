//! What a search asks for: the cost of values of the parameters.
//!
//! The rule is [`WholeLogs`]: the method itself, over all logs. A method of which most does not depend on its noise parameters
//! (steps, fixes) can do that part once and give a faster cost of its own: one more implementation of [`Objective`], chosen
//! in [`of`]. Before and after the search everything is judged by whole logs all the same.

use super::parameters::Parameters;
use super::reports::Reports;
use super::runs::{Runs, WholeLogs};
use crate::method::MethodName;
use anyhow::Result;

/// Cost of a run from which nothing comes: more than any error in a mine, and still a number.
pub const FAILED: f64 = 1e12;

/// A cost that can be asked for from several threads.
pub trait Objective: Sync {
    /// Mean over the runs of their mean squared errors, with these values of the parameters; never NaN.
    fn cost(&self, values: &[f64]) -> f64;
}

/// The objective of a method.
pub fn of<'a>(
    method: MethodName,
    runs: &'a Runs,
    parameters: &'a Parameters,
) -> Result<Box<dyn Objective + 'a>> {
    if method == MethodName::PdrWifi
        && let Some(reports) = Reports::of(runs, parameters)?
    {
        return Ok(Box::new(reports));
    }
    Ok(Box::new(WholeLogs { runs, parameters }))
}
