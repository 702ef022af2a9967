//! Rows of a truth by which a method is judged, and the phases between them.
//!
//! A truth may mark the rows that count (the column `moving` of a CSV: a recording starts and ends at rest, which is easy).
//! The others are left out of everything as if they were not in the file: alignment, errors, distance, consistency.

use crate::EvaluationError;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_core::trajectory::Trajectory;

/// A phase that is not judged, from its first to its last row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phase {
    /// Time of its first row.
    pub start: Time,
    /// Time of its last row.
    pub end: Time,
}

/// The part of a truth that counts.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The rows that count.
    pub truth: Trajectory,
    /// Where others lie, in order of time.
    pub unmarked: Vec<Phase>,
    /// Number of the others.
    pub left_out: usize,
}

impl Judged {
    /// Splits a truth by its marks, one for each pose; without marks everything counts.
    pub fn of(truth: &Trajectory, marked: Option<&[bool]>) -> Result<Self, EvaluationError> {
        let Some(marked) = marked else {
            return Ok(Self { truth: truth.clone(), unmarked: Vec::new(), left_out: 0 });
        };
        if marked.len() != truth.len() {
            return Err(EvaluationError::MarksDiffer { found: marked.len(), expected: truth.len() });
        }
        let rows: Vec<_> = truth.poses().iter().zip(marked).collect();
        let kept: Vec<_> = rows.iter().filter(|(_, marked)| **marked).map(|(pose, _)| **pose).collect();
        let phases = rows.chunk_by(|a, b| a.1 == b.1).filter(|rows| !*rows[0].1);
        Ok(Self {
            left_out: rows.len() - kept.len(),
            unmarked: phases
                .map(|rows| Phase { start: rows[0].0.time, end: rows[rows.len() - 1].0.time })
                .collect(),
            truth: Trajectory::new(kept)?,
        })
    }

    /// The solutions outside the phases that are not judged.
    pub fn solutions(&self, solutions: &[Solution]) -> Vec<Solution> {
        let judged = |solution: &&Solution| {
            let time = solution.time;
            !self.unmarked.iter().any(|phase| phase.start <= time && time <= phase.end)
        };
        solutions.iter().filter(judged).cloned().collect()
    }
}
